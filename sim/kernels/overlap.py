"""Taking out overlap: pseudo-velocities that move the bodies once and carry no momentum.

Moving pieces of a structure against each other strains its joints, with energy that nothing has given: what lies in a
pile on a structure would bend it for good, and what broke off and lies across its neighbours would tear on. So a
structure that nothing holds moves as one rigid body, and one that something holds stays: what is loose moves out of
it. Pieces of one structure stay as they are. Only between structures that are held, and between those and the ground,
nothing else can move than their pieces; they do as far as energy that was lost goes.
"""

import math

import numpy as np

from sim.chipmunk import BIAS_SPIN, BIAS_VX, BODY_FULL_WORDS, BODY_WORDS, MASS_INVERSE, X, Y
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import solve
from sim.kernels.delassus import respond_to
from sim.kernels.inertia import as_rigid_body
from sim.kernels.kinematics import rates
from sim.kernels.layout import (
    BODY_A,
    BODY_B,
    LEDGER_CONTACT,
    LEDGER_KINETIC,
    LEDGER_NUMERICAL,
    OWNER_A,
    OWNER_B,
    PUSH,
    WHOLE_STEP,
)
from sim.kernels.rows import direction, move_loose, push_loose, sum_up
from sim.memory import floats, kernel

# Of projected Gauss–Seidel: what lies wedged can be pushed apart by none, and overlap is taken out by shares anyway.
_SWEEPS, _ENOUGH = 50, 1e-4
# Of the kinetic energy.
_FREE = 1e-9
# Of a structure as one rigid body: inverse mass and moment of inertia, centre, pseudo-velocity there.
_LIGHT, _TURNS, _CENTRE, _SHIFT, _FRAME_WORDS = 0, 1, 2, 4, 7


@kernel
def push_apart(head, places, touches):  # type: ignore[no-untyped-def]
    """Pseudo-velocities that take out overlap."""
    any_overlap = False
    for k in range(len(places)):
        any_overlap = any_overlap or touches[k, PUSH] > 0.0
    if not any_overlap:
        return
    frames = frames_of(head)
    of, arms = sides_of(head, frames, places, touches)
    v, change = np.zeros(2 * len(places)), np.zeros(2 * len(places))
    g = np.zeros((len(v), len(v)))
    for k in range(len(places)):
        if bends(places[k], of[k]):
            respond_to(places, touches, 2 * k, g[2 * k])
        else:
            move_loose(places, touches, 2 * k, g[2 * k])
            move_frames(frames, of, arms, touches, k, g[2 * k])
    for _ in range(_SWEEPS):
        moved, size = 0.0, 0.0
        for r in range(0, len(v), 2):
            if g[r, r] <= 0.0:
                continue
            new = max(change[r] + (touches[r >> 1, PUSH] - v[r]) / g[r, r], 0.0)
            step = new - change[r]
            size = max(size, new)
            if step != 0.0:
                moved = max(moved, abs(step))
                change[r] = new
                for k in range(0, len(v), 2):
                    v[k] += g[r, k] * step
        if moved <= _ENOUGH * size:
            break
    any_bends = False
    for k in range(len(places)):
        if bends(places[k], of[k]):
            any_bends = any_bends or change[2 * k] > 0.0
            continue
        push_loose(places[k], touches[k], 2 * k, change[2 * k], BIAS_VX, BIAS_SPIN)
        push_frames(frames, of[k], arms[k], touches[k], change[2 * k])
        change[2 * k] = 0.0
    shift_rigidly(head, frames)
    if any_bends:
        bend(head, places, touches, change)


@kernel
def bends(place, of):  # type: ignore[no-untyped-def]
    """Whether nothing else can give way at a contact than pieces of structures that are held."""
    if place[OWNER_A] == place[OWNER_B] or of[0] >= 0 or of[1] >= 0:
        return False
    if place[OWNER_A] == 0:
        return floats(place[BODY_A], BODY_WORDS)[MASS_INVERSE] == 0.0
    return place[OWNER_B] != 0 or floats(place[BODY_B], BODY_WORDS)[MASS_INVERSE] == 0.0


@kernel
def frames_of(head):  # type: ignore[no-untyped-def]
    """All structures of a group as rigid bodies; those that something holds have no inverse mass."""
    count, c = 0, head
    while c != 0:
        count, c = count + 1, views.control(c)[at.NEXT]
    frames, i, c = np.zeros((count, _FRAME_WORDS)), 0, head
    while c != 0:
        t, frame = views.control(c), frames[i]
        if t[at.FREE] == 1:
            mass, x, y, moment = as_rigid_body(t)
            frame[_LIGHT], frame[_TURNS], frame[_CENTRE], frame[_CENTRE + 1] = 1.0 / mass, 1.0 / moment, x, y
        i, c = i + 1, t[at.NEXT]
    return frames


@kernel
def sides_of(head, frames, places, touches):  # type: ignore[no-untyped-def]
    """Which frame is on either side of each contact (or -1), and the moment about its centre of a normal impulse."""
    of, arms = np.full((len(places), 2), -1), np.zeros((len(places), 2))
    for k in range(len(places)):
        place = places[k]
        if place[OWNER_A] == place[OWNER_B]:
            continue
        dx, dy, ma, mb = direction(touches[k], 0)
        i, c = 0, head
        while c != 0:
            frame = frames[i]
            for side in range(2):
                if place[OWNER_A if side == 0 else OWNER_B] == c and frame[_LIGHT] > 0.0:
                    b = floats(place[BODY_A] if side == 0 else place[BODY_B], BODY_WORDS)
                    arm = (b[X] - frame[_CENTRE]) * dy - (b[Y] - frame[_CENTRE + 1]) * dx
                    of[k, side], arms[k, side] = i, arm + (ma if side == 0 else mb)
            i, c = i + 1, views.control(c)[at.NEXT]
    return of, arms


@kernel
def move_frames(frames, of, arms, touches, k, velocities):  # type: ignore[no-untyped-def]
    """Add to the ``velocities`` of all rows what contact k's unit impulse gives them by moving frames."""
    dx, dy, _, _ = direction(touches[k], 0)
    for side in range(2):
        if of[k, side] < 0:
            continue
        frame = frames[of[k, side]]
        for m in range(len(touches)):
            ex, ey, _, _ = direction(touches[m], 0)
            for there in range(2):
                if of[m, there] == of[k, side]:
                    turned = arms[k, side] * arms[m, there] * frame[_TURNS]
                    given = (dx * ex + dy * ey) * frame[_LIGHT] + turned
                    velocities[2 * m] += given if side == there else -given


@kernel
def push_frames(frames, of, arms, touch, amount):  # type: ignore[no-untyped-def]
    """Give a contact's normal pseudo-impulse to the frames on its sides."""
    dx, dy, _, _ = direction(touch, 0)
    for side in range(2):
        if of[side] >= 0:
            frame, signed = frames[of[side]], amount if side == 1 else -amount
            frame[_SHIFT] += signed * dx * frame[_LIGHT]
            frame[_SHIFT + 1] += signed * dy * frame[_LIGHT]
            frame[_SHIFT + 2] += signed * arms[side] * frame[_TURNS]


@kernel
def shift_rigidly(head, frames):  # type: ignore[no-untyped-def]
    """Pseudo-velocities by which the next move takes all bodies of a frame along as one rigid body."""
    i, c = 0, head
    while c != 0:
        t, frame = views.control(c), frames[i]
        x, y, turn = frame[_SHIFT], frame[_SHIFT + 1], frame[_SHIFT + 2]
        if x != 0.0 or y != 0.0 or turn != 0.0:
            body_at, h = views.body_at(t), views.settings(t)[WHOLE_STEP]
            # Along arcs, not tangents: stiff joints would be strained by what lies between.
            less, across = (math.cos(h * turn) - 1.0) / h, math.sin(h * turn) / h
            for k in range(t[at.MOVING]):
                b = floats(body_at[k], BODY_FULL_WORDS)
                rx, ry = b[X] - frame[_CENTRE], b[Y] - frame[_CENTRE + 1]
                b[BIAS_VX] += x + less * rx - across * ry
                b[BIAS_VX + 1] += y + less * ry + across * rx
                b[BIAS_SPIN] += turn
        i, c = i + 1, t[at.NEXT]


@kernel
def bend(head, places, touches, change):  # type: ignore[no-untyped-def]
    """Take out overlap between what is held, through its joints, by pseudo-impulses ``change``."""
    share, c = share_to_push(head, places, touches, change), head
    while c != 0:
        t = views.control(c)
        solution, body_at = views.per_body(t, at.SOLUTION), views.body_at(t)
        for i in range(t[at.MOVING]):
            b = floats(body_at[i], BODY_FULL_WORDS)
            b[BIAS_VX] += share * solution[i, 0]
            b[BIAS_VX + 1] += share * solution[i, 1]
            b[BIAS_SPIN] += share * solution[i, 2]
        c = t[at.NEXT]


@kernel
def share_to_push(head, places, touches, change):  # type: ignore[no-untyped-def]
    """What share of the pseudo-impulses ``change`` may act; leaves the pseudo-velocities of all of it in the solutions.

    Taking out overlap strains the joints, and must not do more elastic work on them than the structures have lost so
    far: a body that has come to lie between two pieces would wedge them apart with energy that nothing has given.
    """
    work, lost, c = 0.0, 0.0, head
    while c != 0:
        t = views.control(c)
        solution, ledger = views.per_body(t, at.SOLUTION), views.ledger(t)
        sum_up(c, places, touches, change, solution)
        solve(t, 0, solution)
        work += work_to_shift(t, solution, views.settings(t)[WHOLE_STEP])
        # A shift of all that strains nothing but by rounding is free.
        lost += ledger[LEDGER_CONTACT] + ledger[LEDGER_NUMERICAL] + _FREE * ledger[LEDGER_KINETIC]
        c = t[at.NEXT]
    return math.sqrt(max(lost, 0.0) / work) if work > max(lost, 0.0) else 1.0


@kernel
def work_to_shift(t, velocity, h):  # type: ignore[no-untyped-def]
    """Elastic energy that moving at ``velocity`` for a time ``h`` stores in joints that bear nothing [J]."""
    joint_bodies, gradient, stiffness, active = (
        views.joint_bodies(t),
        views.gradient(t),
        views.stiffness(t),
        views.active(t),
    )
    work = 0.0
    for k in range(t[at.JOINTS]):
        if active[k]:
            x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
            along = x * (stiffness[k, 0] * x + 2.0 * (stiffness[k, 1] * y + stiffness[k, 2] * z))
            work += along + y * (stiffness[k, 3] * y + 2.0 * stiffness[k, 4] * z) + z * stiffness[k, 5] * z
    return 0.5 * h * h * work
