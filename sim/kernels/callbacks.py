"""The functions that Chipmunk calls for each joint; the first joint of a structure that it comes to acts for all.

Numba keys its cache by a function's own code. What these functions call lies in other files, so a digest of those
files is made part of them.
"""

import hashlib
import math
from pathlib import Path
from typing import Any

import numpy as np
from numba import cfunc, njit, types

from sim.chipmunk import (
    ANGLE,
    BODY_WORDS,
    CENTRE,
    CONTROL,
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
from sim.kernels.blocks import assemble, factorise, substitute
from sim.kernels.commit import commit, weaken
from sim.kernels.contacts import PLACE_WORDS, TOUCH_WORDS, collect, complement, operator, push_apart, strike
from sim.kernels.kinematics import prepare
from sim.kernels.newton import advance, iterate, linearise
from sim.kernels.spread import advance_spread
from sim.memory import call_notice, floats, integers, table

_MOST_ROUNDS = 40
_SETTLED = 1e-6


@njit(error_model="numpy")
def begin(c, h):  # type: ignore[no-untyped-def]
    """Start of a step: where the joints are, and what their bodies' velocities were.

    Chipmunk has just moved the bodies. Where one was given another velocity since the last step, by an impulse say, it
    was moved with that before any joint could resist; it is put to where its old velocity would have taken it, so that
    the impulse acts when the forces do.
    """
    t = integers(c, at.CONTROL_WORDS)
    n, bodies = t[at.JOINTS], t[at.BODIES]
    settings = floats(t[at.SETTINGS], at.SETTINGS_WORDS)
    ratio = h / settings[at.STEP] if settings[at.STEP] > 0.0 else 0.0
    settings[at.STEP] = h
    settings[at.SPREAD_IMPULSE] *= ratio * t[at.SPREAD]
    t[at.FRESH] = 1
    floats(t[at.SCALE], n)[:] = 1.0
    body_at = integers(t[at.BODY_AT], bodies)
    start, last = table(t[at.START_VELOCITY], bodies, 3), table(t[at.LAST_VELOCITY], bodies, 3)
    load_velocities(t, start)
    for i in range(t[at.MOVING]):
        x, y, w = start[i, 0] - last[i, 0], start[i, 1] - last[i, 1], start[i, 2] - last[i, 2]
        if x != 0.0 or y != 0.0 or w != 0.0:
            move(body_at[i], -h * x, -h * y, -h * w)
    prepare(
        n,
        integers(t[at.JOINT_BODIES], 2 * n).reshape(n, 2),
        body_at,
        integers(t[at.JOINT_AT], n),
        integers(t[at.ACTIVE], n),
        table(t[at.GEOMETRY], n, at.GEOMETRY_WORDS),
        settings,
        table(t[at.JACOBIAN], n, 18),
        table(t[at.DEFORMATION], n, 3),
        table(t[at.LIGHTNESS], n, 3),
        last,
    )
    # The last step's impulses, to start from.
    active, impulse = integers(t[at.ACTIVE], n), table(t[at.IMPULSE], n, 3)
    for k in range(n):
        for i in range(3):
            impulse[k, i] *= ratio * active[k]
    t[at.PUSHED_APART] = 0
    length, room = t[at.HASH_LENGTH], t[at.ROOM]
    t[at.CONTACTS], t[at.MISSED] = collect(
        t[at.MOVING],
        body_at,
        integers(t[at.BODY_KEYS], length),
        integers(t[at.BODY_VALUES], length),
        integers(t[at.PLACES], PLACE_WORDS * room).reshape(room, PLACE_WORDS),
        table(t[at.TOUCHES], room, TOUCH_WORDS),
        h,
    )


@njit(error_model="numpy")
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


@njit(error_model="numpy")
def load_velocities(t, velocity):  # type: ignore[no-untyped-def]
    """Copy the bodies' velocities into ``velocity``; returns whether any differs from what was there."""
    body_at = integers(t[at.BODY_AT], t[at.BODIES])
    differs = False
    for i in range(t[at.BODIES]):
        b, v = floats(body_at[i], BODY_WORDS), velocity[i]
        differs = differs or v[0] != b[VX] or v[1] != b[VX + 1] or v[2] != b[SPIN]
        v[0], v[1], v[2] = b[VX], b[VX + 1], b[SPIN]
    return differs


@njit(error_model="numpy")
def solve(c):  # type: ignore[no-untyped-def]
    """The joints' impulses at the bodies' present velocities, breaking within the step included."""
    t = integers(c, at.CONTROL_WORDS)
    bodies, moving, n, m = t[at.BODIES], t[at.MOVING], t[at.JOINTS], t[at.LOWER]
    if t[at.FAULT] >= 0:
        return
    joint_bodies = integers(t[at.JOINT_BODIES], 2 * n).reshape(n, 2)
    body_at = integers(t[at.BODY_AT], bodies)
    laws = integers(t[at.LAWS], 5 * n).reshape(n, 5)
    settings, scale = floats(t[at.SETTINGS], at.SETTINGS_WORDS), floats(t[at.SCALE], n)
    jacobian, deformation = table(t[at.JACOBIAN], n, 18), table(t[at.DEFORMATION], n, 3)
    impulse, velocity = table(t[at.IMPULSE], n, 3), table(t[at.VELOCITY], bodies, 3)
    predicting = t[at.FRESH] == 1
    if not load_velocities(t, velocity) and not predicting and t[at.CONTACTS] == 0:
        return  # nothing else has touched the structure since it was solved
    t[at.FRESH] = 0
    if predicting:
        # From the velocities without joints, forces would be differences of numbers a million times their size.
        slope = table(t[at.SLOPE], n, 3)
        for k in range(n):
            for i in range(3):
                slope[k, i], impulse[k, i] = impulse[k, i], 0.0
        advance(n, moving, 1.0, joint_bodies, body_at, jacobian, slope, impulse, velocity)
        if t[at.SPREAD] == 1:
            amount, settings[at.SPREAD_IMPULSE] = settings[at.SPREAD_IMPULSE], 0.0
            advance_spread(moving, amount, body_at, table(t[at.PATTERN], bodies, 3), settings, velocity)
    converged, residual, untouched = False, 0.0, True
    for _ in range(_MOST_ROUNDS):
        steps, converged, residual = iterate(
            n,
            moving,
            joint_bodies,
            body_at,
            laws,
            table(t[at.STIFFNESS], n, 6),
            table(t[at.DAMPING], n, 3),
            scale,
            settings,
            integers(t[at.JOINT_SLOT], n),
            integers(t[at.COLUMN_START], moving + 1),
            integers(t[at.COLUMN_ROWS], m),
            integers(t[at.FILL_TARGETS], 1),
            jacobian,
            deformation,
            table(t[at.LIGHTNESS], n, 3),
            impulse,
            velocity,
            table(t[at.RESPONSE], n, at.RESPONSE_WORDS),
            table(t[at.RESIDUAL], n, 3),
            table(t[at.SLOPE], n, 3),
            table(t[at.SOLUTION], t[at.BODIES], 3),
            table(t[at.DIAGONAL], moving, 9),
            table(t[at.LOWER_BLOCKS], m, 9),
            table(t[at.SCALED_BLOCKS], m, 9),
            t[at.SPREAD] == 1,
            table(t[at.PATTERN], bodies, 3),
            table(t[at.IMAGE], bodies, 3),
            settings[at.TOLERANCE],
            predicting,
        )
        t[at.NEWTON_STEPS] += steps
        predicting = False
        change = 0.0
        if t[at.BREAKABLE] == 1:
            change = weaken(
                n,
                joint_bodies,
                laws,
                table(t[at.LIMITS], n, at.LIMITS_WORDS),
                integers(t[at.ACTIVE], n),
                settings,
                jacobian,
                deformation,
                velocity,
                table(t[at.RESULT], n, at.RESULT_WORDS),
                floats(t[at.SCRATCH], 1),
                scale,
            )
        # Contacts are exact for the tangents they were solved with: once the joints agree, nothing is left to do.
        if t[at.CONTACTS] > 0 and (steps > 0 or untouched):
            untouched = False
            change = max(change, touch(t, velocity))
        if change <= _SETTLED:
            break
    settings[at.LAST_RESIDUAL] = residual
    for k in range(n):
        if not math.isfinite(impulse[k, 0] + impulse[k, 1] + impulse[k, 2]):
            refuse(t, k)
            return
    for i in range(moving):
        if not math.isfinite(velocity[i, 0] + velocity[i, 1] + velocity[i, 2]):
            refuse(t, 0)
            return
    if not converged:
        t[at.UNCONVERGED] += 1
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        b[VX], b[VX + 1], b[SPIN] = velocity[i, 0], velocity[i, 1], velocity[i, 2]


@njit(error_model="numpy")
def touch(t, velocity):  # type: ignore[no-untyped-def]
    """Solve the contacts through the structure as it now stands; returns by how much their impulses changed."""
    moving, n, m, count, room = t[at.MOVING], t[at.JOINTS], t[at.LOWER], t[at.CONTACTS], t[at.ROOM]
    joint_bodies = integers(t[at.JOINT_BODIES], 2 * n).reshape(n, 2)
    body_at = integers(t[at.BODY_AT], t[at.BODIES])
    settings = floats(t[at.SETTINGS], at.SETTINGS_WORDS)
    column_start, column_rows = integers(t[at.COLUMN_START], moving + 1), integers(t[at.COLUMN_ROWS], m)
    jacobian, response = table(t[at.JACOBIAN], n, 18), table(t[at.RESPONSE], n, at.RESPONSE_WORDS)
    slope, solution = table(t[at.SLOPE], n, 3), table(t[at.SOLUTION], t[at.BODIES], 3)
    diagonal, lower, scaled = (
        table(t[at.DIAGONAL], moving, 9),
        table(t[at.LOWER_BLOCKS], m, 9),
        table(t[at.SCALED_BLOCKS], m, 9),
    )
    places = integers(t[at.PLACES], PLACE_WORDS * room).reshape(room, PLACE_WORDS)
    touches, g = table(t[at.TOUCHES], room, TOUCH_WORDS), table(t[at.OPERATOR], 2 * room, 2 * room)
    v, change = floats(t[at.CONTACT_VELOCITY], 2 * room), floats(t[at.CONTACT_CHANGE], 2 * room)
    factor = settings[at.STEP] ** 2 * (settings[at.BETA] + settings[at.DELTA])
    assemble(
        n, moving, joint_bodies, body_at, integers(t[at.JOINT_SLOT], n), factor, response, jacobian, diagonal, lower
    )
    factorise(moving, column_start, column_rows, integers(t[at.FILL_TARGETS], 1), diagonal, lower, scaled)
    operator(count, moving, places, touches, column_start, column_rows, diagonal, scaled, solution, g)
    largest = complement(count, places, touches, velocity, g, v, change)
    strike(count, moving, body_at, places, touches, change, velocity, solution)
    # H ΔV = J_cᵀ Δj, and the joints take their part of it: Δλ = -(β + δ) h² D J ΔV.
    substitute(moving, 0, column_start, column_rows, diagonal, scaled, solution)
    still = np.zeros((n, 3))
    linearise(n, moving, joint_bodies, factor, jacobian, still, response, solution, slope)
    impulse = table(t[at.IMPULSE], n, 3)
    advance(n, moving, 1.0, joint_bodies, body_at, jacobian, slope, impulse, velocity)
    if t[at.PUSHED_APART] == 0:
        t[at.PUSHED_APART] = 1
        push_apart(
            count, moving, body_at, places, touches, column_start, column_rows, diagonal, scaled, solution, g, v, change
        )
    return largest


@njit(error_model="numpy")
def refuse(t, joint):  # type: ignore[no-untyped-def]
    """Put the structure's bodies back to where and how they were before the step."""
    t[at.FAULT] = joint
    table(t[at.IMPULSE], t[at.JOINTS], 3)[:, :] = 0.0
    h = floats(t[at.SETTINGS], at.SETTINGS_WORDS)[at.STEP]
    body_at, before = integers(t[at.BODY_AT], t[at.BODIES]), table(t[at.START_VELOCITY], t[at.BODIES], 3)
    last = table(t[at.LAST_VELOCITY], t[at.BODIES], 3)
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        b[VX], b[VX + 1], b[SPIN] = before[i, 0], before[i, 1], before[i, 2]
        move(body_at[i], -h * last[i, 0], -h * last[i, 1], -h * last[i, 2])


@njit(error_model="numpy")
def finish(c):  # type: ignore[no-untyped-def]
    """End of a step: commit the laws, and tell Python when a joint broke or the step was refused."""
    t = integers(c, at.CONTROL_WORDS)
    if t[at.FAULT] < 0:
        n, bodies = t[at.JOINTS], t[at.BODIES]
        velocity = table(t[at.LAST_VELOCITY], bodies, 3)
        load_velocities(t, velocity)
        t[at.BROKE] = commit(
            n,
            integers(t[at.JOINT_BODIES], 2 * n).reshape(n, 2),
            integers(t[at.LAWS], 5 * n).reshape(n, 5),
            table(t[at.LIMITS], n, at.LIMITS_WORDS),
            integers(t[at.ACTIVE], n),
            table(t[at.DAMPING], n, 3),
            floats(t[at.SETTINGS], at.SETTINGS_WORDS),
            table(t[at.JACOBIAN], n, 18),
            table(t[at.DEFORMATION], n, 3),
            velocity,
            table(t[at.IMPULSE], n, 3),
            floats(t[at.SCALE], n),
            table(t[at.RESULT], n, at.RESULT_WORDS),
        )
    if t[at.FAULT] >= 0 or t[at.BROKE] > 0 or t[at.MISSED] > 0:
        call_notice(t[at.NOTICE], t[at.KEY])


def _digest() -> str:
    """Digest of all source that goes into the callbacks."""
    here = Path(__file__).parent
    files = sorted([*here.glob("*.py"), here.parent / "memory.py", here.parent / "chipmunk.py"])
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _compile(digest: str) -> tuple[Any, ...]:
    """The C functions; ``digest`` makes Numba's cache of them depend on the source of what they call."""
    step = types.void(types.int64, types.float64)

    @cfunc(step, cache=True)
    def pre_step(constraint, h):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        t = integers(c, at.CONTROL_WORDS)
        if t[at.LEADER] == 0:
            t[at.LEADER] = constraint
            begin(c, h)

    @cfunc(step, cache=True)
    def apply_cached_impulse(constraint, ratio):  # type: ignore[no-untyped-def]
        # Nothing: the first solve of a step starts from the cached impulses by itself.
        digest  # noqa: B018

    @cfunc(step, cache=True)
    def apply_impulse(constraint, h):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        if integers(c, at.CONTROL_WORDS)[at.LEADER] == constraint:
            solve(c)

    @cfunc(types.float64(types.int64), cache=True)
    def get_impulse(constraint):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        own = integers(constraint, CONTROL + 2)
        t = integers(own[CONTROL], at.CONTROL_WORDS)
        p = table(t[at.IMPULSE], t[at.JOINTS], 3)[own[CONTROL + 1]]
        return math.hypot(p[0], p[1])

    @cfunc(types.void(types.int64, types.int64), cache=True)
    def after_step(constraint, space):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        t = integers(c, at.CONTROL_WORDS)
        if t[at.LEADER] == constraint:
            t[at.LEADER] = 0
            finish(c)

    return pre_step, apply_cached_impulse, apply_impulse, get_impulse, after_step


_COMPILED = _compile(_digest())
#: Chipmunk's table of functions for a constraint.
FUNCTIONS = np.array([function.address for function in _COMPILED[:4]], dtype=np.int64)
AFTER_STEP = _COMPILED[4].address
