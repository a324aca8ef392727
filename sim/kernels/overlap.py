"""Taking out overlap, through the structures: pseudo-velocities that move the bodies once and carry no momentum.

A structure that something holds does not give way to a loose body: to push them apart would strain its joints, and
what lies on it in a pile would bend it for good with energy that nothing has given.
"""

import math

from sim.chipmunk import BIAS_SPIN, BIAS_VX, BODY_FULL_WORDS, BODY_WORDS, MASS_INVERSE
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import solve
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
from sim.kernels.rows import move_loose, push_loose, sum_up
from sim.memory import floats, kernel

# Of projected Gauss–Seidel: what lies wedged can be pushed apart by none, and overlap is taken out by shares anyway.
_SWEEPS, _ENOUGH = 50, 1e-4
# Of the kinetic energy.
_FREE = 1e-9


@kernel
def push_apart(head, places, touches, g, v, change):  # type: ignore[no-untyped-def]
    """Pseudo-velocities that take out overlap, through the structures."""
    any_overlap = False
    for k in range(len(places)):
        v[2 * k], v[2 * k + 1] = 0.0, 0.0
        change[2 * k], change[2 * k + 1] = 0.0, 0.0
        any_overlap = any_overlap or touches[k, PUSH] > 0.0
    if not any_overlap:
        return
    for k in range(len(places)):
        if stands(places[k]):
            g[2 * k] = 0.0
            move_loose(places, touches, 2 * k, g[2 * k])
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
    through = change.copy()
    for k in range(len(places)):
        if stands(places[k]):
            push_loose(places[k], touches[k], 2 * k, change[2 * k], BIAS_VX, BIAS_SPIN)
            through[2 * k] = 0.0
    share = share_to_push(head, places, touches, through)
    for r in range(0, len(v), 2):
        push_loose(places[r >> 1], touches[r >> 1], r, share * through[r], BIAS_VX, BIAS_SPIN)
    c = head
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
def stands(place):  # type: ignore[no-untyped-def]
    """Whether a contact is one of a structure that something holds with a loose body, which moves out of it alone."""
    owner, loose = (place[OWNER_A], place[BODY_B]) if place[OWNER_A] != 0 else (place[OWNER_B], place[BODY_A])
    one_side = place[OWNER_A] == 0 or place[OWNER_B] == 0
    return (
        one_side and owner != 0 and views.control(owner)[at.FREE] == 0 and floats(loose, BODY_WORDS)[MASS_INVERSE] > 0.0
    )


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
