"""What all joints of a structure do at given velocities, and what their impulses do to the bodies.

See `newton` for the equations.
"""

import numpy as np
from numba import njit

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.kinematics import rates
from sim.kernels.layout import (
    INERTIA_I,
    INERTIA_M,
    INVERSE_I,
    INVERSE_M,
    RESPONSE_WORDS,
    RESULT_WORDS,
    STEP,
    TANGENT,
)
from sim.memory import call_law

#: How `respond` takes a joint: by its law, or by a line with its stiffness or its last tangent.
LAWS, STIFFNESS, TANGENTS = 0, 1, 2


@njit(error_model="numpy")
def reach_of(t):  # type: ignore[no-untyped-def]
    """How far q* follows the new velocities: (β + δ) h [s]."""
    settings = views.settings(t)
    return settings[STEP] * (settings[at.BETA] + settings[at.DELTA])


@njit(error_model="numpy")
def respond(t, by):  # type: ignore[no-untyped-def]
    """Residual r of every joint at the present velocities; returns its energy, and that of the impulses.

    To predict, every law is replaced by a line through where the last step ended, with the stiffness of the joint or
    with its tangent there. At that point a law does not flow; at the step's start it may seem to, where bodies moved
    straight while they turned.
    """
    joint_bodies, laws, scale = views.joint_bodies(t), views.laws(t), views.scale(t)
    stiffness, damping, jacobian = views.stiffness(t), views.damping(t), views.jacobian(t)
    deformation, lightness = views.per_joint(t, at.DEFORMATION), views.per_joint(t, at.LIGHTNESS)
    impulse, residual = views.per_joint(t, at.IMPULSE), views.per_joint(t, at.RESIDUAL)
    velocity, response, result = views.per_body(t, at.VELOCITY), views.response(t), views.result(t)
    h, reach = views.settings(t)[STEP], reach_of(t)
    old_reach, line = reach / views.settings(t)[at.STEP_RATIO], np.empty(6 if by != LAWS else 0)
    error, size = 0.0, 0.0
    for k in range(t[at.JOINTS]):
        x, y, z = rates(jacobian, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        u, v, turn = deformation[k, 0] + reach * x, deformation[k, 1] + reach * y, deformation[k, 2] + reach * z
        out = t[at.RESPONSE] + 8 * RESPONSE_WORDS * k
        if by != LAWS:
            if by == STIFFNESS:
                for i in range(6):
                    line[i] = stiffness[k, i]
            else:
                for i in range(6):
                    line[i] = response[k, TANGENT + i]
                line[0] -= damping[k, 0] / old_reach
                line[3] -= damping[k, 1] / old_reach
                line[5] -= damping[k, 2] / old_reach
            call_law(laws[k, 0], laws[k, 2], laws[k, 3], t[at.RESULT] + 8 * RESULT_WORDS * k, out)
            u, v, turn = u - result[k, 0], v - result[k, 1], turn - result[k, 2]
            response[k, 0] += line[0] * u + line[1] * v + line[2] * turn
            response[k, 1] += line[1] * u + line[3] * v + line[4] * turn
            response[k, 2] += line[2] * u + line[4] * v + line[5] * turn
            for i in range(6):
                response[k, TANGENT + i] = line[i]
        else:
            # The joint's row of residuals holds q* until they are known.
            residual[k, 0], residual[k, 1], residual[k, 2] = u, v, turn
            call_law(laws[k, 0], laws[k, 2], laws[k, 3], t[at.RESIDUAL] + 24 * k, out)
            if scale[k] != 1.0:
                for i in range(9):
                    response[k, i] *= scale[k]
        response[k, 0] += damping[k, 0] * x
        response[k, 1] += damping[k, 1] * y
        response[k, 2] += damping[k, 2] * z
        response[k, 3] += damping[k, 0] / reach
        response[k, 6] += damping[k, 1] / reach
        response[k, 8] += damping[k, 2] / reach
        for i in range(3):
            residual[k, i] = -h * response[k, i] - impulse[k, i]
            error += lightness[k, i] * residual[k, i] * residual[k, i]
            size += lightness[k, i] * impulse[k, i] * impulse[k, i]
    return error, size


@njit(error_model="numpy")
def motion_scale(t):  # type: ignore[no-untyped-def]
    """Σ m v² + I ω² of the dynamic bodies."""
    weight, velocity = views.weight(t), views.per_body(t, at.VELOCITY)
    total = 0.0
    for i in range(t[at.MOVING]):
        x, y, w = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        total += weight[i, INERTIA_M] * (x * x + y * y) + weight[i, INERTIA_I] * w * w
    return total


@njit(error_model="numpy")
def gather(t, per_joint, out):  # type: ignore[no-untyped-def]
    """Jᵀ times a vector of joint impulses."""
    joint_bodies, jacobian, moving = views.joint_bodies(t), views.jacobian(t), t[at.MOVING]
    for i in range(moving):
        out[i, 0], out[i, 1], out[i, 2] = 0.0, 0.0, 0.0
    for k in range(t[at.JOINTS]):
        r0, r1, r2 = per_joint[k, 0], per_joint[k, 1], per_joint[k, 2]
        px, py = jacobian[k, 3] * r0 + jacobian[k, 9] * r1, jacobian[k, 4] * r0 + jacobian[k, 10] * r1
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        if ia < moving:
            out[ia, 0] -= px
            out[ia, 1] -= py
            out[ia, 2] += jacobian[k, 2] * r0 + jacobian[k, 8] * r1 + jacobian[k, 14] * r2
        if ib < moving:
            out[ib, 0] += px
            out[ib, 1] += py
            out[ib, 2] += jacobian[k, 5] * r0 + jacobian[k, 11] * r1 + jacobian[k, 17] * r2


@njit(error_model="numpy")
def linearise(t, factor, with_residual):  # type: ignore[no-untyped-def]
    """Δλ = r - factor D J ΔV, r only ``with_residual`` (1 or 0); returns r · J ΔV, how fast the energy falls."""
    joint_bodies, jacobian, response = views.joint_bodies(t), views.jacobian(t), views.response(t)
    residual, solution = views.per_joint(t, at.RESIDUAL), views.per_body(t, at.SOLUTION)
    slope, d = views.per_joint(t, at.SLOPE), TANGENT
    fall = 0.0
    for k in range(t[at.JOINTS]):
        r0, r1, r2 = with_residual * residual[k, 0], with_residual * residual[k, 1], with_residual * residual[k, 2]
        x, y, z = rates(jacobian, k, solution, joint_bodies[k, 0], solution, joint_bodies[k, 1])
        fall += r0 * x + r1 * y + r2 * z
        x, y, z = factor * x, factor * y, factor * z
        slope[k, 0] = r0 - (response[k, d] * x + response[k, d + 1] * y + response[k, d + 2] * z)
        slope[k, 1] = r1 - (response[k, d + 1] * x + response[k, d + 3] * y + response[k, d + 4] * z)
        slope[k, 2] = r2 - (response[k, d + 2] * x + response[k, d + 4] * y + response[k, d + 5] * z)
    return fall


@njit(error_model="numpy")
def descent(t):  # type: ignore[no-untyped-def]
    """r · J ΔV at the present residual."""
    joint_bodies, jacobian = views.joint_bodies(t), views.jacobian(t)
    residual, direction = views.per_joint(t, at.RESIDUAL), views.per_body(t, at.SOLUTION)
    total = 0.0
    for k in range(t[at.JOINTS]):
        x, y, z = rates(jacobian, k, direction, joint_bodies[k, 0], direction, joint_bodies[k, 1])
        total += residual[k, 0] * x + residual[k, 1] * y + residual[k, 2] * z
    return total


@njit(error_model="numpy")
def advance(t, share):  # type: ignore[no-untyped-def]
    """λ += share Δλ and V += share M⁻¹ Jᵀ Δλ."""
    joint_bodies, jacobian, weight = views.joint_bodies(t), views.jacobian(t), views.weight(t)
    slope, impulse = views.per_joint(t, at.SLOPE), views.per_joint(t, at.IMPULSE)
    velocity, moving = views.per_body(t, at.VELOCITY), t[at.MOVING]
    for k in range(t[at.JOINTS]):
        x, y, z = share * slope[k, 0], share * slope[k, 1], share * slope[k, 2]
        impulse[k, 0] += x
        impulse[k, 1] += y
        impulse[k, 2] += z
        px, py = jacobian[k, 3] * x + jacobian[k, 9] * y, jacobian[k, 4] * x + jacobian[k, 10] * y
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        if ia < moving:
            light, nimble = weight[ia, INVERSE_M], weight[ia, INVERSE_I]
            velocity[ia, 0] -= px * light
            velocity[ia, 1] -= py * light
            velocity[ia, 2] += (jacobian[k, 2] * x + jacobian[k, 8] * y + jacobian[k, 14] * z) * nimble
        if ib < moving:
            light, nimble = weight[ib, INVERSE_M], weight[ib, INVERSE_I]
            velocity[ib, 0] += px * light
            velocity[ib, 1] += py * light
            velocity[ib, 2] += (jacobian[k, 5] * x + jacobian[k, 11] * y + jacobian[k, 17] * z) * nimble
