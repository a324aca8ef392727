"""Loose bodies that go through the parts of a step with a group: what touches it, what hangs on it, and what is linked.

Constraints of Chipmunk's own lead from one to the next, see `links`.
"""

from sim.chipmunk import (
    ARBITER_BODY_A,
    ARBITER_BODY_B,
    ARBITER_WORDS,
    ARBITERS,
    BODY_FULL_WORDS,
    BODY_SPACE,
    BODY_WORDS,
    CONSTRAINT_BODY_A,
    CONSTRAINT_BODY_B,
    CONSTRAINT_WORDS,
    CONSTRAINTS,
    MASS_INVERSE,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.layout import BODY_A, BODY_B, OWNER_A, OWNER_B
from sim.kernels.noted import NOTES_WORDS, TIES_COUNT
from sim.kernels.owners import next_arbiter, next_at, owner_of
from sim.kernels.ties import OWNER, address_of, is_of, is_one_of, kind_of, tie_at
from sim.memory import floats, integers, kernel

#: Most bodies that are reached from those that touch; more are left to whole steps.
MOST_LINKED = 64


@kernel
def reach(head, bodies):  # type: ignore[no-untyped-def]
    """Loose bodies that a group touches and those that constraints tie to it or them; how many, -1 if too many.

    Also -1 where a constraint ties them to another structure or to a body in no space, or is none of Chipmunk's own;
    and where what is tied to the group touches another structure.
    """
    leader = views.control(head)
    functions = leader[at.OWN_CLASS]
    count, c = add_tied(head, bodies), head
    for i in range(count):
        if touches_another(head, bodies[i]):
            return -1
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
            owner = owner_of(other, functions) if floats(other, BODY_WORDS)[MASS_INVERSE] > 0.0 else 0
            if owner == 0:
                count = add(bodies, count, other)
            elif not is_one_of(owner, head):
                return -1
            if count < 0:
                return -1
            constraint = next_at(constraint, body)
        done += 1
    return count


@kernel
def add_tied(head, bodies):  # type: ignore[no-untyped-def]
    """Begin a list with the loose bodies at a group's ties; returns how many there are."""
    notes, count = integers(views.control(head)[at.NOTES], NOTES_WORDS), 0
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        for side in range(2):
            if tie[OWNER + side] == 0 and is_of(tie, head):
                count = add(bodies, count, address_of(tie, side))
    return count


@kernel
def touches_another(head, body):  # type: ignore[no-untyped-def]
    """Whether a loose body touches a structure that is not of a group."""
    functions, arbiter = views.control(head)[at.OWN_CLASS], integers(body, BODY_FULL_WORDS)[ARBITERS]
    while arbiter != 0:
        w = integers(arbiter, ARBITER_WORDS)
        is_a = w[ARBITER_BODY_A] == body
        other = w[ARBITER_BODY_B] if is_a else w[ARBITER_BODY_A]
        owner = owner_of(other, functions) if floats(other, BODY_WORDS)[MASS_INVERSE] > 0.0 else 0
        if owner != 0 and not is_one_of(owner, head):
            return True
        arbiter = next_arbiter(arbiter, body)
    return False


@kernel
def add(bodies, count, body):  # type: ignore[no-untyped-def]
    """Add a dynamic body to a list, once; returns how many there are, or -1 if it has no room or the body no space."""
    if floats(body, BODY_WORDS)[MASS_INVERSE] == 0.0 or count < 0:
        return count
    if integers(body, BODY_FULL_WORDS)[BODY_SPACE] == 0:
        return -1
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
