"""Blows by ties: what a rope catches, a pivot that is put on in flight, bodies at ties that are given velocities.

A tie that bodies' velocities at the start of a step run counter to stops them within the step, as a contact does. How
fast it finds them is what Chipmunk's own functions say: with the masses of the two bodies alone, they take that speed
away. What they do to bodies at rest is to put right where these are, or to start a motor. Where that goes on against
what they do to the velocities that there are, both tell how long ago the tie began to be in the way, which is as late
as the blow is noticed, see `late`.

Springs, and what has a greatest force, are forces that act for as long as they do: they give no blows.
"""

import math

import numpy as np

from sim.chipmunk import (
    BODY_WORDS,
    CONSTRAINT_ERROR_BIAS,
    CONSTRAINT_MAX_FORCE,
    CONSTRAINT_WORDS,
    MASS_INVERSE,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.layout import WHOLE_STEP
from sim.kernels.noted import NOTES_WORDS, SPEED, TIES_COUNT, row_of
from sim.kernels.ties import (
    APPLY_IMPULSE,
    CONSTRAINT,
    INDEX,
    KIND,
    LATE,
    OWNER,
    PRE_STEP,
    address_of,
    body_of,
    call_for,
    impulse_of,
    is_of,
    is_spring,
    slacken,
    tie_at,
    way_of,
)
from sim.memory import floats, integers, kernel
from sim.stock import KIND_ARMS, KIND_WAY, KIND_WORDS, LINE, TURN

# Over what outer forces, and the turning of the bodies, give in a step.
_SUDDEN = 2.0


@kernel
def lateness_of(tie):  # type: ignore[no-untyped-def]
    """How long ago a tie began to give a blow [s], below 0 if it gives none."""
    return tie[LATE : LATE + 1].view(np.float64)


@kernel
def catches(tie):  # type: ignore[no-untyped-def]
    """Whether a tie gives a blow in this step."""
    return lateness_of(tie)[0] >= 0.0


@kernel
def blow_by_ties(head, worth):  # type: ignore[no-untyped-def]
    """Energy of the largest blow that a group's ties give in the step that begins, if it is ``worth`` it, or 0 [J]."""
    t, largest = views.control(head), 0.0
    if t[at.NOTES] == 0:
        return 0.0
    notes, h = integers(t[at.NOTES], NOTES_WORDS), views.settings(t)[WHOLE_STEP]
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        if not is_of(tie, head):
            continue
        late = lateness_of(tie)
        late[0] = -1.0
        bounded = floats(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_MAX_FORCE] < math.inf
        if is_spring(tie) or bounded:
            continue
        speed, since = struck_by(tie, h)
        energy = 0.5 * min(mass_at(tie, 0), mass_at(tie, 1)) * speed * speed
        if energy > worth:
            late[0], largest = since, max(largest, energy)
    return largest


@kernel
def struck_by(tie, h):  # type: ignore[no-untyped-def]
    """Speed that a tie takes away suddenly in a step ``h``, or 0, and since when it has been in the way [s]."""
    start, now, still = np.empty((2, 3)), np.empty((2, 3)), np.zeros((2, 3))
    for side in range(2):
        begun_with(tie, side, start[side], now[side])
    to_place, taken = response(tie, still, h), response(tie, start, h)
    slacken(tie)
    speed, pushed, counter, back = 0.0, 0.0, 0.0, 0.0
    for row in range(len(impulse_of(tie))):
        stopped, forced = taken[row] - to_place[row], 0.0
        counter, back = counter + stopped * stopped, back + stopped * to_place[row]
        for side in range(2):
            x, y, turn = way_of(tie, side, row)
            forced += x * (now[side, 0] - start[side, 0]) + y * (now[side, 1] - start[side, 1])
            forced += turn * (now[side, 2] - start[side, 2])
        speed, pushed = speed + taken[row] * taken[row], pushed + forced * forced
    speed = math.sqrt(speed)
    if speed <= _SUDDEN * (math.sqrt(pushed) + by_turning(tie, start, h)):
        return 0.0, 0.0
    # Chipmunk has it put right a share of what there is in a step.
    share = 1.0 - floats(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_ERROR_BIAS] ** h
    return speed, max(back / counter * h / share, 0.0) if share > 0.0 and counter > 0.0 else 0.0


@kernel
def begun_with(tie, side, start, now):  # type: ignore[no-untyped-def]
    """Velocities of a tie's body as the step began, and as forces have changed them since."""
    b, owner = body_of(tie, side), tie[OWNER + side]
    for axis in range(3):
        start[axis] = now[axis] = b[SPIN] if axis == 2 else b[VX + axis]
    if owner != 0:
        t, i = views.control(owner), tie[INDEX + side]
        begun, present = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.VELOCITY)
        for axis in range(3):
            start[axis], now[axis] = begun[i, axis], present[i, axis]
    elif b[MASS_INVERSE] > 0.0:
        row = row_of(views.control(tie[OWNER + 1 - side]), address_of(tie, side))
        for axis in range(3 if row != 0 else 0):
            start[axis] = floats(row + 8 * SPEED, 3)[axis]


@kernel
def response(tie, velocity, h):  # type: ignore[no-untyped-def]
    """By how much a tie changes the velocities of its ends against each other, with bodies that have these, alone."""
    impulse, kept, changed = impulse_of(tie), np.zeros(2), np.zeros(2)
    before = np.empty((2, 3))
    for side in range(2):
        b = body_of(tie, side)
        before[side, 0], before[side, 1], before[side, 2] = b[VX], b[VX + 1], b[SPIN]
        b[VX], b[VX + 1], b[SPIN] = velocity[side, 0], velocity[side, 1], velocity[side, 2]
    for i in range(len(impulse)):
        kept[i], impulse[i] = impulse[i], 0.0
    call_for(tie, PRE_STEP, h)
    call_for(tie, APPLY_IMPULSE, h)
    for i in range(len(impulse)):
        impulse[i] = kept[i]
        for side in range(2):
            b = body_of(tie, side)
            x, y, turn = way_of(tie, side, i)
            changed[i] += x * (b[VX] - velocity[side, 0]) + y * (b[VX + 1] - velocity[side, 1])
            changed[i] += turn * (b[SPIN] - velocity[side, 2])
    for side in range(2):
        b = body_of(tie, side)
        b[VX], b[VX + 1], b[SPIN] = before[side, 0], before[side, 1], before[side, 2]
    return changed


@kernel
def by_turning(tie, start, h):  # type: ignore[no-untyped-def]
    """How fast the ends of a tie move against each other after a step in which they did not, as bodies turn."""
    kind = integers(tie[KIND], KIND_WORDS)
    if kind[KIND_WAY] == TURN:
        return 0.0
    arms, speed = floats(tie[CONSTRAINT], kind[KIND_ARMS] + 4)[kind[KIND_ARMS] :], 0.0
    a, b = body_of(tie, 0), body_of(tie, 1)
    for side in range(2):
        w = start[side, 2]
        speed += w * w * math.hypot(arms[2 * side], arms[2 * side + 1])
    u = start[1, 0] - start[1, 2] * arms[3] - start[0, 0] + start[0, 2] * arms[1]
    v = start[1, 1] + start[1, 2] * arms[2] - start[0, 1] - start[0, 2] * arms[0]
    x, y = b[X] + arms[2] - a[X] - arms[0], b[X + 1] + arms[3] - a[X + 1] - arms[1]
    length = math.hypot(x, y)
    if kind[KIND_WAY] == LINE and length > 0.0:
        across = (x * v - y * u) / length
        return h * (speed + across * across / length)
    return h * speed


@kernel
def mass_at(tie, side):  # type: ignore[no-untyped-def]
    """Mass of what a tie holds at its body a (``side`` 0) or b, or its moment of inertia if the tie works on that."""
    b, turns, owner = body_of(tie, side), integers(tie[KIND], KIND_WORDS)[KIND_WAY] == TURN, tie[OWNER + side]
    if b[MASS_INVERSE] == 0.0:
        return math.inf
    if owner == 0:
        return moment_of(b) if turns else mass_of(b)
    t, total = views.control(owner), 0.0
    bodies = views.body_at(t)
    for i in range(t[at.MOVING]):
        one = floats(bodies[i], BODY_WORDS)
        x, y = one[X] - b[X], one[X + 1] - b[X + 1]
        total += moment_of(one) + mass_of(one) * (x * x + y * y) if turns else mass_of(one)
    return total
