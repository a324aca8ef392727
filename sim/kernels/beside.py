"""Contacts beside a group's own in a step that is taken in parts: of what goes through the parts with it.

A vehicle that strikes a structure stands on the ground. While it is stopped its wheels bear on that, and less or more
so than a step of Chipmunk's would have it. So contacts of the loose bodies that a group touches, and of those that
constraints link to them, are solved with the group's own: with what is held, and with each other. They are contacts of
the structure that acts for all, with no body of its own.
"""

import math

import numpy as np

from sim.chipmunk import (
    ARBITER_BODY_A,
    ARBITER_BODY_B,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_STATE,
    ARBITER_WORDS,
    ARBITERS,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONTACT_BIAS_IMPULSE,
    CONTACT_BYTES,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_NORMAL_MASS,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    FIRST,
    MASS_INVERSE,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.contacts import arrange, load_contact, meet, seize
from sim.kernels.layout import (
    BODY_A,
    BODY_B,
    CACHED,
    HALF,
    INDEX_A,
    INDEX_B,
    OTHER_START,
    OWNER_A,
    OWNER_B,
    STRIKE,
    WHOLE_RATIO,
)
from sim.kernels.links import is_tie
from sim.kernels.noted import LOOSE_WORDS, MATE, NOTES_WORDS, ask, row_of, row_of_contact
from sim.kernels.owners import next_arbiter
from sim.kernels.reached import index_in
from sim.kernels.rows import loose_velocity, push_loose
from sim.kernels.tie_blows import catches
from sim.kernels.ties import OWNER, TIE_WORDS, address_of
from sim.memory import call_notice, floats, integers, kernel


@kernel
def take_over_beside(head, mates):  # type: ignore[no-untyped-def]
    """Take over contacts between these loose bodies, and with held ones, and take back what they have done so far."""
    t = views.control(head)
    count = sweep(head, mates, False)
    if count == 0:
        return
    if t[at.CONTACTS] + count > t[at.ROOM]:
        # Python makes room.
        t[at.MISSED] = count
        call_notice(t[at.NOTICE], t[at.KEY])
        t[at.MISSED] = 0
    places, touches, first = views.places(t), views.touches(t), t[at.CONTACTS] - t[at.NEAR]
    for k in range(t[at.CONTACTS] - 1, first - 1, -1):
        places[k + count], touches[k + count] = places[k], touches[k]
    sweep(head, mates, True)
    arrange(places[first : first + count], touches[first : first + count], count)
    t[at.CONTACTS] += count


@kernel
def sweep(head, mates, taking):  # type: ignore[no-untyped-def]
    """Count such contacts; those that are taken go behind the group's own that Chipmunk has found."""
    t, count = views.control(head), 0
    first = t[at.CONTACTS] - t[at.NEAR]
    places, touches = views.places(t), views.touches(t)
    for i in range(len(mates)):
        arbiter = integers(mates[i], BODY_FULL_WORDS)[ARBITERS]
        while arbiter != 0:
            w = integers(arbiter, ARBITER_WORDS)
            is_a = w[ARBITER_BODY_A] == mates[i]
            other = w[ARBITER_BODY_B] if is_a else w[ARBITER_BODY_A]
            j = index_in(mates, other)
            # Those of two are met with at the first of them; those with structures are taken already.
            if floats(other, BODY_WORDS)[MASS_INVERSE] == 0.0 or j > i:
                for k in range(w[ARBITER_COUNT] & 0xFFFFFFFF):
                    where = w[ARBITER_CONTACTS] + CONTACT_BYTES * k
                    if floats(where, CONTACT_WORDS)[CONTACT_NORMAL_MASS] == 0.0:
                        continue
                    if taking:
                        place, touch = places[first + count], touches[first + count]
                        take(t, arbiter, where, place, touch)
                        place[INDEX_A], place[INDEX_B] = (i, j) if is_a else (j, i)
                    count += 1
            arbiter = next_arbiter(arbiter, mates[i])
    return count


@kernel
def take(t, arbiter, where, place, touch):  # type: ignore[no-untyped-def]
    """Take over one contact.

    Chipmunk has applied what it had cached, scaled by the ratio of the steps, and may have iterated once.
    """
    contact, place[OWNER_A], place[OWNER_B] = floats(where, CONTACT_WORDS), 0, 0
    load_contact(arbiter, where, place, touch)
    row = row_of_contact(integers(t[at.NOTES], NOTES_WORDS), where)
    first = integers(arbiter, ARBITER_WORDS)[ARBITER_STATE] & 0xFFFFFFFF == FIRST
    for axis in range(2):
        word = CONTACT_TANGENT_IMPULSE if axis == 1 else CONTACT_NORMAL_IMPULSE
        begun = 0.0 if first or row == 0 else floats(row, 3)[1 + axis]
        given = contact[word] + (views.settings(t)[WHOLE_RATIO] - 1.0) * begun
        push_loose(place, touch, axis, -given, VX, SPIN)
        contact[word], touch[CACHED + axis] = 0.0, 0.0
    push_loose(place, touch, 0, -contact[CONTACT_BIAS_IMPULSE], BIAS_VX, BIAS_SPIN)
    contact[CONTACT_BIAS_IMPULSE], touch[STRIKE] = 0.0, 0.0
    if row != 0:
        # What a ledger would book for it is booked here.
        floats(row, 5)[3] = math.nan
    touch[HALF], touch[HALF + 1] = meet(place, touch)
    seize(contact, touch)


@kernel
def gather_beside(head, mates):  # type: ignore[no-untyped-def]
    """Have Python list what may touch these bodies within the step, of what is held and among them."""
    t = views.control(head)
    before = t[at.NEAR]
    mark(t, mates, 1.0)
    ask(t, at.GATHER_BESIDE)
    mark(t, mates, 0.0)
    t[at.CONTACTS] += t[at.NEAR] - before


@kernel
def mark(t, mates, number):  # type: ignore[no-untyped-def]
    """Note a number for these bodies, by which Python knows them."""
    for i in range(len(mates)):
        row = row_of(t, mates[i])
        if row != 0:
            floats(row, LOOSE_WORDS)[MATE] = number


@kernel
def note_starts_beside(head):  # type: ignore[no-untyped-def]
    """Note how fast the bodies of these contacts are against each other when the step begins."""
    t = views.control(head)
    places, touches = views.places(t), views.touches(t)
    for k in range(t[at.CONTACTS]):
        if places[k, OWNER_A] == 0 and places[k, OWNER_B] == 0:
            for row in range(2):
                touches[k, OTHER_START + row] = loose_velocity(places[k], touches[k], row)


@kernel
def leave_out_borne(head, others, links, pushes):  # type: ignore[no-untyped-def]
    """Leave out the changes of velocity of those that contacts beside a group bear, or what is linked to them.

    Or that hang on a structure that is held, but by a tie that catches them.
    """
    t = views.control(head)
    places, borne, spreads = views.places(t), np.zeros(len(others), np.bool_), True
    for k in range(t[at.CONTACTS] - t[at.NEAR]):
        if places[k, OWNER_A] == 0 and places[k, OWNER_B] == 0:
            for i in range(len(others)):
                borne[i] = borne[i] or places[k, BODY_A] == others[i] or places[k, BODY_B] == others[i]
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        if is_tie(tie) and not catches(tie):
            for side in range(2):
                owner, i = tie[OWNER + 1 - side], index_in(others, address_of(tie, side))
                if owner != 0 and i >= 0:
                    borne[i] = borne[i] or views.control(owner)[at.FREE] == 0
    while spreads:
        spreads = False
        for k in range(len(links)):
            tie = integers(links[k], TIE_WORDS)
            i, j = index_in(others, address_of(tie, 0)), index_in(others, address_of(tie, 1))
            if i >= 0 and j >= 0 and borne[i] != borne[j]:
                borne[i] = borne[j] = spreads = True
    for i in range(len(others)):
        if borne[i]:
            pushes[i, 0], pushes[i, 1], pushes[i, 2] = 0.0, 0.0, 0.0
