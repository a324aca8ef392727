"""What all joints of a structure do at given velocities, and what their impulses do to the bodies.

See `newton` for the equations.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.kinematics import impulses, rates
from sim.kernels.layout import (
    INERTIA_I,
    INERTIA_M,
    INVERSE_I,
    INVERSE_M,
    RESPONSE_WORDS,
    RESULT_WORDS,
    STEP,
    TANGENT,
    TANGENT_REACH,
)
from sim.memory import call_law, floats, inlined, kernel


@inlined
def reach_of(t):  # type: ignore[no-untyped-def]
    """How far q* follows the new velocities: (β + δ) h [s].

    h is for how long they are to move the bodies in implicit Euler, the step in the average-acceleration rule.
    """
    settings = views.settings(t)
    return settings[at.NEXT_MOVE if settings[at.BETA] == 0.0 else STEP] * (settings[at.BETA] + settings[at.DELTA])


@inlined
def respond(t):  # type: ignore[no-untyped-def]
    """Residual r of every joint at the present velocities, by its law; returns its energy, and that of the impulses.

    Joints that are `SOFT` deform by that share of the way from the places in their rows of results, see `approach`.
    """
    joint_bodies, laws, scale = views.joint_bodies(t), views.laws(t), views.scale(t)
    gradient, deformation = views.gradient(t), views.per_joint(t, at.DEFORMATION)
    residual, velocity, response = views.per_joint(t, at.RESIDUAL), views.per_body(t, at.VELOCITY), views.response(t)
    reach, error, size, breakable = reach_of(t), 0.0, 0.0, t[at.BREAKABLE] == 1
    settings, result = views.settings(t), views.result(t)
    soft, settings[TANGENT_REACH] = settings[at.SOFT], reach
    for k in range(t[at.JOINTS]):
        x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        # The joint's row of residuals holds q* until they are known.
        residual[k, 0], residual[k, 1] = deformation[k, 0] + reach * x, deformation[k, 1] + reach * y
        residual[k, 2] = deformation[k, 2] + reach * z
        if soft != 1.0:
            for i in range(3):
                residual[k, i] = result[k, i] + soft * (residual[k, i] - result[k, i])
        call_law(laws[k, 0], laws[k, 2], laws[k, 3], t[at.RESIDUAL] + 24 * k, t[at.RESPONSE] + 8 * RESPONSE_WORDS * k)
        if soft != 1.0:
            for i in range(TANGENT, RESPONSE_WORDS):
                response[k, i] *= soft
        if breakable and scale[k] != 1.0:
            for i in range(RESPONSE_WORDS):
                response[k, i] *= scale[k]
        of_residual, of_impulse = remain(t, k, reach, x, y, z)
        error, size = error + of_residual, size + of_impulse
    return error, size


@inlined
def respond_along_lines(t, tangents, first):  # type: ignore[no-untyped-def]
    """As `respond`, but every law is a line through where the last step ended, with a tangent from column ``first`` on.

    At that point a law does not flow; at the step's start it may seem to, where bodies moved straight while they
    turned.
    """
    joint_bodies, laws, result = views.joint_bodies(t), views.laws(t), views.result(t)
    gradient, deformation = views.gradient(t), views.per_joint(t, at.DEFORMATION)
    velocity, response = views.per_body(t, at.VELOCITY), views.response(t)
    reach, error, size, there = reach_of(t), 0.0, 0.0, floats(t[at.SCRATCH], RESPONSE_WORDS)
    views.settings(t)[TANGENT_REACH] = reach
    for k in range(t[at.JOINTS]):
        x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        d00, d01, d02 = tangents[k, first], tangents[k, first + 1], tangents[k, first + 2]
        d11, d12, d22 = tangents[k, first + 3], tangents[k, first + 4], tangents[k, first + 5]
        call_law(laws[k, 0], laws[k, 2], laws[k, 3], t[at.RESULT] + 8 * RESULT_WORDS * k, t[at.SCRATCH])
        u, v = deformation[k, 0] + reach * x - result[k, 0], deformation[k, 1] + reach * y - result[k, 1]
        turn = deformation[k, 2] + reach * z - result[k, 2]
        response[k, 0] = there[0] + (d00 * u + d01 * v + d02 * turn)
        response[k, 1] = there[1] + (d01 * u + d11 * v + d12 * turn)
        response[k, 2] = there[2] + (d02 * u + d12 * v + d22 * turn)
        response[k, TANGENT], response[k, TANGENT + 1], response[k, TANGENT + 2] = d00, d01, d02
        response[k, TANGENT + 3], response[k, TANGENT + 4], response[k, TANGENT + 5] = d11, d12, d22
        of_residual, of_impulse = remain(t, k, reach, x, y, z)
        error, size = error + of_residual, size + of_impulse
    return error, size


@kernel
def strip_tangents(t):  # type: ignore[no-untyped-def]
    """Take the viscous part out of the tangents that the last step ended with."""
    response, damping, old_reach = views.response(t), views.damping(t), views.settings(t)[TANGENT_REACH]
    for k in range(t[at.JOINTS]):
        # A joint that is new has none.
        response[k, TANGENT] = max(response[k, TANGENT] - damping[k, 0] / old_reach, 0.0)
        response[k, TANGENT + 3] = max(response[k, TANGENT + 3] - damping[k, 1] / old_reach, 0.0)
        response[k, TANGENT + 5] = max(response[k, TANGENT + 5] - damping[k, 2] / old_reach, 0.0)


@inlined
def remain(t, k, reach, x, y, z):  # type: ignore[no-untyped-def]
    """Add joint k's viscous forces to its response, and find its residual; returns its energy, and the impulse's."""
    damping, response, lightness = views.damping(t), views.response(t), views.per_joint(t, at.LIGHTNESS)
    impulse, residual, h = views.per_joint(t, at.IMPULSE), views.per_joint(t, at.RESIDUAL), views.settings(t)[STEP]
    if t[at.DAMPED] == 1:
        response[k, 0] += damping[k, 0] * x
        response[k, 1] += damping[k, 1] * y
        response[k, 2] += damping[k, 2] * z
        response[k, TANGENT] += damping[k, 0] / reach
        response[k, TANGENT + 3] += damping[k, 1] / reach
        response[k, TANGENT + 5] += damping[k, 2] / reach
    error, size = 0.0, 0.0
    for i in range(3):
        residual[k, i] = -h * response[k, i] - impulse[k, i]
        error += lightness[k, i] * residual[k, i] * residual[k, i]
        size += lightness[k, i] * impulse[k, i] * impulse[k, i]
    return error, size


@inlined
def motion_scale(t):  # type: ignore[no-untyped-def]
    """Σ m v² + I ω² of the dynamic bodies."""
    weight, velocity = views.weight(t), views.per_body(t, at.VELOCITY)
    total = 0.0
    for i in range(t[at.MOVING]):
        x, y, w = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        total += weight[i, INERTIA_M] * (x * x + y * y) + weight[i, INERTIA_I] * w * w
    return total


@inlined
def gather(t, per_joint, out):  # type: ignore[no-untyped-def]
    """Jᵀ times a vector of joint impulses."""
    joint_bodies, gradient, moving = views.joint_bodies(t), views.gradient(t), t[at.MOVING]
    for i in range(moving):
        out[i, 0], out[i, 1], out[i, 2] = 0.0, 0.0, 0.0
    for k in range(t[at.JOINTS]):
        px, py, on_a, on_b = impulses(gradient, k, per_joint[k, 0], per_joint[k, 1], per_joint[k, 2])
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        if ia < moving:
            out[ia, 0] -= px
            out[ia, 1] -= py
            out[ia, 2] += on_a
        if ib < moving:
            out[ib, 0] += px
            out[ib, 1] += py
            out[ib, 2] += on_b


@inlined
def descend(t, factor, with_residual):  # type: ignore[no-untyped-def]
    """Δλ = r - factor D J ΔV, r only ``with_residual`` (1 or 0), and all of that step: λ += Δλ, V += M⁻¹ Jᵀ Δλ.

    Returns r · J ΔV, how fast the energy falls at first.
    """
    joint_bodies, gradient, response = views.joint_bodies(t), views.gradient(t), views.response(t)
    residual, solution = views.per_joint(t, at.RESIDUAL), views.per_body(t, at.SOLUTION)
    slope, impulse, d = views.per_joint(t, at.SLOPE), views.per_joint(t, at.IMPULSE), TANGENT
    weight, velocity, moving, fall = views.weight(t), views.per_body(t, at.VELOCITY), t[at.MOVING], 0.0
    for k in range(t[at.JOINTS]):
        r0, r1, r2 = with_residual * residual[k, 0], with_residual * residual[k, 1], with_residual * residual[k, 2]
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        x, y, z = rates(gradient, k, solution, ia, solution, ib)
        fall += r0 * x + r1 * y + r2 * z
        x, y, z = factor * x, factor * y, factor * z
        p0 = r0 - (response[k, d] * x + response[k, d + 1] * y + response[k, d + 2] * z)
        p1 = r1 - (response[k, d + 1] * x + response[k, d + 3] * y + response[k, d + 4] * z)
        p2 = r2 - (response[k, d + 2] * x + response[k, d + 4] * y + response[k, d + 5] * z)
        slope[k, 0], slope[k, 1], slope[k, 2] = p0, p1, p2
        impulse[k, 0] += p0
        impulse[k, 1] += p1
        impulse[k, 2] += p2
        push(gradient, k, p0, p1, p2, ia, ib, moving, weight, velocity)
    return fall


@kernel
def descent(t, factor):  # type: ignore[no-untyped-def]
    """r · J ΔV at the present residual, and by how much it falls for the whole step at the present tangents."""
    joint_bodies, gradient, response = views.joint_bodies(t), views.gradient(t), views.response(t)
    residual, direction = views.per_joint(t, at.RESIDUAL), views.per_body(t, at.SOLUTION)
    slope, d = views.per_joint(t, at.SLOPE), TANGENT
    fall, bend = 0.0, 0.0
    for k in range(t[at.JOINTS]):
        x, y, z = rates(gradient, k, direction, joint_bodies[k, 0], direction, joint_bodies[k, 1])
        fall += residual[k, 0] * x + residual[k, 1] * y + residual[k, 2] * z
        square = response[k, d] * x * x + response[k, d + 3] * y * y + response[k, d + 5] * z * z
        mixed = response[k, d + 1] * x * y + response[k, d + 2] * x * z + response[k, d + 4] * y * z
        bend += factor * (square + 2.0 * mixed) + slope[k, 0] * x + slope[k, 1] * y + slope[k, 2] * z
    return fall, bend


@kernel
def advance(t, share):  # type: ignore[no-untyped-def]
    """λ += share Δλ and V += share M⁻¹ Jᵀ Δλ."""
    apply(t, views.per_joint(t, at.SLOPE), share, share)


@kernel
def apply(t, p, share, counted):  # type: ignore[no-untyped-def]
    """V += share M⁻¹ Jᵀ p and λ += counted p, for impulses p (joints, 3)."""
    joint_bodies, gradient, weight = views.joint_bodies(t), views.gradient(t), views.weight(t)
    impulse, velocity, moving = views.per_joint(t, at.IMPULSE), views.per_body(t, at.VELOCITY), t[at.MOVING]
    for k in range(t[at.JOINTS]):
        x, y, z = p[k, 0], p[k, 1], p[k, 2]
        impulse[k, 0] += counted * x
        impulse[k, 1] += counted * y
        impulse[k, 2] += counted * z
        x, y, z = share * x, share * y, share * z
        push(gradient, k, x, y, z, joint_bodies[k, 0], joint_bodies[k, 1], moving, weight, velocity)


@inlined
def push(gradient, k, x, y, z, ia, ib, moving, weight, velocity):  # type: ignore[no-untyped-def]
    """V += M⁻¹ Jᵀ p for an impulse p = (x, y, z) of joint k between bodies ia and ib."""
    px, py, on_a, on_b = impulses(gradient, k, x, y, z)
    if ia < moving:
        velocity[ia, 0] -= px * weight[ia, INVERSE_M]
        velocity[ia, 1] -= py * weight[ia, INVERSE_M]
        velocity[ia, 2] += on_a * weight[ia, INVERSE_I]
    if ib < moving:
        velocity[ib, 0] += px * weight[ib, INVERSE_M]
        velocity[ib, 1] += py * weight[ib, INVERSE_M]
        velocity[ib, 2] += on_b * weight[ib, INVERSE_I]
