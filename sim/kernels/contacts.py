"""Contacts of a structure's bodies: taking them over from Chipmunk, and what they do to bodies.

A contact solver that sees only the mass of the piece that is touched fails where the piece is light and what it carries
is heavy. So the contacts are taken over (their `nMass` and `tMass` set to zero, so that Chipmunk's own solver leaves
them alone; their accumulated impulses stay, and warm-start the next step) and solved through the structures, see
`complement`. Structures that touch each other form a group, and are solved together.

Contacts are kept in an order of their own, by bodies and by Chipmunk's hash of the touching features: the order in
which Chipmunk finds them depends on what its collision tree has been through.
"""

import math

import numpy as np

from sim.chipmunk import (
    ANGLE,
    ARBITER_BODY_A,
    ARBITER_BODY_B,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_FRICTION,
    ARBITER_NEXT_A,
    ARBITER_NEXT_B,
    ARBITER_NORMAL,
    ARBITER_STATE,
    ARBITER_SURFACE,
    ARBITER_WORDS,
    ARBITERS,
    BODY_FULL_WORDS,
    BODY_SPACE,
    BODY_WORDS,
    CONSTRAINT_BODY_A,
    CONSTRAINT_CLASS,
    CONSTRAINT_NEXT_A,
    CONSTRAINT_NEXT_B,
    CONSTRAINT_WORDS,
    CONSTRAINTS,
    CONTACT_BIAS,
    CONTACT_BOUNCE,
    CONTACT_BYTES,
    CONTACT_HASH,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_NORMAL_MASS,
    CONTACT_R1,
    CONTACT_R2,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_TANGENT_MASS,
    CONTACT_WORDS,
    CONTROL,
    FIRST,
    MASS_INVERSE,
    MOMENT_INVERSE,
    SPACE_SLOP,
    SPACE_WORDS,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.layout import (
    ARM_A,
    ARM_B,
    BODY_A,
    BODY_B,
    BOUNCE,
    CACHED,
    EARLIER,
    FRICTION,
    GAP,
    HASH,
    INDEX_A,
    INDEX_B,
    LOOSE_AT,
    LOOSE_START,
    NORMAL,
    OTHER_START,
    OWNER_A,
    OWNER_B,
    PUSH,
    SURFACE,
    WANTED,
    WHERE,
)
from sim.memory import floats, integers, kernel

# Surfaces that turn come apart by a distance that grows with the square of the step, and a contact that was lost would
# be found again a step of free motion later. So a pressed contact keeps this many times that distance of overlap,
# within what the space allows, and comes this share of the way to it in a step.
_KEPT = 8.0
SETTLE = 0.5


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
        if w[CONSTRAINT_CLASS] == functions and w[CONTROL] != 0:
            return w[CONTROL]
        constraint = w[CONSTRAINT_NEXT_A] if w[CONSTRAINT_BODY_A] == body else w[CONSTRAINT_NEXT_B]
    return 0


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


@kernel
def collect(c, t):  # type: ignore[no-untyped-def]
    """Take over the contacts of this step, and form a group with the structures they are with."""
    moving, body_at = t[at.MOVING], views.body_at(t)
    places, touches = views.places(t), views.touches(t)
    functions = integers(t[at.LEADER], CONSTRAINT_WORDS)[CONSTRAINT_CLASS]
    count, missed, h = 0, 0, views.settings(t)[at.STEP]
    slop = floats(integers(body_at[0], BODY_FULL_WORDS)[BODY_SPACE], SPACE_WORDS)[SPACE_SLOP] if moving > 0 else 0.0
    for i in range(moving):
        own = body_at[i]
        arbiter = integers(own, BODY_FULL_WORDS)[ARBITERS]
        while arbiter != 0:
            w, f = integers(arbiter, ARBITER_WORDS), floats(arbiter, ARBITER_WORDS)
            is_a = w[ARBITER_BODY_A] == own
            other = w[ARBITER_BODY_B] if is_a else w[ARBITER_BODY_A]
            contacts = w[ARBITER_COUNT] & 0xFFFFFFFF
            owner, j = c, find(t, other)
            if contacts > 0 and j < 0:
                owner = owner_of(other, functions)
                if owner != 0:
                    j = find(views.control(owner), other)
            # Held bodies count as loose: they have no mass to share.
            if owner != 0 and (j < 0 or j >= views.control(owner)[at.MOVING]):
                owner, j = 0, -1
            for k in range(contacts):
                where = w[ARBITER_CONTACTS] + CONTACT_BYTES * k
                contact = floats(where, CONTACT_WORDS)
                if contact[CONTACT_NORMAL_MASS] == 0.0:
                    continue
                if count >= len(places):
                    missed += 1
                    continue
                if owner != 0 and owner != c:
                    unite(c, owner)
                p, touch = places[count], touches[count]
                p[WHERE], p[HASH] = where, integers(where, CONTACT_WORDS)[CONTACT_HASH]
                p[OWNER_A], p[INDEX_A] = (c, i) if is_a else (owner, j)
                p[OWNER_B], p[INDEX_B] = (owner, j) if is_a else (c, i)
                p[BODY_A], p[BODY_B] = w[ARBITER_BODY_A], w[ARBITER_BODY_B]
                nx, ny = f[ARBITER_NORMAL], f[ARBITER_NORMAL + 1]
                touch[NORMAL], touch[NORMAL + 1] = nx, ny
                touch[ARM_A], touch[ARM_A + 1] = contact[CONTACT_R1], contact[CONTACT_R1 + 1]
                touch[ARM_B], touch[ARM_B + 1] = contact[CONTACT_R2], contact[CONTACT_R2 + 1]
                touch[FRICTION] = f[ARBITER_FRICTION]
                touch[SURFACE] = -ny * f[ARBITER_SURFACE] + nx * f[ARBITER_SURFACE + 1]
                touch[WANTED] = -contact[CONTACT_BOUNCE]
                touch[BOUNCE], touch[GAP] = touch[WANTED], distance(p, touch)
                spare = min(slop, kept(p, touch, h)) + touch[GAP]
                if touch[WANTED] == 0.0 and spare > 0.0:
                    touch[WANTED] = -SETTLE * spare / h
                touch[PUSH] = contact[CONTACT_BIAS]
                if w[ARBITER_STATE] & 0xFFFFFFFF == FIRST:
                    contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE] = 0.0, 0.0
                touch[CACHED], touch[CACHED + 1] = contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE]
                touch[EARLIER], touch[EARLIER + 1] = 0.0, 0.0
                load_loose(touch, floats(other, BODY_WORDS))
                for row in range(2):
                    touch[OTHER_START + row] = other_velocity(c, p, touch, row)
                contact[CONTACT_NORMAL_MASS] = 0.0
                contact[CONTACT_TANGENT_MASS] = 0.0
                count += 1
            arbiter = w[ARBITER_NEXT_A] if is_a else w[ARBITER_NEXT_B]
    arrange(places, touches, count)
    t[at.CONTACTS], t[at.MISSED] = count, missed


@kernel
def load_loose(touch, b):  # type: ignore[no-untyped-def]
    """Note how and where the other body of a contact is."""
    touch[LOOSE_START], touch[LOOSE_START + 1], touch[LOOSE_START + 2] = b[VX], b[VX + 1], b[SPIN]
    touch[LOOSE_AT], touch[LOOSE_AT + 1], touch[LOOSE_AT + 2] = b[X], b[X + 1], b[ANGLE]


@kernel
def distance(place, touch):  # type: ignore[no-untyped-def]
    """Distance of the two surfaces at a contact, negative where they overlap [m]."""
    a, b = floats(place[BODY_A], BODY_WORDS), floats(place[BODY_B], BODY_WORDS)
    x = b[X] + touch[ARM_B] - a[X] - touch[ARM_A]
    y = b[X + 1] + touch[ARM_B + 1] - a[X + 1] - touch[ARM_A + 1]
    return touch[NORMAL] * x + touch[NORMAL + 1] * y


@kernel
def kept(place, touch, h):  # type: ignore[no-untyped-def]
    """Overlap that a pressed contact keeps: some times ½ r (ω h)² of both bodies, by which turning parts them [m]."""
    a, b = floats(place[BODY_A], BODY_WORDS), floats(place[BODY_B], BODY_WORDS)
    ra, rb = math.hypot(touch[ARM_A], touch[ARM_A + 1]), math.hypot(touch[ARM_B], touch[ARM_B + 1])
    return 0.5 * _KEPT * (ra * (a[SPIN] * h) ** 2 + rb * (b[SPIN] * h) ** 2)


@kernel
def hand_back(t):  # type: ignore[no-untyped-def]
    """Undo what `collect` did to the contacts."""
    places = views.places(t)
    for k in range(t[at.CONTACTS]):
        contact = floats(places[k, WHERE], CONTACT_WORDS)
        contact[CONTACT_NORMAL_MASS], contact[CONTACT_TANGENT_MASS] = 1.0, 1.0


@kernel
def arrange(places, touches, count):  # type: ignore[no-untyped-def]
    """Sort contacts by the indices of their bodies and their hashes (by insertion: they are few)."""
    for k in range(1, count):
        m = k
        while m > 0 and comes_before(places[m], places[m - 1]):
            for i in range(at.PLACE_WORDS):
                places[m, i], places[m - 1, i] = places[m - 1, i], places[m, i]
            for i in range(at.TOUCH_WORDS):
                touches[m, i], touches[m - 1, i] = touches[m - 1, i], touches[m, i]
            m -= 1


@kernel
def comes_before(p, q):  # type: ignore[no-untyped-def]
    """Whether contact p is to be solved before q."""
    if p[INDEX_A] != q[INDEX_A]:
        return p[INDEX_A] < q[INDEX_A]
    if p[INDEX_B] != q[INDEX_B]:
        return p[INDEX_B] < q[INDEX_B]
    return p[HASH] < q[HASH]


@kernel
def direction(touch, row):  # type: ignore[no-untyped-def]
    """Unit vector of a row (even: normal, odd: tangent) and its moments about a and b."""
    dx, dy = touch[NORMAL], touch[NORMAL + 1]
    if row & 1:
        dx, dy = -dy, dx
    return dx, dy, touch[ARM_A] * dy - touch[ARM_A + 1] * dx, touch[ARM_B] * dy - touch[ARM_B + 1] * dx


@kernel
def other_velocity(c, place, touch, row):  # type: ignore[no-untyped-def]
    """What bodies that are not in structure ``c`` give to the velocity of b relative to a along a row, at present."""
    dx, dy, ma, mb = direction(touch, row)
    total = 0.0
    if place[OWNER_B] != c:
        b = floats(place[BODY_B], BODY_FULL_WORDS)
        total += dx * b[VX] + dy * b[VX + 1] + mb * b[SPIN]
    if place[OWNER_A] != c:
        a = floats(place[BODY_A], BODY_FULL_WORDS)
        total -= dx * a[VX] + dy * a[VX + 1] + ma * a[SPIN]
    return total


@kernel
def own_velocity(c, place, touch, row, velocity):  # type: ignore[no-untyped-def]
    """What the bodies of structure ``c`` give to it, at its velocities (bodies, 3)."""
    dx, dy, ma, mb = direction(touch, row)
    total = 0.0
    if place[OWNER_B] == c:
        v = velocity[place[INDEX_B]]
        total += dx * v[0] + dy * v[1] + mb * v[2]
    if place[OWNER_A] == c:
        v = velocity[place[INDEX_A]]
        total -= dx * v[0] + dy * v[1] + ma * v[2]
    return total


@kernel
def add_row(c, place, touch, row, amount, vector):  # type: ignore[no-untyped-def]
    """Add ``amount`` of a row's unit impulse to the bodies of structure ``c`` in its ``vector``, (bodies, 3)."""
    dx, dy, ma, mb = direction(touch, row)
    if place[OWNER_B] == c:
        x = vector[place[INDEX_B]]
        x[0] += amount * dx
        x[1] += amount * dy
        x[2] += amount * mb
    if place[OWNER_A] == c:
        x = vector[place[INDEX_A]]
        x[0] -= amount * dx
        x[1] -= amount * dy
        x[2] -= amount * ma


@kernel
def push_loose(place, touch, row, amount, offset, spin):  # type: ignore[no-untyped-def]
    """Give a row's impulse to the loose body of a contact, if it has one; velocities at ``offset`` and ``spin``."""
    dx, dy, ma, mb = direction(touch, row)
    if place[OWNER_B] == 0:
        b = floats(place[BODY_B], BODY_FULL_WORDS)
        b[offset] += amount * dx * b[MASS_INVERSE]
        b[offset + 1] += amount * dy * b[MASS_INVERSE]
        b[spin] += amount * mb * b[MOMENT_INVERSE]
    if place[OWNER_A] == 0:
        a = floats(place[BODY_A], BODY_FULL_WORDS)
        a[offset] -= amount * dx * a[MASS_INVERSE]
        a[offset + 1] -= amount * dy * a[MASS_INVERSE]
        a[spin] -= amount * ma * a[MOMENT_INVERSE]


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
