"""The average-acceleration rule: from q*, halfway through a step, to its end, and to where its velocities belong.

See `commit` for the plastic flow, and `energy` for the ledger.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.kinematics import quadratic
from sim.kernels.layout import FLOW, RESULT_BEFORE, RESULT_ELASTIC
from sim.kernels.residual import motion_scale
from sim.memory import floats, kernel


@kernel
def go_all_the_way(state, old, count, whole):  # type: ignore[no-untyped-def]
    """Let a state that a law took from ``old`` to where it is now go ``whole`` times that way."""
    now, before = floats(state, count), floats(old, count)
    for i in range(count):
        now[i] = before[i] + whole * (now[i] - before[i])


@kernel
def half_a_step_on(t, k, x, y, z, u, v, turn, more, out):  # type: ignore[no-untyped-def]
    """Elastic energy of joint k half a step after its position, where the velocities are, less that at q*.

    That is s·dq + ½ dq·K dq for dq = (u, v, turn), q_n + ½ h q̇₁ - q*, less the plastic flow after q*, which is ``more``
    times that before it; with the rates of deformation q̇₁ = (x, y, z) after the step.
    """
    damping, s, stiff = views.damping(t), views.response(t)[k], views.stiffness(t)[k]
    u, v, turn = u - more * out[FLOW], v - more * out[FLOW + 1], turn - more * out[FLOW + 2]
    linear = (s[0] - damping[k, 0] * x) * u + (s[1] - damping[k, 1] * y) * v + (s[2] - damping[k, 2] * z) * turn
    return linear + 0.5 * quadratic(stiff, u, v, turn)


@kernel
def take_back(t, elastic):  # type: ignore[no-untyped-def]
    """Keep joints' elastic energy half a step on, ``elastic`` in all, to what there is energy for.

    What the step does not resolve would be taken for stretched by as much as it moves in half of one. Returns what
    was over.
    """
    active, result, ahead, total = views.active(t), views.result(t), views.per_joint(t, at.SLOPE), 0.0
    for k in range(t[at.JOINTS]):
        total += active[k] * ahead[k, 0]
    there = motion_scale(t) + max(elastic - total, 0.0)
    if total <= there:
        return 0.0
    share = 1.0 - there / total
    for k in range(t[at.JOINTS]):
        if active[k] != 0:
            result[k, RESULT_ELASTIC] -= share * ahead[k, 0]
            result[k, RESULT_BEFORE] = result[k, RESULT_ELASTIC]
    return total - there
