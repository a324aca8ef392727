"""The rows of a contact: its unit impulses along normal and tangent, and what they and bodies do to each other."""

import math

from sim.chipmunk import BODY_FULL_WORDS, MASS_INVERSE, MOMENT_INVERSE, SPIN, VX
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.layout import ARM_A, ARM_B, BODY_A, BODY_B, INDEX_A, INDEX_B, NORMAL, OWNER_A, OWNER_B, SOLVED, SURFACE
from sim.memory import floats, kernel


@kernel
def copy_contact(places, touches, k, others, other_touches, m):  # type: ignore[no-untyped-def]
    """Have the m-th contact of ``others`` be the k-th of these."""
    for i in range(at.PLACE_WORDS):
        others[m, i] = places[k, i]
    for i in range(at.TOUCH_WORDS):
        other_touches[m, i] = touches[k, i]


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
def velocity_of_b(place, touch, row):  # type: ignore[no-untyped-def]
    """Velocity of body b's point along a row, at present."""
    dx, dy, _, mb = direction(touch, row)
    b = floats(place[BODY_B], BODY_FULL_WORDS)
    return dx * b[VX] + dy * b[VX + 1] + mb * b[SPIN]


@kernel
def loose_velocity(place, touch, row):  # type: ignore[no-untyped-def]
    """What loose bodies give to it, at present."""
    if place[OWNER_A] != 0 and place[OWNER_B] != 0:
        return 0.0
    owner = place[OWNER_A] + place[OWNER_B]
    # No structure has the address -1.
    return other_velocity(owner if owner != 0 else -1, place, touch, row)


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
def relative(place, touch, row):  # type: ignore[no-untyped-def]
    """Velocity of b relative to a along a row, that of the surface included."""
    total = loose_velocity(place, touch, row)
    if place[OWNER_A] != 0:
        c = place[OWNER_A]
        total += own_velocity(c, place, touch, row, views.per_body(views.control(c), at.VELOCITY))
    if place[OWNER_B] != 0 and place[OWNER_B] != place[OWNER_A]:
        c = place[OWNER_B]
        total += own_velocity(c, place, touch, row, views.per_body(views.control(c), at.VELOCITY))
    if row & 1:
        total += touch[SURFACE]
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


@kernel
def move_loose(places, touches, row, velocities):  # type: ignore[no-untyped-def]
    """Add to the ``velocities`` of all rows what a row's unit impulse gives them by moving its loose bodies."""
    place = places[row >> 1]
    dx, dy, ma, mb = direction(touches[row >> 1], row)
    for side in range(2):
        if place[OWNER_A if side == 0 else OWNER_B] != 0:
            continue
        loose = place[BODY_A] if side == 0 else place[BODY_B]
        b = floats(loose, BODY_FULL_WORDS)
        sign, moment = (-1.0, ma) if side == 0 else (1.0, mb)
        for r in range(len(velocities)):
            p = places[r >> 1]
            ex, ey, na, nb = direction(touches[r >> 1], r)
            theirs, arm = 0.0, 0.0
            if p[OWNER_A] == 0 and p[BODY_A] == loose:
                theirs, arm = -1.0, na
            elif p[OWNER_B] == 0 and p[BODY_B] == loose:
                theirs, arm = 1.0, nb
            turned = moment * arm * b[MOMENT_INVERSE]
            velocities[r] += sign * theirs * ((dx * ex + dy * ey) * b[MASS_INVERSE] + turned)


@kernel
def sum_up(c, places, touches, amounts, out):  # type: ignore[no-untyped-def]
    """J_cᵀ times impulses of the rows, on the bodies of structure ``c``."""
    clear(out)
    for r in range(len(amounts)):
        add_row(c, places[r >> 1], touches[r >> 1], r, amounts[r], out)


@kernel
def note_solved(t, converged):  # type: ignore[no-untyped-def]
    """Note what loose bodies give to the velocities of a structure's contacts, now that these are solved."""
    places, touches = views.places(t), views.touches(t)
    for k in range(t[at.CONTACTS]):
        for row in range(2):
            touches[k, SOLVED + row] = loose_velocity(places[k], touches[k], row) if converged else math.nan


@kernel
def are_solved(t):  # type: ignore[no-untyped-def]
    """Whether they give the same as then; not where no solution was found."""
    places, touches = views.places(t), views.touches(t)
    for k in range(t[at.CONTACTS]):
        for row in range(2):
            if touches[k, SOLVED + row] != loose_velocity(places[k], touches[k], row):
                return False
    return True
