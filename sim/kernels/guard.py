"""No energy from nowhere: what closes the ledger's numerical dissipation from below in implicit Euler.

Directions of forces are those of a step's start, and a joint's force may turn round from one step to the next while the
move between was made against the old one. The numerical dissipation shows what that creates: where bodies turn by an
angle φ in a step under compression, a share of φ² of the energy, and where a yielding joint is thrown back, up to the
plastic work of its last move. Three things keep it from being negative, one after the other:

- a contact's impulse that also balances joints within the step has lost no more in an impact than there was;
- what the step has created is taken out of the motion of the bodies relative to each other again: velocities go towards
  those of the structure moving as a rigid body, or towards rest if it is held, which leaves both momenta of a free
  structure as they are;
- where there is too little motion for that, as after a step that did not converge, plastic work is not booked until
  dissipation has caught up with it.
"""

import math

from sim.chipmunk import BODY_WORDS, SPIN, VX, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.layout import (
    BETA,
    LEDGER_CONTACT,
    LEDGER_EXTERNAL,
    LEDGER_KINETIC,
    LEDGER_NUMERICAL,
    LEDGER_PLASTIC,
    LEDGER_TO_COME,
)
from sim.memory import floats, kernel

# Share of the ledger's largest entry that is rounding.
_ROUNDING = 1e-13


@kernel
def close_from_below(t, contact, plastic, numerical):  # type: ignore[no-untyped-def]
    """Do so; the ledger's entries as they were before this step [J]."""
    ledger = views.ledger(t)
    if views.settings(t)[BETA] != 0.0 or ledger[LEDGER_NUMERICAL] >= 0.0:
        return
    move_between(ledger, LEDGER_CONTACT, ledger[LEDGER_CONTACT] - contact)
    largest = max(ledger[LEDGER_KINETIC], abs(ledger[LEDGER_EXTERNAL]))
    take_out(t, min(-_ROUNDING * largest, numerical) - ledger[LEDGER_NUMERICAL])
    ledger[LEDGER_TO_COME] += move_between(ledger, LEDGER_PLASTIC, ledger[LEDGER_PLASTIC] - plastic)


@kernel
def move_between(ledger, entry, most):  # type: ignore[no-untyped-def]
    """Move what numerical dissipation lacks from an ``entry``, ``most`` at the most [J]; returns how much."""
    moved = max(min(-ledger[LEDGER_NUMERICAL], most), 0.0)
    ledger[entry] -= moved
    ledger[LEDGER_NUMERICAL] += moved
    return moved


@kernel
def take_out(t, energy):  # type: ignore[no-untyped-def]
    """Take ``energy`` [J] out of the relative motion of a structure's bodies, as far as there is any."""
    if energy <= 0.0:
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
    taken = min(energy, inner)
    if taken <= 0.0:
        return
    less = 1.0 - math.sqrt(1.0 - taken / inner)
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        b[VX] -= less * (b[VX] - vx + turn * (b[X + 1] - y))
        b[VX + 1] -= less * (b[VX + 1] - vy - turn * (b[X] - x))
        b[SPIN] -= less * (b[SPIN] - turn)
    ledger = views.ledger(t)
    ledger[LEDGER_KINETIC] -= taken
    ledger[LEDGER_NUMERICAL] += taken
