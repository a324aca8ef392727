"""No joint bears more than it can, whatever a step's solution is worth.

What a joint bears, λ, and what its law makes of the solution's velocities, s(q*), differ by a residual: by anything
where a step has not converged, and by a lot to weak joints where bodies are so fast that it is little to velocities. So
impulses outside the yield surface are brought back to it. Once the law has flowed at q*, it would bear λ at

    q = q* + K⁻¹ (-λ/h - s(q*)),

with its elastic stiffness K, if that were inside; if not, its force there is the one on the yield surface that is
nearest in elastic energy. Bodies are given the difference in pairs, as ever. What is little is left alone: in long
steps the bodies' way would change what stiff joints bear by many times as much.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.commit import copy
from sim.kernels.kinematics import rates
from sim.kernels.layout import COMMIT_WORDS, FLOW, RESPONSE_WORDS, SCRATCH_Q, SCRATCH_STATE, STEP
from sim.kernels.residual import apply, reach_of
from sim.memory import call_law, floats, kernel

# Of what a joint bears: it is outside its yield surface by more.
_MORE = 1e-9


@kernel
def bear_no_more(t, measured):  # type: ignore[no-untyped-def]
    """Bring impulses of joints that are outside their yield surfaces back to them.

    What the law gives is not: where residuals are ``measured``, joints with hardly any are inside.
    """
    joint_bodies, gradient, velocity = views.joint_bodies(t), views.gradient(t), views.per_body(t, at.VELOCITY)
    active, laws, stiffness, scale = views.active(t), views.laws(t), views.stiffness(t), views.scale(t)
    impulse, damping, deformation = views.per_joint(t, at.IMPULSE), views.damping(t), views.per_joint(t, at.DEFORMATION)
    less, h, reach, any_outside = views.per_joint(t, at.RESIDUAL), views.settings(t)[STEP], reach_of(t), False
    lightness = views.per_joint(t, at.LIGHTNESS)
    q, trial, scratch = t[at.SCRATCH] + 8 * SCRATCH_Q, t[at.SCRATCH] + 8 * SCRATCH_STATE, t[at.SCRATCH]
    place, force, flow = floats(q, 3), floats(scratch, RESPONSE_WORDS), floats(scratch, COMMIT_WORDS)
    for k in range(t[at.JOINTS]):
        error, size = 0.0, 0.0
        for i in range(3):
            error += lightness[k, i] * less[k, i] * less[k, i]
            size += lightness[k, i] * impulse[k, i] * impulse[k, i]
            less[k, i] = 0.0
        if active[k] == 0 or scale[k] <= 0.0 or (measured and error <= _MORE * _MORE * size):
            continue
        x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        place[0], place[1] = deformation[k, 0] + reach * x, deformation[k, 1] + reach * y
        place[2] = deformation[k, 2] + reach * z
        copy(laws[k, 3], trial, laws[k, 4])
        call_law(laws[k, 1], laws[k, 2], trial, q, scratch)
        call_law(laws[k, 0], laws[k, 2], trial, q, scratch)
        n = -(impulse[k, 0] / h + damping[k, 0] * x) / scale[k]
        v = -(impulse[k, 1] / h + damping[k, 1] * y) / scale[k]
        m = -(impulse[k, 2] / h + damping[k, 2] * z) / scale[k]
        x, y, z = against(stiffness[k], n - force[0], v - force[1], m - force[2])
        place[0], place[1], place[2] = place[0] + x, place[1] + y, place[2] + z
        call_law(laws[k, 1], laws[k, 2], trial, q, scratch)
        if flow[FLOW] != 0.0 or flow[FLOW + 1] != 0.0 or flow[FLOW + 2] != 0.0:
            call_law(laws[k, 0], laws[k, 2], trial, q, scratch)
            x, y, z = n - force[0], v - force[1], m - force[2]
            if abs(x) > _MORE * abs(n) or abs(y) > _MORE * abs(v) or abs(z) > _MORE * abs(m):
                any_outside = True
                less[k, 0], less[k, 1], less[k, 2] = h * scale[k] * x, h * scale[k] * y, h * scale[k] * z
    if any_outside:
        apply(t, less, 1.0, 1.0)


@kernel
def against(stiffness, x, y, z):  # type: ignore[no-untyped-def]
    """What a force x, y, z deforms a joint by whose stiffness has this upper triangle; nothing where it has none."""
    k00, k01, k02, k11, k12, k22 = stiffness[0], stiffness[1], stiffness[2], stiffness[3], stiffness[4], stiffness[5]
    l01, l02, l12 = 0.0, 0.0, 0.0
    if k00 > 0.0:
        l01, l02 = k01 / k00, k02 / k00
    k11, k12, k22 = k11 - l01 * k01, k12 - l01 * k02, k22 - l02 * k02
    y, z = y - l01 * x, z - l02 * x
    if k11 > 0.0:
        l12 = k12 / k11
    k22, z = k22 - l12 * k12, z - l12 * y
    z = z / k22 if k22 > 0.0 else 0.0
    y = (y / k11 if k11 > 0.0 else 0.0) - l12 * z
    x = (x / k00 if k00 > 0.0 else 0.0) - l01 * y - l02 * z
    return x, y, z
