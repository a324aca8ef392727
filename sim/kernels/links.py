"""Constraints of Chipmunk's own in a step that is taken in parts: those that hold loose bodies together.

What strikes a structure may be more than the body that touches it. Its other bodies, reached through constraints, go
through the parts with it, and its constraints are solved in turn with the structure, by Chipmunk's own functions and
for the length of a part. Springs and motors give in a step what they give in a whole one; what has any, such as a
vehicle, is left to whole steps.
"""

import numpy as np

from sim.chipmunk import (
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONSTRAINT_BODY_A,
    CONSTRAINT_BODY_B,
    CONSTRAINT_CLASS,
    CONSTRAINT_NEXT_A,
    CONSTRAINT_NEXT_B,
    CONSTRAINT_WORDS,
    CONSTRAINTS,
    MASS_INVERSE,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.layout import BODY_A, BODY_B, OWNER_A, OWNER_B
from sim.kernels.owners import owner_of
from sim.kernels.ties import kind_of
from sim.memory import call_constraint, floats, integers, kernel
from sim.stock import KIND_COUNT, KIND_HOLDS, KIND_IMPULSE, KIND_WORDS

#: Most bodies that are reached from those that touch, and most of their constraints; more are left to whole steps.
MOST_LINKED, MOST_LINKS = 64, 256
#: Turns of constraints and structures in a part, at the most, and the change of impulses at which they agree.
MOST_TURNS, AGREED = 6, 1e-2
_PRE_STEP, _APPLY_IMPULSE = 0, 2


@kernel
def next_link(constraint, body):  # type: ignore[no-untyped-def]
    """The constraint after this one in a body's list."""
    w = integers(constraint, CONSTRAINT_WORDS)
    return w[CONSTRAINT_NEXT_A] if w[CONSTRAINT_BODY_A] == body else w[CONSTRAINT_NEXT_B]


@kernel
def reach(head, bodies):  # type: ignore[no-untyped-def]
    """Loose bodies that a group touches and those that constraints tie to them; how many, -1 if there are too many.

    Also -1 where a constraint ties them to a structure, or is a spring, a motor or one of another kind.
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
            kind = kind_of(leader, constraint)
            if kind == 0 or integers(kind, KIND_WORDS)[KIND_HOLDS] == 0:
                return -1
            other = w[CONSTRAINT_BODY_B] if w[CONSTRAINT_BODY_A] == body else w[CONSTRAINT_BODY_A]
            if owner_of(other, functions) != 0 and floats(other, BODY_WORDS)[MASS_INVERSE] > 0.0:
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
    for i in range(count):
        if bodies[i] == body:
            return count
    if count == len(bodies):
        return -1
    bodies[count] = body
    return count + 1


@kernel
def links_of(t, bodies):  # type: ignore[no-untyped-def]
    """Constraints of these bodies that work on velocities, and where each keeps its impulse: address, first, count."""
    links, count = np.empty((MOST_LINKS, 3), np.int64), 0
    for i in range(len(bodies)):
        constraint = integers(bodies[i], BODY_FULL_WORDS)[CONSTRAINTS]
        while constraint != 0 and count < MOST_LINKS:
            kind, known = kind_of(t, constraint), False
            for k in range(count):
                known = known or links[k, 0] == constraint
            if kind != 0 and not known:
                w = integers(kind, KIND_WORDS)
                links[count, 0], links[count, 1], links[count, 2] = constraint, w[KIND_IMPULSE], w[KIND_COUNT]
                count += 1
            constraint = next_link(constraint, bodies[i])
    return links[:count]


@kernel
def prepare_links(links, h):  # type: ignore[no-untyped-def]
    """Begin a part of length ``h`` for these constraints, from no impulse."""
    for k in range(len(links)):
        impulse = floats(links[k, 0], links[k, 1] + links[k, 2])
        for i in range(links[k, 1], links[k, 1] + links[k, 2]):
            impulse[i] = 0.0
        functions = integers(integers(links[k, 0], CONSTRAINT_WORDS)[CONSTRAINT_CLASS], 4)
        call_constraint(functions[_PRE_STEP], links[k, 0], h)


@kernel
def pull_links(links, h):  # type: ignore[no-untyped-def]
    """One of Chipmunk's iterations over these constraints; returns the change of their impulses, over their size."""
    changed, size = 0.0, 0.0
    for k in range(len(links)):
        impulse = floats(links[k, 0], links[k, 1] + links[k, 2])
        before = impulse[links[k, 1]]
        functions = integers(integers(links[k, 0], CONSTRAINT_WORDS)[CONSTRAINT_CLASS], 4)
        call_constraint(functions[_APPLY_IMPULSE], links[k, 0], h)
        changed += abs(impulse[links[k, 1]] - before)
        size += abs(impulse[links[k, 1]])
    return changed / size if size > 0.0 else 0.0
