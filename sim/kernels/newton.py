"""The impulses of all joints of a structure: Newton's method with a line search.

With body velocities V, masses M, joint deformations q = (u, v, θ), J = ∂q̇/∂V, step h and a law's force s(q) with
tangent D = ∂s/∂q, the joint impulses λ solve

    λ = -h s(q*),   q* = qₙ + h J [(β + δ) V - β Vₙ],   M (V - V̂) = Jᵀ λ,

where V̂ are the velocities without the joints. That is where a convex function of V is least (elastic energy, plastic
dissipation, and kinetic distance to V̂), so Newton's method with a line search finds it:

    (M + (β + δ) h² Jᵀ D J) ΔV = Jᵀ r,   r = -h s(q*) - λ,
    Δλ = r - (β + δ) h² D J ΔV,          V += M⁻¹ Jᵀ Δλ.

Bodies are only ever changed by pairs of impulses ± Jᵀ Δλ, so momentum is kept to rounding, converged or not.
β = 0, δ = 1 is implicit Euler; β = ¼, δ = 0 the average-acceleration rule. Viscous forces c q̇ at the step's end are
part of s, with c / h(β + δ) in D.
"""

import math

import numpy as np
from numba import njit

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import factorise_matrix, solve
from sim.kernels.kinematics import rates
from sim.kernels.layout import INERTIA_I, INERTIA_M, INVERSE_I, INVERSE_M, RESPONSE_WORDS, RESULT_WORDS, STEP, TANGENT
from sim.kernels.spread import advance_spread, along, spread_residual, spread_step
from sim.memory import call_law

MOST_NEWTON_STEPS = 200
#: After so many steps, start again from the elastic prediction.
_PATIENCE = 15
#: How `respond` takes a joint: by its law, or by a line with its stiffness or its last tangent.
LAWS, STIFFNESS, TANGENTS = 0, 1, 2
MOST_SEARCHES = 40
_KINK = 1e-3
_MOST_REFINEMENTS = 5


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


@njit(error_model="numpy")
def restart(t):  # type: ignore[no-untyped-def]
    """Apply the last step's impulses, which a step starts from, to velocities without joints.

    From those, forces would be differences of numbers a million times their size.
    """
    slope, impulse = views.per_joint(t, at.SLOPE), views.per_joint(t, at.IMPULSE)
    for k in range(t[at.JOINTS]):
        for i in range(3):
            slope[k, i], impulse[k, i] = impulse[k, i], 0.0
    advance(t, 1.0)
    if t[at.SPREAD] == 1:
        settings = views.settings(t)
        amount, settings[at.SPREAD_IMPULSE] = settings[at.SPREAD_IMPULSE], 0.0
        advance_spread(t, amount)


@njit(error_model="numpy")
def measure(t, by):  # type: ignore[no-untyped-def]
    """Residuals of the joints and of the load pattern's spring; returns their energy, that of all, and the spring's."""
    error, size = respond(t, by)
    spring = 0.0
    if t[at.SPREAD] == 1:
        spring, light = spread_residual(t)
        error += light * spring * spring
    return error, size, spring


@njit(error_model="numpy")
def newton_direction(t, factor, spring):  # type: ignore[no-untyped-def]
    """ΔV and Δλ with the factor at hand; returns how fast the energy falls along ΔV, and the spring's ΔΛ."""
    solution, change, fall = views.per_body(t, at.SOLUTION), 0.0, 0.0
    gather(t, views.per_joint(t, at.RESIDUAL), solution)
    solve(t, 0, solution)
    if t[at.SPREAD] == 1:
        change = spread_step(t, spring)
        fall = spring * along(t, views.per_body(t, at.PATTERN), solution)
    return fall + linearise(t, factor, 1.0), change


@njit(error_model="numpy")
def go(t, length, spring_change):  # type: ignore[no-untyped-def]
    """Go ``length`` of the direction found; returns what `measure` does there, for the laws as they are."""
    advance(t, length)
    if t[at.SPREAD] == 1:
        advance_spread(t, length * spring_change)
    return measure(t, LAWS)


@njit(error_model="numpy")
def predict(t, factor, enough):  # type: ignore[no-untyped-def]
    """The first solve of a step: goes on with the tangents of a last step that flowed, or takes all joints as elastic.

    At the velocities without joints all of them may seem to yield, and from there the way to the solution is long.
    Returns what `measure` does then.
    """
    if t[at.FLOWING] == 0:
        return predict_elastic(t, factor, enough)
    _, _, spring = measure(t, TANGENTS)
    factorise_matrix(t, factor)
    _, change = newton_direction(t, factor, spring)
    return go(t, 1.0, change)


@njit(error_model="numpy")
def predict_elastic(t, factor, enough):  # type: ignore[no-untyped-def]
    """Take every joint as elastic; refined where joints are so stiff that they seem to yield by rounding alone."""
    before, size, spring = measure(t, STIFFNESS)
    factorise_matrix(t, factor)
    error = before
    for _ in range(_MOST_REFINEMENTS):
        _, change = newton_direction(t, factor, spring)
        error, size, spring = go(t, 1.0, change)
        if error <= enough * (size + motion_scale(t)):
            break
        rest, _, spring = measure(t, STIFFNESS)
        if rest > 0.1 * before or rest <= enough * size:
            error, size, spring = measure(t, LAWS)
            break
        before = rest
    return error, size, spring


@njit(error_model="numpy")
def iterate(t, predicting):  # type: ignore[no-untyped-def]
    """Newton's method from the present velocities; returns steps taken, whether it converged, and the residual.

    The first solve of a step is ``predicting``.
    """
    settings = views.settings(t)
    factor, tolerance, rounding = settings[STEP] * reach_of(t), settings[at.TOLERANCE], settings[at.ROUNDING]
    steps = 0
    if predicting:
        error, size, spring = predict(t, factor, tolerance)
        steps = 1
    else:
        error, size, spring = measure(t, LAWS)
    motion = motion_scale(t)
    converged = error <= tolerance * (size + motion) + rounding
    best = error
    while not converged and steps < MOST_NEWTON_STEPS:
        steps += 1
        if steps == _PATIENCE:
            error, size, spring = predict_elastic(t, factor, tolerance)
        else:
            factorise_matrix(t, factor)
            start, change = newton_direction(t, factor, spring)
            error, size, spring = search(t, start, change, tolerance, motion)
        converged = error <= tolerance * (size + motion) + rounding
        # Below this it is rounding that remains, and another step would not take it away.
        if steps > 3 and error >= 0.25 * best and error <= 1e6 * tolerance * (size + motion):
            converged = True
        best = min(best, error)
    total = size + motion
    return steps, converged, math.sqrt(error / total) if total > 0.0 else 0.0


@njit(error_model="numpy")
def search(t, start, change, tolerance, motion):  # type: ignore[no-untyped-def]
    """Line search: how far to go along the direction found; returns what `measure` does there.

    Along it the energy is convex, and falls with ``start`` at first: where it rises too steeply in the end, its least
    value lies further back.
    """
    solution, pattern = views.per_body(t, at.SOLUTION), views.per_body(t, at.PATTERN)
    share, low, high, fall_low, fall_high = 1.0, 0.0, 1.0, start, 0.0
    step_length, last = 1.0, False
    error, size, spring = 0.0, 0.0, 0.0
    for attempt in range(MOST_SEARCHES):
        error, size, spring = go(t, step_length, change)
        if last or error <= tolerance * (size + motion):
            break
        fall = descent(t)
        if t[at.SPREAD] == 1:
            fall += spring * along(t, pattern, solution)
        if attempt == 0:
            if fall >= -0.5 * start:
                break
            fall_high = fall
        elif abs(fall) <= 0.3 * start:
            break
        elif fall > 0.0:
            low, fall_low = share, fall
        else:
            high, fall_high = share, fall
        if high - low <= _KINK * high:
            # The slope jumps here, where a joint stops yielding. Beyond the jump its tangent is the stiff one, and
            # the next step can follow it; before it the same step would be tried again.
            if fall <= 0.0:
                break
            new, last = high, True
        elif attempt % 3 == 2:
            new = 0.5 * (low + high)
        else:
            new = low + (high - low) * fall_low / (fall_low - fall_high)
            new = min(max(new, low + 0.02 * (high - low)), high - 0.02 * (high - low))
        step_length = new - share
        share = new
    return error, size, spring
