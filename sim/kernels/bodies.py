"""Between the solver and Chipmunk's bodies: their velocities, and where they are."""

import math

from sim.chipmunk import (
    ANGLE,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CENTRE,
    COSINE,
    COSINE_AGAIN,
    MINUS_SINE,
    ORIGIN,
    SINE,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import give_back, mass_of, moment_of
from sim.kernels.layout import INERTIA_I
from sim.memory import floats, kernel


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
def load_velocities(t, velocity):  # type: ignore[no-untyped-def]
    """Copy the bodies' velocities into ``velocity``."""
    body_at = views.body_at(t)
    for i in range(t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = b[VX], b[VX + 1], b[SPIN]


@kernel
def take_in(t):  # type: ignore[no-untyped-def]
    """Book what changed the bodies' velocities since they were written, and let the solver know; whether any did."""
    body_at, weight = views.body_at(t), views.weight(t)
    velocity, written = views.per_body(t, at.VELOCITY), views.per_body(t, at.WRITTEN)
    external = views.per_body(t, at.EXTERNAL)
    differs = False
    for i in range(t[at.MOVING]):
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
    for i in range(t[at.MOVING], t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        differs = differs or velocity[i, 0] != b[VX] or velocity[i, 1] != b[VX + 1] or velocity[i, 2] != b[SPIN]
        for out in (velocity, written):
            out[i, 0], out[i, 1], out[i, 2] = b[VX], b[VX + 1], b[SPIN]
    return differs


@kernel
def write(t):  # type: ignore[no-untyped-def]
    """Give the bodies their velocities."""
    written = views.per_body(t, at.WRITTEN)
    give_back(t, views.per_body(t, at.VELOCITY), written)
    store_velocities(t, written)


@kernel
def store_velocities(t, velocity):  # type: ignore[no-untyped-def]
    """Give the bodies that move their velocities."""
    body_at = views.body_at(t)
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        b[VX], b[VX + 1], b[SPIN] = velocity[i, 0], velocity[i, 1], velocity[i, 2]


@kernel
def load_positions(t, position):  # type: ignore[no-untyped-def]
    """Copy the bodies' positions and angles into ``position``."""
    body_at = views.body_at(t)
    for i in range(t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        position[i, 0], position[i, 1], position[i, 2] = b[X], b[X + 1], b[ANGLE]


@kernel
def load_pseudo_velocities(t, velocity):  # type: ignore[no-untyped-def]
    """Copy the bodies' pseudo-velocities into the first columns of ``velocity``."""
    body_at = views.body_at(t)
    for i in range(t[at.BODIES]):
        b = floats(body_at[i], BODY_FULL_WORDS)
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = b[BIAS_VX], b[BIAS_VX + 1], b[BIAS_SPIN]
