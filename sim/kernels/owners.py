"""Which structure a body belongs to, and structures that are solved together because they touch."""

import numpy as np

from sim.chipmunk import (
    ARBITER_BODY_A,
    ARBITER_NEXT_A,
    ARBITER_NEXT_B,
    ARBITER_WORDS,
    BODY_FULL_WORDS,
    CLASS_BYTES,
    CONSTRAINT_BODY_A,
    CONSTRAINT_CLASS,
    CONSTRAINT_NEXT_A,
    CONSTRAINT_NEXT_B,
    CONSTRAINT_SPACE,
    CONSTRAINT_WORDS,
    CONSTRAINTS,
    CONSTRAINTS_OF_SPACE,
    CONTROL,
    LIST_COUNT,
    LIST_ITEMS,
    LIST_WORDS,
    SPACE_WORDS,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.memory import inlined, integers, kernel


@kernel
def find(t, body):  # type: ignore[no-untyped-def]
    """Index of the body at an address in the structure, or -1; open addressing, a power of two long."""
    length = t[at.HASH_LENGTH]
    keys, values = integers(t[at.BODY_KEYS], length), integers(t[at.BODY_VALUES], length)
    slot = ((body >> 4) ^ (body >> 12)) & (length - 1)
    while keys[slot] != 0:
        if keys[slot] == body:
            return values[slot]
        slot = (slot + 1) & (length - 1)
    return -1


@kernel
def owner_of(body, functions):  # type: ignore[no-untyped-def]
    """Control table of the structure that a body belongs to, 0 if none: that of any ductile joint at it."""
    constraint = integers(body, BODY_FULL_WORDS)[CONSTRAINTS]
    while constraint != 0:
        w = integers(constraint, CONSTRAINT_WORDS)
        if 0 <= w[CONSTRAINT_CLASS] - functions <= CLASS_BYTES and w[CONTROL] != 0:
            return w[CONTROL]
        constraint = next_at(constraint, body)
    return 0


@kernel
def next_at(constraint, body):  # type: ignore[no-untyped-def]
    """The constraint after this one in a body's list."""
    w = integers(constraint, CONSTRAINT_WORDS)
    return w[CONSTRAINT_NEXT_A] if w[CONSTRAINT_BODY_A] == body else w[CONSTRAINT_NEXT_B]


@kernel
def next_arbiter(arbiter, body):  # type: ignore[no-untyped-def]
    """The arbiter after this one in a body's list."""
    w = integers(arbiter, ARBITER_WORDS)
    return w[ARBITER_NEXT_A] if w[ARBITER_BODY_A] == body else w[ARBITER_NEXT_B]


@inlined
def list_of_constraints(constraint):  # type: ignore[no-untyped-def]
    """Chipmunk's list of the constraints that it goes through in a step, by one of them."""
    space = integers(constraint, CONSTRAINT_WORDS)[CONSTRAINT_SPACE]
    return integers(integers(space, SPACE_WORDS)[CONSTRAINTS_OF_SPACE], LIST_WORDS)


@kernel
def constraints_with(constraint):  # type: ignore[no-untyped-def]
    """Addresses of all constraints in that list."""
    listed = list_of_constraints(constraint)
    return integers(listed[LIST_ITEMS], listed[LIST_COUNT] & 0xFFFFFFFF)


@kernel
def home(c, body):  # type: ignore[no-untyped-def]
    """Control table of the structure that a body is solved with, ``c`` itself first, and its index there; or 0, -1.

    Held bodies count as loose: they have no mass to share.
    """
    owner, j = c, find(views.control(c), body)
    if j < 0:
        owner = owner_of(body, views.control(c)[at.OWN_CLASS])
        if owner != 0:
            j = find(views.control(owner), body)
    if owner != 0 and (j < 0 or j >= views.control(owner)[at.MOVING]):
        owner, j = 0, -1
    return owner, j


@kernel
def unite(one, other):  # type: ignore[no-untyped-def]
    """Put the groups of two structures (addresses of control tables) together."""
    first, second = views.control(one), views.control(other)
    if first[at.HEAD] == 0:
        first[at.HEAD] = one
    if second[at.HEAD] == 0:
        second[at.HEAD] = other
    head, joining = first[at.HEAD], second[at.HEAD]
    if head == joining:
        return
    t = first
    while t[at.NEXT] != 0:
        t = views.control(t[at.NEXT])
    t[at.NEXT] = joining
    while joining != 0:
        t = views.control(joining)
        t[at.HEAD] = head
        joining = t[at.NEXT]


def hash_table(addresses: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Keys and values for `find`."""
    size = 1 << max(2, (3 * len(addresses) // 2).bit_length())
    keys, values = np.zeros(size, dtype=np.int64), np.zeros(size, dtype=np.int64)
    for index, body in enumerate(addresses):
        slot = ((body >> 4) ^ (body >> 12)) & (size - 1)
        while keys[slot] != 0:
            slot = (slot + 1) & (size - 1)
        keys[slot], values[slot] = body, index
    return keys, values
