"""No energy from nowhere.

Where bodies turn by a radian or more within a step, the directions of its start say little about its end, and the
ledger of implicit Euler may come to a numerical dissipation below zero. What is missing is then taken out of the motion
of the bodies relative to each other: velocities go towards those of the structure moving as a rigid body, or towards
rest if it is held, which leaves both momenta of a free structure as they are.

The ledger books work over the way that Chipmunk moves the bodies next, half a step after their velocities. Where a
structure swings up against its weight, it runs ahead by half a step's work, and that much is let pass.
"""

import math

from numba import njit

from sim.chipmunk import BODY_WORDS, SPIN, VX, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.layout import BETA, LEDGER_EXTERNAL, LEDGER_KINETIC, LEDGER_NUMERICAL
from sim.memory import floats

# Share of the ledger's largest entry that is rounding.
_ROUNDING = 1e-13


@njit(error_model="numpy")
def take_out_what_was_created(t, before):  # type: ignore[no-untyped-def]
    """Close the ledger's numerical dissipation from below; ``before`` is the external work before this step [J]."""
    ledger = views.ledger(t)
    largest = max(ledger[LEDGER_KINETIC], abs(ledger[LEDGER_EXTERNAL]))
    allowed = 0.5 * abs(ledger[LEDGER_EXTERNAL] - before) + _ROUNDING * largest
    missing = -allowed - ledger[LEDGER_NUMERICAL]
    if missing <= 0.0 or views.settings(t)[BETA] != 0.0:
        return
    body_at, moving = views.body_at(t), t[at.MOVING]
    mass, x, y, vx, vy, turn = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if t[at.FREE] == 1:
        for i in range(moving):
            b = floats(body_at[i], BODY_WORDS)
            m = mass_of(b)
            mass, x, y = mass + m, x + m * b[X], y + m * b[X + 1]
            vx, vy = vx + m * b[VX], vy + m * b[VX + 1]
        x, y, vx, vy = x / mass, y / mass, vx / mass, vy / mass
        inertia = 0.0
        for i in range(moving):
            b = floats(body_at[i], BODY_WORDS)
            m, dx, dy = mass_of(b), b[X] - x, b[X + 1] - y
            inertia += moment_of(b) + m * (dx * dx + dy * dy)
            turn += moment_of(b) * b[SPIN] + m * (dx * (b[VX + 1] - vy) - dy * (b[VX] - vx))
        turn /= inertia
    inner = 0.0
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        u, v, w = b[VX] - vx + turn * (b[X + 1] - y), b[VX + 1] - vy - turn * (b[X] - x), b[SPIN] - turn
        inner += 0.5 * (mass_of(b) * (u * u + v * v) + moment_of(b) * w * w)
    taken = min(missing, inner)
    if taken <= 0.0:
        return
    less = 1.0 - math.sqrt(1.0 - taken / inner)
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        b[VX] -= less * (b[VX] - vx + turn * (b[X + 1] - y))
        b[VX + 1] -= less * (b[VX + 1] - vy - turn * (b[X] - x))
        b[SPIN] -= less * (b[SPIN] - turn)
    ledger[LEDGER_KINETIC] -= taken
    ledger[LEDGER_NUMERICAL] += taken
