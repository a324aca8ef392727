"""The bodies that move with a group of structures but are not solved with it: loose ones, and held ones that move.

Loose ones are those that touch it, and what constraints tie to it or to them, see `links`.

A step taken in parts moves them along: they are found once, gathered by address, and put back in the end.
"""

import numpy as np

from sim.chipmunk import (
    ANGLE,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_WORDS,
    ARBITERS,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONTACT_NORMAL_MASS,
    CONTACT_WORDS,
    MASS_INVERSE,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bodies import put
from sim.kernels.layout import BODY_A, BODY_B, CACHED, OWNER_A, OWNER_B
from sim.kernels.moves import way_to_line
from sim.kernels.noted import NOTES_WORDS, SPEED, TIES_COUNT, note_struck
from sim.kernels.owners import next_arbiter
from sim.kernels.reached import MOST_LINKED, index_in, reach
from sim.kernels.rows import push_loose
from sim.kernels.ties import OWNER, TIE_WORDS, address_of, is_of, tie_at
from sim.memory import floats, integers, kernel


@kernel
def others_of(head):  # type: ignore[no-untyped-def]
    """Addresses of the bodies that move with a group's but are not solved with it: loose ones, and moving held ones."""
    linked = np.empty(MOST_LINKED, np.int64)
    links = reach(head, linked)
    notes = integers(views.control(head)[at.NOTES], NOTES_WORDS)
    room, c = max(links, 0) + notes[TIES_COUNT], head
    while c != 0:
        t = views.control(c)
        room += t[at.CONTACTS] + t[at.BODIES] - t[at.MOVING]
        c = t[at.NEXT]
    found, count, c = np.empty(room, np.int64), 0, head
    while c != 0:
        t = views.control(c)
        places, body_at = views.places(t), views.body_at(t)
        for k in range(t[at.CONTACTS]):
            for side in range(2):
                owner, body = (
                    (places[k, OWNER_A], places[k, BODY_A]) if side == 0 else (places[k, OWNER_B], places[k, BODY_B])
                )
                if owner == 0:
                    count = note(found, count, body)
        for i in range(t[at.MOVING], t[at.BODIES]):
            count = note(found, count, body_at[i])
        c = t[at.NEXT]
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        for side in range(2):
            if tie[OWNER + side] == 0 and is_of(tie, head):
                count = note(found, count, address_of(tie, side))
    for i in range(links):
        count = note(found, count, linked[i])
    return found[:count]


@kernel
def note(found, count, body):  # type: ignore[no-untyped-def]
    """Add a body that moves to those found, once; returns how many there are."""
    b = floats(body, BODY_WORDS)
    if b[MASS_INVERSE] == 0.0 and b[VX] == 0.0 and b[VX + 1] == 0.0 and b[SPIN] == 0.0:
        return count
    if index_in(found[:count], body) >= 0:
        return count
    found[count] = body
    return count + 1


@kernel
def is_at(place, body):  # type: ignore[no-untyped-def]
    """Whether a body is the loose one, or one of the two loose ones, of a contact."""
    return (place[OWNER_A] == 0 and place[BODY_A] == body) or (place[OWNER_B] == 0 and place[BODY_B] == body)


@kernel
def which(others, place):  # type: ignore[no-untyped-def]
    """Where the loose body of a contact is among the others, or -1."""
    for i in range(len(others)):
        if is_at(place, others[i]):
            return i
    return -1


@kernel
def mates_of(head, others, links):  # type: ignore[no-untyped-def]
    """Those of them that a group touches, and those at these constraints: dynamic ones."""
    mates, count = np.empty(len(others), np.int64), 0
    for i in range(len(others)):
        linked = False
        for k in range(len(links)):
            for side in range(2):
                linked = linked or address_of(integers(links[k], TIE_WORDS), side) == others[i]
        if floats(others[i], BODY_WORDS)[MASS_INVERSE] > 0.0 and (linked or touched(head, others[i], 0)):
            mates[count] = others[i]
            count += 1
    return mates[:count]


@kernel
def take_back(head):  # type: ignore[no-untyped-def]
    """Take back what Chipmunk has given loose bodies of the impulses that a group's contacts began the step with."""
    c = head
    while c != 0:
        t = views.control(c)
        places, touches = views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS]):
            for row in range(2):
                push_loose(places[k], touches[k], row, -touches[k, CACHED + row], VX, SPIN)
        c = t[at.NEXT]


@kernel
def changes(others, rows):  # type: ignore[no-untyped-def]
    """By how much the others' velocities have changed since the step began."""
    change = np.zeros((len(others), 3))
    for i in range(len(others)):
        if rows[i] != 0:
            b, at_start = floats(others[i], BODY_WORDS), floats(rows[i] + 8 * SPEED, 3)
            change[i, 0], change[i, 1] = b[VX] - at_start[0], b[VX + 1] - at_start[1]
            change[i, 2] = b[SPIN] - at_start[2]
    return change


@kernel
def set_back(others, rows):  # type: ignore[no-untyped-def]
    """Have the others the velocities with which the step began."""
    for i in range(len(others)):
        if rows[i] != 0:
            b, at_start = floats(others[i], BODY_WORDS), floats(rows[i] + 8 * SPEED, 3)
            b[VX], b[VX + 1], b[SPIN] = at_start[0], at_start[1], at_start[2]


@kernel
def struck_besides(head, others, pushes):  # type: ignore[no-untyped-def]
    """Split off the changes of those that touch something besides the group; what contacts gave is among them."""
    struck = np.zeros((len(others), 3))
    for i in range(len(others)):
        arbiter = integers(others[i], BODY_FULL_WORDS)[ARBITERS]
        while arbiter != 0:
            w = integers(arbiter, ARBITER_WORDS)
            # A group has set the masses of its own contacts to zero.
            if w[ARBITER_COUNT] & 0xFFFFFFFF and floats(w[ARBITER_CONTACTS], CONTACT_WORDS)[CONTACT_NORMAL_MASS] != 0.0:
                note_struck(views.control(head), arbiter)
                for axis in range(3):
                    struck[i, axis] += pushes[i, axis]
                    pushes[i, axis] = 0.0
            arbiter = next_arbiter(arbiter, others[i])
    return struck


@kernel
def touched(head, body, near):  # type: ignore[no-untyped-def]
    """Whether Chipmunk has found that a group touches a body that is not its own, or it is ``near`` it, if that counts.

    ``near`` is 1 or 0.
    """
    c = head
    while c != 0:
        t = views.control(c)
        places = views.places(t)
        for k in range(t[at.CONTACTS] - (1 - near) * t[at.NEAR]):
            if is_at(places[k], body):
                return True
        c = t[at.NEXT]
    return False


@kernel
def delay(body, place, whole):  # type: ignore[no-untyped-def]
    """Put a body back to ``place``; the next ``whole`` step moves it to where it is by a pseudo-velocity."""
    b = floats(body, BODY_FULL_WORDS)
    x, y, turn = b[X] - place[0], b[X + 1] - place[1], b[ANGLE] - place[2]
    put(body, place[0], place[1], place[2])
    b[BIAS_VX] += x / whole
    b[BIAS_VX + 1] += y / whole
    b[BIAS_SPIN] += turn / whole


@kernel
def shorten(body, h, whole):  # type: ignore[no-untyped-def]
    """Let a body's velocities move it for ``h`` only in the next ``whole`` step."""
    b = floats(body, BODY_FULL_WORDS)
    less = 1.0 - h / whole
    b[BIAS_VX] -= less * b[VX]
    b[BIAS_VX + 1] -= less * b[VX + 1]
    b[BIAS_SPIN] -= less * b[SPIN]


@kernel
def put_back(body, place, h, whole):  # type: ignore[no-untyped-def]
    """Put a body back to ``place``, from where the next ``whole`` step moves it to what is a part ``h`` from here."""
    delay(body, place, whole)
    shorten(body, h, whole)


@kernel
def show(body, place, h, whole):  # type: ignore[no-untyped-def]
    """Put a body that nothing holds back as `put_back` does, to where it has the same angular momentum as where it is.

    That is on the line along which it moves, at the point nearest to its ``place``, which is changed.
    """
    b = floats(body, BODY_WORDS)
    x, y = way_to_line(place[0], place[1], b[X], b[X + 1], b[VX], b[VX + 1])
    place[0] += x
    place[1] += y
    put_back(body, place, h, whole)
