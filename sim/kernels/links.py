"""Constraints of Chipmunk's own in a step that is taken in parts: links between loose bodies, and ties of structures.

What strikes a structure may be more than the body that touches it: a vehicle, say. Its other bodies, reached through
constraints, go through the parts with it; so do bodies that hang on the structure. Links, springs and motors among
them, are solved with the contacts, see `complement`, and ties through the structures, see `tie_impulses`, by Chipmunk's
own functions and for the length of a part; what they have given in the step before its parts begin is taken back. A
spring gives in each part what it does where its bodies are then.
"""

import math

import numpy as np

from sim.chipmunk import (
    CONSTRAINT_MAX_FORCE,
    CONSTRAINT_WORDS,
    MASS_INVERSE,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.layout import INVERSE_I, INVERSE_M
from sim.kernels.noted import NOTES_WORDS, TIES, TIES_COUNT, UNDER_WAY
from sim.kernels.reached import index_in
from sim.kernels.ties import (
    APPLY_IMPULSE,
    CONSTRAINT,
    INDEX,
    KIND,
    LINKED,
    OWNER,
    PRE_STEP,
    SUM,
    TIE_WORDS,
    address_of,
    body_of,
    call_for,
    given_by,
    impulse_of,
    is_of,
    is_spring,
    slacken,
    tie_at,
)
from sim.memory import floats, integers, kernel


@kernel
def note_cached(t):  # type: ignore[no-untyped-def]
    """Note with which impulses the space's own constraints begin the step; the first structure in it sees to that."""
    if t[at.NOTES] == 0:
        return
    notes = integers(t[at.NOTES], NOTES_WORDS)
    for k in range(notes[TIES_COUNT] if notes[UNDER_WAY] == 1 else 0):
        tie = tie_at(notes, k)
        if tie[KIND] != 0:
            # Those of springs are of this step already.
            keep_sum(tie, 0.0 if is_spring(tie) else 1.0)


@kernel
def sum_of_parts(tie):  # type: ignore[no-untyped-def]
    """A tie's impulse at the step's start, or in its earlier parts."""
    return tie[SUM : SUM + 2].view(np.float64)


@kernel
def keep_sum(tie, share):  # type: ignore[no-untyped-def]
    """Have a ``share`` of a tie's impulse for that."""
    impulse, kept = impulse_of(tie), sum_of_parts(tie)
    for i in range(len(impulse)):
        kept[i] = share * impulse[i]


@kernel
def link(head, bodies):  # type: ignore[no-untyped-def]
    """Have the constraints of these bodies, and a group's ties, go through a step's parts with it."""
    notes = integers(views.control(head)[at.NOTES], NOTES_WORDS)
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        if is_of(tie, head) or (tie[KIND] != 0 and (is_at_end(tie, 0, bodies) or is_at_end(tie, 1, bodies))):
            tie[LINKED] = head


@kernel
def is_at_end(tie, side, bodies):  # type: ignore[no-untyped-def]
    """Whether body a (``side`` 0) or b of a tie is among these, and dynamic."""
    return body_of(tie, side)[MASS_INVERSE] > 0.0 and index_in(bodies, address_of(tie, side)) >= 0


@kernel
def all_links_of(head):  # type: ignore[no-untyped-def]
    """Where the rows of the constraints lie that go through a step's parts with a group."""
    t = views.control(head)
    notes = integers(t[at.NOTES], NOTES_WORDS)
    links, count = np.empty(notes[TIES_COUNT], np.int64), 0
    for k in range(notes[TIES_COUNT] if t[at.PARTS] > 1 else 0):
        if tie_at(notes, k)[LINKED] == head:
            links[count] = notes[TIES] + 8 * TIE_WORDS * k
            count += 1
    return links[:count]


@kernel
def links_of(head):  # type: ignore[no-untyped-def]
    """Those of them that are between loose bodies: not the ties."""
    links = all_links_of(head)
    count = 0
    for k in range(len(links)):
        if not is_tie(integers(links[k], TIE_WORDS)):
            links[count] = links[k]
            count += 1
    return links[:count]


@kernel
def is_tie(link):  # type: ignore[no-untyped-def]
    """Whether a constraint is at a body of a structure."""
    return link[OWNER] != 0 or link[OWNER + 1] != 0


@kernel
def lift_links(links, bodies, pushes, ratio):  # type: ignore[no-untyped-def]
    """Take back what constraints have given in this step; nothing is on from before.

    That is from the changes of velocity of these loose bodies, and from the impulses of structures. Chipmunk has scaled
    what it applied of the last step's impulses by the ``ratio`` of the steps.
    """
    total = np.empty(2)
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        impulse, begun = impulse_of(tie), sum_of_parts(tie)
        for i in range(len(impulse)):
            total[i] = impulse[i] + (ratio - 1.0) * begun[i]
        for side in range(2):
            i = index_in(bodies, address_of(tie, side))
            b = body_of(tie, side)
            if tie[OWNER + side] != 0:
                book(tie, side, -1.0, total[: len(impulse)])
            elif i >= 0 and b[MASS_INVERSE] > 0.0:
                x, y, turn = given_by(tie, side, total[: len(impulse)])
                pushes[i, 0] -= x / mass_of(b)
                pushes[i, 1] -= y / mass_of(b)
                pushes[i, 2] -= turn / moment_of(b)
        begun[:] = 0.0


@kernel
def book(tie, side, times, impulse):  # type: ignore[no-untyped-def]
    """Book so many ``times`` an impulse of a tie for its structure's body a (``side`` 0) or b, as one from outside."""
    external = views.per_body(views.control(tie[OWNER + side]), at.EXTERNAL)[tie[INDEX + side]]
    x, y, turn = given_by(tie, side, impulse)
    external[0] += times * x
    external[1] += times * y
    external[2] += times * turn


@kernel
def prepare_links(links, h, step):  # type: ignore[no-untyped-def]
    """Begin a part for these constraints, from no impulse: its move is of length ``h``, springs act for a ``step``."""
    before = np.empty((2, 3))
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        impulse = impulse_of(tie)
        impulse[:] = 0.0
        for side in range(2):
            b = body_of(tie, side)
            before[side, 0], before[side, 1], before[side, 2] = b[VX], b[VX + 1], b[SPIN]
        call_for(tie, PRE_STEP, step if is_spring(tie) else h)
        for side in range(2 if is_spring(tie) else 0):
            if tie[OWNER + side] != 0:
                b = body_of(tie, side)
                b[VX], b[VX + 1], b[SPIN] = before[side, 0], before[side, 1], before[side, 2]
                book(tie, side, 1.0, impulse)
                t = views.control(tie[OWNER + side])
                velocity, weight = views.per_body(t, at.VELOCITY)[tie[INDEX + side]], views.weight(t)[tie[INDEX + side]]
                x, y, turn = given_by(tie, side, impulse)
                velocity[0] += x * weight[INVERSE_M]
                velocity[1] += y * weight[INVERSE_M]
                velocity[2] += turn * weight[INVERSE_I]


@kernel
def let_go_of(links, ratio):  # type: ignore[no-untyped-def]
    """Leave forces of the part that has ended, which are ``ratio`` times as much in the next one, without ties'."""
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        for side in range(2):
            if tie[OWNER + side] != 0:
                book(tie, side, -ratio, impulse_of(tie))


@kernel
def pull(links, h):  # type: ignore[no-untyped-def]
    """One of Chipmunk's iterations over these constraints.

    Returns twice the energies of the changes of velocity, and of the velocities themselves [J].
    """
    changed, present, before = 0.0, 0.0, np.empty((2, 3))
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        for side in range(2):
            b = body_of(tie, side)
            before[side, 0], before[side, 1], before[side, 2] = b[VX], b[VX + 1], b[SPIN]
        call_for(tie, APPLY_IMPULSE, h)
        for side in range(2):
            b = body_of(tie, side)
            if b[MASS_INVERSE] > 0.0:
                x, y, w = b[VX] - before[side, 0], b[VX + 1] - before[side, 1], b[SPIN] - before[side, 2]
                changed += mass_of(b) * (x * x + y * y) + moment_of(b) * w * w
                present += mass_of(b) * (b[VX] * b[VX] + b[VX + 1] * b[VX + 1]) + moment_of(b) * b[SPIN] * b[SPIN]
    return changed, present


@kernel
def add_up(links):  # type: ignore[no-untyped-def]
    """Add the impulses of a part to those of the earlier ones."""
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        impulse = impulse_of(tie)
        sum_of_parts(tie)[: len(impulse)] += impulse


@kernel
def hand_back_sums(links):  # type: ignore[no-untyped-def]
    """Have constraints keep the impulse of all parts of the step: pymunk shows it, and the next step begins with it."""
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        impulse = impulse_of(tie)
        impulse += sum_of_parts(tie)[: len(impulse)]


@kernel
def slacken_bounded(links):  # type: ignore[no-untyped-def]
    """Keep Chipmunk from going on with those that have a greatest force: it would allow that of a whole step."""
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        if floats(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_MAX_FORCE] < math.inf:
            slacken(tie)
