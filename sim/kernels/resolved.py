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
moved before there were joints begins with a step of implicit Euler, too. In the default scheme, which averages only in
parts after what came suddenly, the parts that follow are of implicit Euler from then on.
"""

from sim.kernels import views
from sim.kernels.kinematics import prepare
from sim.kernels.layout import BETA, DELTA, LEDGER_ELASTIC, LEDGER_KINETIC, ROUNDING, UNDAMPED
from sim.memory import inlined

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
        settings[BETA], settings[DELTA], settings[UNDAMPED] = 0.0, 1.0, 0.0
        prepare(t)
