"""Contacts of a structure's bodies: taking them over from Chipmunk, and what they do to bodies.

A contact solver that sees only the mass of the piece that is touched fails where the piece is light and what it carries
is heavy. So the contacts are taken over (their `nMass` and `tMass` set to zero, so that Chipmunk's own solver leaves
them alone; their accumulated impulses stay, and warm-start the next step) and solved through the structures, see
`complement`. Structures that touch each other form a group, and are solved together.

Contacts are kept in an order of their own, by bodies and by Chipmunk's hash of the touching features: the order in
which Chipmunk finds them depends on what its collision tree has been through.
"""

import math

from sim.chipmunk import (
    ARBITER_BODY_A,
    ARBITER_BODY_B,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_FRICTION,
    ARBITER_NORMAL,
    ARBITER_SHAPE_A,
    ARBITER_SHAPE_B,
    ARBITER_STATE,
    ARBITER_SURFACE,
    ARBITER_WORDS,
    ARBITERS,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONSTRAINT_SPACE,
    CONSTRAINT_WORDS,
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
    FIRST,
    MASS_INVERSE,
    SHAPE_CLASS,
    SHAPE_RADIUS,
    SPACE_GRAVITY,
    SPACE_SLOP,
    SPACE_WORDS,
    SPIN,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.abutting import abut, silence
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
    HALF,
    HASH,
    INDEX_A,
    INDEX_B,
    MASSES,
    MEETING,
    NORMAL,
    OTHER_START,
    OWNER_A,
    OWNER_B,
    PUSH,
    RETURN,
    ROUNDED,
    SURFACE,
    WANTED,
    WHERE,
)
from sim.kernels.owners import home, next_arbiter, unite
from sim.kernels.rows import other_velocity, own_velocity
from sim.memory import floats, integers, kernel

# Surfaces that turn come apart by a distance that grows with the square of the step, and those of a structure that
# bends, or that something slides on little by little. A contact that was lost would be found again a step of free
# motion later. So a pressed contact keeps this many times that distance of overlap, and this share of what it would
# fall in that step, within what the space allows, and comes this share of the way to it in a step.
_KEPT, _OF_FALL = 8.0, 0.05
SETTLE = 0.5


@kernel
def collect(c, t):  # type: ignore[no-untyped-def]
    """Take over the contacts of this step, and form a group with the structures they are with.

    Those that Chipmunk would part the wrong way are left to Python first (`sim.far_side`), marked by a negative mass.
    """
    moving, body_at, looking, astray = t[at.MOVING], views.body_at(t), t[at.ASTRAY] == 0, 0
    places, touches = views.places(t), views.touches(t)
    count, missed, h = 0, 0, views.settings(t)[at.STEP]
    slop, fall = allowed(t, h) if moving > 0 else (0.0, 0.0)
    for i in range(moving):
        own = body_at[i]
        arbiter = integers(own, BODY_FULL_WORDS)[ARBITERS]
        while arbiter != 0:
            w = integers(arbiter, ARBITER_WORDS)
            is_a = w[ARBITER_BODY_A] == own
            other = w[ARBITER_BODY_B] if is_a else w[ARBITER_BODY_A]
            contacts = w[ARBITER_COUNT] & 0xFFFFFFFF
            owner, j = home(c, other) if contacts > 0 else (0, -1)
            apart = owner != c or t[at.ABUTTING] == 0 or not abut(t, i, j)
            for k in range(contacts):
                where = w[ARBITER_CONTACTS] + CONTACT_BYTES * k
                contact = floats(where, CONTACT_WORDS)
                if contact[CONTACT_NORMAL_MASS] == 0.0:
                    continue
                if not apart:
                    silence(contact)
                    continue
                if count >= len(places):
                    missed += 1
                    continue
                if owner != 0 and owner != c:
                    unite(c, owner)
                p, touch = places[count], touches[count]
                load_contact(arbiter, where, p, touch)
                p[OWNER_A], p[INDEX_A] = (c, i) if is_a else (owner, j)
                p[OWNER_B], p[INDEX_B] = (owner, j) if is_a else (c, i)
                spare = min(slop, kept(p, touch, h, fall)) + touch[GAP]
                if touch[WANTED] == 0.0 and spare > 0.0:
                    touch[WANTED] = -SETTLE * spare / h
                if w[ARBITER_STATE] & 0xFFFFFFFF == FIRST:
                    contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE] = 0.0, 0.0
                touch[CACHED], touch[CACHED + 1] = contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE]
                touch[HALF], touch[HALF + 1] = meet(p, touch)
                for row in range(2):
                    touch[OTHER_START + row] = other_velocity(c, p, touch, row)
                if looking and w[ARBITER_STATE] & 0xFFFFFFFF == FIRST and came_from_elsewhere(c, t, p, touch, slop):
                    contact[CONTACT_NORMAL_MASS] *= -1.0
                    astray += 1
                    continue
                seize(contact, touch)
                count += 1
            arbiter = next_arbiter(arbiter, own)
    arrange(places, touches, count)
    t[at.CONTACTS], t[at.MISSED] = count, missed
    if looking:
        t[at.ASTRAY] = astray


@kernel
def load_contact(arbiter, where, place, touch):  # type: ignore[no-untyped-def]
    """Copy what Chipmunk says of the contact at ``where``."""
    w, f, contact = integers(arbiter, ARBITER_WORDS), floats(arbiter, ARBITER_WORDS), floats(where, CONTACT_WORDS)
    place[WHERE], place[HASH] = where, integers(where, CONTACT_WORDS)[CONTACT_HASH]
    place[BODY_A], place[BODY_B] = w[ARBITER_BODY_A], w[ARBITER_BODY_B]
    nx, ny = f[ARBITER_NORMAL], f[ARBITER_NORMAL + 1]
    touch[NORMAL], touch[NORMAL + 1] = nx, ny
    touch[ARM_A], touch[ARM_A + 1] = contact[CONTACT_R1], contact[CONTACT_R1 + 1]
    touch[ARM_B], touch[ARM_B + 1] = contact[CONTACT_R2], contact[CONTACT_R2 + 1]
    touch[FRICTION] = f[ARBITER_FRICTION]
    touch[SURFACE] = -ny * f[ARBITER_SURFACE] + nx * f[ARBITER_SURFACE + 1]
    touch[WANTED] = -contact[CONTACT_BOUNCE]
    touch[BOUNCE], touch[GAP], touch[PUSH] = touch[WANTED], distance(place, touch), contact[CONTACT_BIAS]
    touch[EARLIER], touch[EARLIER + 1], touch[RETURN], touch[MEETING] = 0.0, 0.0, 0.0, 0.5
    touch[ROUNDED], touch[ROUNDED + 1] = rounding(w[ARBITER_SHAPE_A]), rounding(w[ARBITER_SHAPE_B])


@kernel
def rounding(shape):  # type: ignore[no-untyped-def]
    """Radius of a circle, or by which a shape is rounded [m]."""
    kind = integers(integers(shape, SHAPE_CLASS + 1)[SHAPE_CLASS], 1)[0] & 0xFFFFFFFF
    word = SHAPE_RADIUS[kind]
    return floats(shape, word + 1)[word]


@kernel
def seize(contact, touch):  # type: ignore[no-untyped-def]
    """Keep Chipmunk from solving a contact, whose arms become those of ``touch``; `hand_back` undoes it."""
    for axis in range(2):
        contact[CONTACT_R1 + axis] = touch[ARM_A + axis]
        contact[CONTACT_R2 + axis] = touch[ARM_B + axis]
    touch[MASSES], touch[MASSES + 1] = contact[CONTACT_NORMAL_MASS], contact[CONTACT_TANGENT_MASS]
    contact[CONTACT_NORMAL_MASS] = 0.0
    contact[CONTACT_TANGENT_MASS] = 0.0


@kernel
def allowed(t, h):  # type: ignore[no-untyped-def]
    """By how much shapes may overlap in the space of a structure that is in a step, and what falls freely in it [m]."""
    space = floats(integers(t[at.LEADER], CONSTRAINT_WORDS)[CONSTRAINT_SPACE], SPACE_WORDS)
    return space[SPACE_SLOP], h * h * math.hypot(space[SPACE_GRAVITY], space[SPACE_GRAVITY + 1])


@kernel
def came_from_elsewhere(c, t, place, touch, slop):  # type: ignore[no-untyped-def]
    """Whether surfaces that meet for the first time must have overlapped along this normal before the last move.

    So they have met along another one, and one body has gone past the middle of the other since, or into its side.
    """
    before = touch[GAP] - views.settings(t)[at.STEP] * (
        touch[OTHER_START] + own_velocity(c, place, touch, 0, views.per_body(t, at.START_VELOCITY))
    )
    if before > -2.0 * slop:
        return False
    body = place[BODY_A] if place[OWNER_A] == 0 else place[BODY_B]
    if floats(body, BODY_WORDS)[MASS_INVERSE] == 0.0:
        body = place[BODY_B] if place[OWNER_A] == 0 else place[BODY_A]
    # What rolls or slides on from one piece to the next is over it already.
    arbiter = integers(body, BODY_FULL_WORDS)[ARBITERS]
    while arbiter != 0:
        w = integers(arbiter, ARBITER_WORDS)
        if w[ARBITER_STATE] & 0xFFFFFFFF != FIRST:
            return False
        arbiter = next_arbiter(arbiter, body)
    return True


@kernel
def distance(place, touch):  # type: ignore[no-untyped-def]
    """Distance of the two surfaces at a contact, negative where they overlap [m]."""
    a, b = floats(place[BODY_A], BODY_WORDS), floats(place[BODY_B], BODY_WORDS)
    x = b[X] + touch[ARM_B] - a[X] - touch[ARM_A]
    y = b[X + 1] + touch[ARM_B + 1] - a[X + 1] - touch[ARM_A + 1]
    return touch[NORMAL] * x + touch[NORMAL + 1] * y


@kernel
def meet(place, touch):  # type: ignore[no-untyped-def]
    """Have a contact act on both bodies at one point between those on their surfaces; returns the way from a's to it.

    Opposite impulses at two points are a couple, friction's where surfaces overlap: angular momentum from nowhere.
    """
    a, b = floats(place[BODY_A], BODY_WORDS), floats(place[BODY_B], BODY_WORDS)
    x = b[X] + touch[ARM_B] - a[X] - touch[ARM_A]
    y = b[X + 1] + touch[ARM_B + 1] - a[X + 1] - touch[ARM_A + 1]
    of_a, of_b = touch[MEETING], 1.0 - touch[MEETING]
    touch[ARM_A], touch[ARM_A + 1] = touch[ARM_A] + of_a * x, touch[ARM_A + 1] + of_a * y
    touch[ARM_B], touch[ARM_B + 1] = touch[ARM_B] - of_b * x, touch[ARM_B + 1] - of_b * y
    return of_a * x, of_a * y


@kernel
def kept(place, touch, h, fall):  # type: ignore[no-untyped-def]
    """Overlap that a pressed contact keeps: some times ½ r (ω h)² of both bodies, by which turning parts them [m].

    And a share of the ``fall`` of a step. What is rounded turns about where its rounding is from: a wheel that rolls is
    not parted from the road.
    """
    parted = 0.0
    for side in range(2):
        arm, body = (ARM_A, BODY_A) if side == 0 else (ARM_B, BODY_B)
        inwards = (2 * side - 1) * touch[ROUNDED + side]
        x, y = touch[arm] + inwards * touch[NORMAL], touch[arm + 1] + inwards * touch[NORMAL + 1]
        parted += math.hypot(x, y) * (floats(place[body], BODY_WORDS)[SPIN] * h) ** 2
    return 0.5 * _KEPT * parted + _OF_FALL * fall


@kernel
def hand_back(t):  # type: ignore[no-untyped-def]
    """Undo what `collect` did to the contacts: Chipmunk's own points of the two surfaces, and the masses.

    Chipmunk solves what goes back within a step, and `Arbiter.total_ke` divides by the masses after it.
    """
    places, touches = views.places(t), views.touches(t)
    for k in range(t[at.CONTACTS] - t[at.NEAR]):
        contact, touch = floats(places[k, WHERE], CONTACT_WORDS), touches[k]
        for axis in range(2):
            contact[CONTACT_R1 + axis] -= touch[HALF + axis]
            contact[CONTACT_R2 + axis] += touch[HALF + axis]
        contact[CONTACT_NORMAL_MASS], contact[CONTACT_TANGENT_MASS] = touch[MASSES], touch[MASSES + 1]


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
