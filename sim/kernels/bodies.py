"""Between the solver and Chipmunk's bodies: their velocities, and where they are."""

import math

from sim.chipmunk import (
    ANGLE,
    ARBITERS,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_SPACE,
    BODY_WORDS,
    CENTRE,
    COSINE,
    COSINE_AGAIN,
    FORCE_X,
    FORCE_Y,
    MASS_INVERSE,
    MINUS_SINE,
    MOMENT_INVERSE,
    ORIGIN,
    SINE,
    SPACE_GRAVITY,
    SPACE_WORDS,
    SPIN,
    TORQUE,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import give_back, mass_of, moment_of, weigh
from sim.kernels.layout import INERTIA_I, INERTIA_M
from sim.memory import floats, inlined, integers, kernel

# A movement without velocity below this [m, rad], over 1 + |x|, is rounding.
_UNMOVED = 1e-12
# A velocity up to this is none [m/s, rad/s].
_STILL = 1e-40


@kernel
def move(body, x, y, turn):  # type: ignore[no-untyped-def]
    """Move a body and turn it."""
    b = floats(body, BODY_WORDS)
    b[X] += x
    b[X + 1] += y
    b[ANGLE] += turn
    c, s = math.cos(b[ANGLE]), math.sin(b[ANGLE])
    b[COSINE], b[SINE], b[MINUS_SINE], b[COSINE_AGAIN] = c, s, -s, c
    b[ORIGIN] = b[X] - (c * b[CENTRE] - s * b[CENTRE + 1])
    b[ORIGIN + 1] = b[X + 1] - (s * b[CENTRE] + c * b[CENTRE + 1])


@kernel
def put(body, x, y, angle):  # type: ignore[no-untyped-def]
    """Put a body to a place, to the last bit."""
    b = floats(body, BODY_WORDS)
    b[X], b[X + 1], b[ANGLE] = x, y, angle
    move(body, 0.0, 0.0, 0.0)


@kernel
def load_velocities(body_at, velocity):  # type: ignore[no-untyped-def]
    """Copy the velocities of the bodies at these addresses into ``velocity``."""
    for i in range(len(body_at)):
        b = floats(body_at[i], BODY_WORDS)
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = b[VX], b[VX + 1], b[SPIN]


@kernel
def load_positions(body_at, position):  # type: ignore[no-untyped-def]
    """Copy their positions and angles into ``position``."""
    for i in range(len(body_at)):
        b = floats(body_at[i], BODY_WORDS)
        position[i, 0], position[i, 1], position[i, 2] = b[X], b[X + 1], b[ANGLE]


@inlined
def arrive(t, h):  # type: ignore[no-untyped-def]
    """Find out how and where the bodies begin a step of length ``h``: weights, velocities, movement without velocity.

    Chipmunk has just moved the bodies. Where one was given another velocity since the last step, by an impulse say, it
    was moved with that before any joint could resist; it is put to where its old velocity would have taken it, so that
    the impulse acts when the forces do.

    Movement since the last step that velocities do not explain is to take out overlap, or by hand. Returns the fastest
    spin of those that move, whether any touches something, and a number that is finite if all are what they were and
    where they may be, and forces lead none beyond all bounds.
    """
    body_at, shift, moving, force = views.body_at(t), views.shift(t), t[at.MOVING], views.per_body(t, at.LAST_FORCE)
    start, last = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.LAST_VELOCITY)
    position, velocity, weight = views.per_body(t, at.LAST_POSITION), views.per_body(t, at.VELOCITY), views.weight(t)
    fastest, touching, pushed, shifted = 0.0, False, t[at.SHIFTED] == 1, False
    bounded, forced, rate = 0.0, False, 1.0 / h
    for i in range(t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        if i < moving:
            x, y, w = b[VX] - last[i, 0], b[VX + 1] - last[i, 1], b[SPIN] - last[i, 2]
            if x != 0.0 or y != 0.0 or w != 0.0:
                move(body_at[i], -h * x, -h * y, -h * w)
            fastest = max(fastest, abs(b[SPIN]))
            bounded += reached(b, h) if stays(body_at[i], True) else math.nan
            weigh(weight, i, b)
            touching = touching or integers(body_at[i], BODY_FULL_WORDS)[ARBITERS] != 0
            fx, fy, moment = force_on(body_at[i], rate * x, rate * y, rate * w)
            forced = forced or fx != force[i, 0] or fy != force[i, 1] or moment != force[i, 2]
        elif not stays(body_at[i], False):
            bounded = math.nan
        for axis in range(3):
            v = b[SPIN] if axis == 2 else b[VX + axis]
            start[i, axis], velocity[i, axis] = v, v
            by_contacts = 0.0
            if pushed:
                # Until now it held the pseudo-velocity with which the last step ended.
                by_contacts = h * shift[i, axis]
                shift[i, axis], shift[i, 3 + axis] = by_contacts, 0.0
                shifted = shifted or by_contacts != 0.0
            place = b[ANGLE] if axis == 2 else b[X + axis]
            rest = place - (position[i, axis] + h * last[i, axis] + by_contacts)
            nothing = _UNMOVED * (1.0 + abs(place))
            if i >= moving and abs(rest + h * (last[i, axis] - v)) <= nothing:
                rest = 0.0  # what carries a support along moves it by its new velocity
            # A structure that is new does not know where its bodies were.
            if abs(rest) > nothing:
                shift[i, 3 + axis], shifted = rest, True
    t[at.SHIFTED], t[at.FORCED] = 1 if shifted else 0, 1 if forced else 0
    return fastest, touching, bounded


@inlined
def stays(body, moving):  # type: ignore[no-untyped-def]
    """Whether a body is still what it was when its structure was built: dynamic and in a space if ``moving``."""
    dynamic = floats(body, BODY_WORDS)[MASS_INVERSE] != 0.0
    return dynamic == moving and (not moving or integers(body, BODY_FULL_WORDS)[BODY_SPACE] != 0)


@inlined
def force_on(body, x, y, turn):  # type: ignore[no-untyped-def]
    """Force and moment from outside on a body, those of an impulse that has made it faster by so much [1/s²] too."""
    b, space, gx, gy = floats(body, BODY_WORDS), integers(body, BODY_FULL_WORDS)[BODY_SPACE], 0.0, 0.0
    if space != 0:
        gx, gy = floats(space, SPACE_WORDS)[SPACE_GRAVITY], floats(space, SPACE_WORDS)[SPACE_GRAVITY + 1]
    mass = mass_of(b)
    return b[FORCE_X] + mass * (gx + x), b[FORCE_Y] + mass * (gy + y), b[TORQUE] + moment_of(b) * turn


@inlined
def reached(b, h):  # type: ignore[no-untyped-def]
    """Twice the kinetic energy of a body's struct after a step ``h`` of its forces [J]; finite if its place is, too."""
    x, y = b[VX] + h * b[FORCE_X] * b[MASS_INVERSE], b[VX + 1] + h * b[FORCE_Y] * b[MASS_INVERSE]
    w = b[SPIN] + h * b[TORQUE] * b[MOMENT_INVERSE]
    return mass_of(b) * (x * x + y * y) + moment_of(b) * w * w + 0.0 * (b[X] + b[X + 1] + b[ANGLE])


@inlined
def depart(t):  # type: ignore[no-untyped-def]
    """Note how and where the bodies end a step: velocities, pseudo-velocities and positions.

    Shifts are left alone where there are none, and none have been; they are all zero then.
    """
    body_at, shift, shifted = views.body_at(t), views.shift(t), t[at.SHIFTED] == 1
    last, position = views.per_body(t, at.LAST_VELOCITY), views.per_body(t, at.LAST_POSITION)
    for i in range(t[at.BODIES]):
        b = floats(body_at[i], BODY_FULL_WORDS)
        last[i, 0], last[i, 1], last[i, 2] = b[VX], b[VX + 1], b[SPIN]
        position[i, 0], position[i, 1], position[i, 2] = b[X], b[X + 1], b[ANGLE]
        x, y, w = b[BIAS_VX], b[BIAS_VX + 1], b[BIAS_SPIN]
        shifted = shifted or x != 0.0 or y != 0.0 or w != 0.0
        if shifted:
            shift[i, 0], shift[i, 1], shift[i, 2] = x, y, w
    t[at.SHIFTED] = 1 if shifted else 0


@inlined
def take_in(t):  # type: ignore[no-untyped-def]
    """Book what changed the bodies' velocities since they were written, and let the solver know.

    Before the first solve of a step, nothing has been written or booked in it. Returns whether any was changed, and
    twice the kinetic energy [J], which is finite if all velocities are.
    """
    body_at, weight, first = views.body_at(t), views.weight(t), t[at.FRESH] == 1
    velocity, written = views.per_body(t, at.VELOCITY), views.per_body(t, at.WRITTEN)
    start, external = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.EXTERNAL)
    differs, energy = False, 0.0
    for i in range(t[at.MOVING]):
        if first:
            for axis in range(3):
                written[i, axis], external[i, axis] = start[i, axis], 0.0
        b = floats(body_at[i], BODY_WORDS)
        x, y, w = b[VX] - written[i, 0], b[VX + 1] - written[i, 1], b[SPIN] - written[i, 2]
        if x != 0.0 or y != 0.0 or w != 0.0:
            differs = True
            mass, moment = mass_of(b), moment_of(b)
            external[i, 0] += mass * x
            external[i, 1] += mass * y
            external[i, 2] += moment * w
            velocity[i, 0] += x
            velocity[i, 1] += y
            velocity[i, 2] += w * (moment / weight[i, INERTIA_I])
            written[i, 0], written[i, 1], written[i, 2] = b[VX], b[VX + 1], b[SPIN]
        x, y, w = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        energy += weight[i, INERTIA_M] * (x * x + y * y) + weight[i, INERTIA_I] * w * w
    for i in range(t[at.MOVING], t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        differs = differs or velocity[i, 0] != b[VX] or velocity[i, 1] != b[VX + 1] or velocity[i, 2] != b[SPIN]
        for out in (velocity, written):
            out[i, 0], out[i, 1], out[i, 2] = b[VX], b[VX + 1], b[SPIN]
    return differs, energy


@inlined
def write(t):  # type: ignore[no-untyped-def]
    """Give the bodies their velocities."""
    body_at, velocity, written = views.body_at(t), views.per_body(t, at.VELOCITY), views.per_body(t, at.WRITTEN)
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        vx, vy, spin = settled(velocity[i, 0]), settled(velocity[i, 1]), settled(velocity[i, 2])
        written[i, 0], written[i, 1], written[i, 2] = vx, vy, spin
        b[VX], b[VX + 1], b[SPIN] = vx, vy, spin
    if t[at.TURNING] == 1 and t[at.FREE] == 1:
        give_back(t, velocity, written)
        store_velocities(t, written)


@inlined
def settled(velocity):  # type: ignore[no-untyped-def]
    """A velocity, or 0 for one that has died away.

    In a direction where nothing rounds, as across a beam at y = 0, a motion dies away for ever, and processors take
    many times as long for numbers, or products of some, that are nearly too small to be written down.
    """
    return velocity if abs(velocity) > _STILL else 0.0


@kernel
def store_velocities(t, velocity):  # type: ignore[no-untyped-def]
    """Give the bodies that move their velocities."""
    body_at = views.body_at(t)
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        b[VX], b[VX + 1], b[SPIN] = velocity[i, 0], velocity[i, 1], velocity[i, 2]
