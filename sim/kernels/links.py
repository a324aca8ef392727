"""Constraints of Chipmunk's own in a step that is taken in parts: those that hold loose bodies together.

What strikes a structure may be more than the body that touches it: a vehicle, say. Its other bodies, reached through
constraints, go through the parts with it. Its constraints, springs and motors among them, are solved with the contacts,
see `complement`, by Chipmunk's own functions and for the length of a part; what they have given in the step before its
parts begin is taken back. A spring gives in each part what it does where its bodies are then.
"""

import math

import numpy as np

from sim.chipmunk import (
    BODY_FULL_WORDS,
    BODY_SPACE,
    BODY_WORDS,
    CONSTRAINT_BODY_A,
    CONSTRAINT_BODY_B,
    CONSTRAINT_CLASS,
    CONSTRAINT_MAX_FORCE,
    CONSTRAINT_NEXT_A,
    CONSTRAINT_NEXT_B,
    CONSTRAINT_WORDS,
    CONSTRAINTS,
    MASS_INVERSE,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.layout import BODY_A, BODY_B, OWNER_A, OWNER_B
from sim.kernels.noted import NOTES_WORDS, TIES, TIES_COUNT, UNDER_WAY
from sim.kernels.owners import owner_of
from sim.kernels.ties import (
    CONSTRAINT,
    KIND,
    LINKED,
    SUM,
    TIE_WORDS,
    body_of,
    given_by,
    impulse_of,
    is_spring,
    kind_of,
    slacken,
    tie_at,
)
from sim.memory import call_constraint, floats, integers, kernel

#: Most bodies that are reached from those that touch; more are left to whole steps.
MOST_LINKED = 64
_PRE_STEP, _APPLY_IMPULSE = 0, 2


@kernel
def next_link(constraint, body):  # type: ignore[no-untyped-def]
    """The constraint after this one in a body's list."""
    w = integers(constraint, CONSTRAINT_WORDS)
    return w[CONSTRAINT_NEXT_A] if w[CONSTRAINT_BODY_A] == body else w[CONSTRAINT_NEXT_B]


@kernel
def reach(head, bodies):  # type: ignore[no-untyped-def]
    """Loose bodies that a group touches and those that constraints tie to them; how many, -1 if there are too many.

    Also -1 where a constraint ties them to a structure or to a body in no space, or is none of Chipmunk's own.
    """
    leader = views.control(head)
    functions = leader[at.OWN_CLASS]
    count, c = 0, head
    while c != 0:
        t = views.control(c)
        places = views.places(t)
        for k in range(t[at.CONTACTS]):
            if places[k, OWNER_A] == 0:
                count = add(bodies, count, places[k, BODY_A])
            if places[k, OWNER_B] == 0:
                count = add(bodies, count, places[k, BODY_B])
        c = t[at.NEXT]
    done = 0
    while 0 <= done < count:
        body = bodies[done]
        constraint = integers(body, BODY_FULL_WORDS)[CONSTRAINTS]
        while constraint != 0:
            w = integers(constraint, CONSTRAINT_WORDS)
            if kind_of(leader, constraint) == 0:
                return -1
            other = w[CONSTRAINT_BODY_B] if w[CONSTRAINT_BODY_A] == body else w[CONSTRAINT_BODY_A]
            is_moving = floats(other, BODY_WORDS)[MASS_INVERSE] > 0.0
            if is_moving and (owner_of(other, functions) != 0 or integers(other, BODY_FULL_WORDS)[BODY_SPACE] == 0):
                return -1
            count = add(bodies, count, other)
            if count < 0:
                return -1
            constraint = next_link(constraint, body)
        done += 1
    return count


@kernel
def add(bodies, count, body):  # type: ignore[no-untyped-def]
    """Add a dynamic body to a list, once; returns how many there are, or -1 if there is no room."""
    if floats(body, BODY_WORDS)[MASS_INVERSE] == 0.0 or count < 0:
        return count
    if index_in(bodies[:count], body) >= 0:
        return count
    if count == len(bodies):
        return -1
    bodies[count] = body
    return count + 1


@kernel
def index_in(bodies, body):  # type: ignore[no-untyped-def]
    """Where an address is among some, or -1."""
    for i in range(len(bodies)):
        if bodies[i] == body:
            return i
    return -1


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
    """Have the constraints of these bodies go through a step's parts with a group."""
    notes = integers(views.control(head)[at.NOTES], NOTES_WORDS)
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        if tie[KIND] != 0 and (is_at_end(tie, 0, bodies) or is_at_end(tie, 1, bodies)):
            tie[LINKED] = head


@kernel
def is_at_end(tie, side, bodies):  # type: ignore[no-untyped-def]
    """Whether body a (``side`` 0) or b of a tie is among these, and dynamic."""
    body = integers(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_BODY_A + side]
    return floats(body, BODY_WORDS)[MASS_INVERSE] > 0.0 and index_in(bodies, body) >= 0


@kernel
def links_of(head):  # type: ignore[no-untyped-def]
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
def lift_links(links, bodies, pushes, ratio):  # type: ignore[no-untyped-def]
    """Take what constraints have given in this step from bodies' changes of velocity; nothing is on from before.

    Chipmunk has scaled what it applied of the last step's impulses by the ``ratio`` of the steps.
    """
    total = np.empty(2)
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        impulse, begun = impulse_of(tie), sum_of_parts(tie)
        for i in range(len(impulse)):
            total[i] = impulse[i] + (ratio - 1.0) * begun[i]
        for side in range(2):
            i = index_in(bodies, integers(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_BODY_A + side])
            b = body_of(tie, side)
            if i >= 0 and b[MASS_INVERSE] > 0.0:
                x, y, turn = given_by(tie, side, total[: len(impulse)])
                pushes[i, 0] -= x / mass_of(b)
                pushes[i, 1] -= y / mass_of(b)
                pushes[i, 2] -= turn / moment_of(b)
        begun[:] = 0.0


@kernel
def prepare_links(links, h, step):  # type: ignore[no-untyped-def]
    """Begin a part for these constraints, from no impulse: its move is of length ``h``, springs act for a ``step``."""
    for k in range(len(links)):
        tie = integers(links[k], TIE_WORDS)
        impulse_of(tie)[:] = 0.0
        call_constraint(functions_of(tie)[_PRE_STEP], tie[CONSTRAINT], step if is_spring(tie) else h)


@kernel
def functions_of(tie):  # type: ignore[no-untyped-def]
    """Chipmunk's functions for a tie."""
    return integers(integers(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_CLASS], 4)


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
        call_constraint(functions_of(tie)[_APPLY_IMPULSE], tie[CONSTRAINT], h)
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
