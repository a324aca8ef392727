"""Whether the average-acceleration rule resolves how a structure's bodies turn.

The rule keeps the energy of the joints from the middle of one move, where it finds their deformations to be
q* + ¼ h J (V₀ + V₁), to the middle of the next. What they are in the middle of a move of length h is

    q(x - ½ h V) = q - ½ h J V + ⅛ h² V·(∂J/∂x)·V + …,

with the bodies' places x and the joints' gradient J at its end. The two differ by what is of third order in the angles
φ by which bodies turn in a step, or of second where their velocities turn round from one step to the next. In joints
much stiffer than the motion that the step resolves, hω ≫ 1, that is energy from nowhere: ½ k (r φ³)² of ½ m (r φ/h)²,
all of it from φ = 1/√(hω) on, 1° a step for 40 mm of steel at 60 Hz. So where it comes to more than a share of the
energy that there is, the step is taken by implicit Euler.

Implicit Euler finds deformations at the end of a move instead, ½ h J V further on, so the step after one of its own is
averaged again where that is little: not while anything in it moves faster than the steps resolve. A structure that
moved before there were joints begins with a step of implicit Euler, too. In the default scheme, which averages only
after what came suddenly, what follows forces is of implicit Euler from then on, and what follows impulses once parts
are too long for what has been averaged.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.kinematics import prepare, quadratic, rates
from sim.kernels.layout import (
    AFTER_FORCES,
    BETA,
    DELTA,
    LEDGER_ELASTIC,
    LEDGER_KINETIC,
    ROUNDING,
    STEP,
    UNDAMPED,
    WANTED_BETA,
)
from sim.kernels.lengths import LONGEST_PART
from sim.memory import inlined, kernel

# (ωh)² of what is slow.
_SLOW = 0.25
# Of a structure's energy: after a step of the average-acceleration rule, and of implicit Euler.
_STRAYED, _BETWEEN = 1e-2, 0.1


@inlined
def prepare_step(t, averaged):  # type: ignore[no-untyped-def]
    """Deformations and gradients at the start of a step or a part of it, by a rule that resolves it.

    Whether the last was one of the average-acceleration rule tells ``averaged``.
    """
    settings, ledger = views.settings(t), views.ledger(t)
    share = _STRAYED if averaged else _BETWEEN
    strayed = prepare(t) > share * (ledger[LEDGER_KINETIC] + ledger[LEDGER_ELASTIC]) + settings[ROUNDING]
    if strayed:
        settings[BETA], settings[DELTA] = 0.0, 1.0
        if settings[UNDAMPED] == AFTER_FORCES or (averaged and settings[WANTED_BETA] == 0.0):
            settings[UNDAMPED] = 0.0
        prepare(t)


@kernel
def is_slow(t):  # type: ignore[no-untyped-def]
    """Whether what moves in a structure does so with less than half a radian of its vibration in a part."""
    last, step = views.per_body(t, at.LAST_VELOCITY), views.settings(t)[STEP]
    part = min(step, LONGEST_PART) / step
    return part * part * loss_of_joints(t, last) <= _SLOW * views.ledger(t)[LEDGER_KINETIC]


@kernel
def loss_of_joints(t, velocity):  # type: ignore[no-untyped-def]
    """Elastic energy ½ Δq·K Δq of what the joints are deformed by at these velocities in a part [J]."""
    joint_bodies, gradient, stiffness = views.joint_bodies(t), views.gradient(t), views.stiffness(t)
    h, lost = views.settings(t)[STEP], 0.0
    for k in range(t[at.JOINTS]):
        x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        lost += 0.5 * h * h * quadratic(stiffness[k], x, y, z)
    return lost
