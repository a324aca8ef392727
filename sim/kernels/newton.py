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

from sim.chipmunk import BODY_WORDS, MASS, MASS_INVERSE, MOMENT, MOMENT_INVERSE
from sim.kernels.blocks import assemble, factorise, substitute
from sim.kernels.kinematics import rates
from sim.kernels.layout import BETA, DELTA, STEP, TANGENT
from sim.kernels.spread import (
    add_spread,
    advance_spread,
    along,
    lightness_of,
    spread_correction,
    spread_residual,
)
from sim.memory import call_law, floats

MOST_NEWTON_STEPS = 100
MOST_SEARCHES = 40
_KINK = 1e-3


@njit(error_model="numpy")
def respond(  # type: ignore[no-untyped-def]
    n,
    joint_bodies,
    laws,
    stiffness,
    damping,
    scale,
    settings,
    jacobian,
    deformation,
    lightness,
    impulse,
    velocity,
    response,
    residual,
    predicting,
):
    """Residual r of every joint at the present velocities; returns its energy, and that of the impulses.

    While ``predicting``, every law is replaced by its elastic line through the deformation qₙ at the step's start.
    """
    h = settings[STEP]
    reach = h * (settings[BETA] + settings[DELTA])
    error, size = 0.0, 0.0
    q = np.empty(3)
    for k in range(n):
        x, y, z = rates(jacobian, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        if predicting:
            call_law(laws[k, 0], laws[k, 2], laws[k, 3], deformation[k].ctypes.data, response[k].ctypes.data)
            response[k, 0] += reach * (stiffness[k, 0] * x + stiffness[k, 1] * y + stiffness[k, 2] * z)
            response[k, 1] += reach * (stiffness[k, 1] * x + stiffness[k, 3] * y + stiffness[k, 4] * z)
            response[k, 2] += reach * (stiffness[k, 2] * x + stiffness[k, 4] * y + stiffness[k, 5] * z)
            for i in range(6):
                response[k, TANGENT + i] = stiffness[k, i]
        else:
            q[0], q[1], q[2] = (
                deformation[k, 0] + reach * x,
                deformation[k, 1] + reach * y,
                deformation[k, 2] + reach * z,
            )
            call_law(laws[k, 0], laws[k, 2], laws[k, 3], q.ctypes.data, response[k].ctypes.data)
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
def motion_scale(moving, body_at, velocity):  # type: ignore[no-untyped-def]
    """Σ m v² + I ω² of the dynamic bodies."""
    total = 0.0
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        x, y, w = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        total += b[MASS] * (x * x + y * y) + b[MOMENT] * w * w
    return total


@njit(error_model="numpy")
def gather(n, moving, joint_bodies, jacobian, per_joint, per_body):  # type: ignore[no-untyped-def]
    """Jᵀ times a vector of joint impulses."""
    for i in range(moving):
        per_body[i, 0], per_body[i, 1], per_body[i, 2] = 0.0, 0.0, 0.0
    for k in range(n):
        r0, r1, r2 = per_joint[k, 0], per_joint[k, 1], per_joint[k, 2]
        px, py = jacobian[k, 3] * r0 + jacobian[k, 9] * r1, jacobian[k, 4] * r0 + jacobian[k, 10] * r1
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        if ia < moving:
            per_body[ia, 0] -= px
            per_body[ia, 1] -= py
            per_body[ia, 2] += jacobian[k, 2] * r0 + jacobian[k, 8] * r1 + jacobian[k, 14] * r2
        if ib < moving:
            per_body[ib, 0] += px
            per_body[ib, 1] += py
            per_body[ib, 2] += jacobian[k, 5] * r0 + jacobian[k, 11] * r1 + jacobian[k, 17] * r2


@njit(error_model="numpy")
def linearise(  # type: ignore[no-untyped-def]
    n, moving, joint_bodies, factor, jacobian, residual, response, solution, slope
):
    """Δλ = r - factor D J ΔV; returns r · J ΔV, how fast the incremental energy falls along ΔV."""
    fall = 0.0
    for k in range(n):
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        x, y, z = rates(jacobian, k, solution, ia, solution, ib)
        fall += residual[k, 0] * x + residual[k, 1] * y + residual[k, 2] * z
        x, y, z = factor * x, factor * y, factor * z
        t = TANGENT
        slope[k, 0] = residual[k, 0] - (response[k, t] * x + response[k, t + 1] * y + response[k, t + 2] * z)
        slope[k, 1] = residual[k, 1] - (response[k, t + 1] * x + response[k, t + 3] * y + response[k, t + 4] * z)
        slope[k, 2] = residual[k, 2] - (response[k, t + 2] * x + response[k, t + 4] * y + response[k, t + 5] * z)
    return fall


@njit(error_model="numpy")
def descent(n, moving, joint_bodies, jacobian, residual, direction):  # type: ignore[no-untyped-def]
    """r · J ΔV at the present residual."""
    total = 0.0
    for k in range(n):
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        x, y, z = rates(jacobian, k, direction, ia, direction, ib)
        total += residual[k, 0] * x + residual[k, 1] * y + residual[k, 2] * z
    return total


@njit(error_model="numpy")
def advance(n, moving, share, joint_bodies, body_at, jacobian, slope, impulse, velocity):  # type: ignore[no-untyped-def]
    """λ += share Δλ and V += share M⁻¹ Jᵀ Δλ."""
    for k in range(n):
        x, y, z = share * slope[k, 0], share * slope[k, 1], share * slope[k, 2]
        impulse[k, 0] += x
        impulse[k, 1] += y
        impulse[k, 2] += z
        px, py = jacobian[k, 3] * x + jacobian[k, 9] * y, jacobian[k, 4] * x + jacobian[k, 10] * y
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        if ia < moving:
            b = floats(body_at[ia], BODY_WORDS)
            velocity[ia, 0] -= px * b[MASS_INVERSE]
            velocity[ia, 1] -= py * b[MASS_INVERSE]
            velocity[ia, 2] += (jacobian[k, 2] * x + jacobian[k, 8] * y + jacobian[k, 14] * z) * b[MOMENT_INVERSE]
        if ib < moving:
            b = floats(body_at[ib], BODY_WORDS)
            velocity[ib, 0] += px * b[MASS_INVERSE]
            velocity[ib, 1] += py * b[MASS_INVERSE]
            velocity[ib, 2] += (jacobian[k, 5] * x + jacobian[k, 11] * y + jacobian[k, 17] * z) * b[MOMENT_INVERSE]


@njit(error_model="numpy")
def iterate(  # type: ignore[no-untyped-def]
    n,
    moving,
    joint_bodies,
    body_at,
    laws,
    stiffness,
    damping,
    scale,
    settings,
    joint_slot,
    column_start,
    column_rows,
    targets,
    jacobian,
    deformation,
    lightness,
    impulse,
    velocity,
    response,
    residual,
    slope,
    solution,
    diagonal,
    lower,
    scaled,
    spread,
    pattern,
    image,
    tolerance,
    predicting,
):
    """Newton's method from the present velocities; returns steps taken, whether it converged, and the residual.

    The first solve of a step is ``predicting``: it takes every joint as elastic. At the velocities without joints all
    of them may seem to yield, and from there the way to the solution is long.
    """
    factor = settings[STEP] ** 2 * (settings[BETA] + settings[DELTA])
    error, size = respond(
        n,
        joint_bodies,
        laws,
        stiffness,
        damping,
        scale,
        settings,
        jacobian,
        deformation,
        lightness,
        impulse,
        velocity,
        response,
        residual,
        predicting,
    )
    spring, spring_light, spring_slope = 0.0, 0.0, 0.0
    if spread:
        spring = spread_residual(moving, settings, pattern, velocity)
        spring_light = lightness_of(moving, body_at, pattern)
        error += spring_light * spring * spring
    motion = motion_scale(moving, body_at, velocity)
    converged = not predicting and error <= tolerance * (size + motion)
    best, steps = error, 0
    while not converged and steps < MOST_NEWTON_STEPS:
        steps += 1
        assemble(n, moving, joint_bodies, body_at, joint_slot, factor, response, jacobian, diagonal, lower)
        factorise(moving, column_start, column_rows, targets, diagonal, lower, scaled)
        gather(n, moving, joint_bodies, jacobian, residual, solution)
        if spread:
            add_spread(moving, pattern, spring, solution)
        substitute(moving, 0, column_start, column_rows, diagonal, scaled, solution)
        start = 0.0
        if spread:
            rate, c = spread_correction(
                moving, settings, pattern, column_start, column_rows, diagonal, scaled, solution, image
            )
            spring_slope = spring - c * rate
            start = spring * rate
        start += linearise(n, moving, joint_bodies, factor, jacobian, residual, response, solution, slope)
        share, low, high, fall_low, fall_high = 1.0, 0.0, 1.0, start, 0.0
        step_length, last = 1.0, False
        for search in range(MOST_SEARCHES):
            advance(n, moving, step_length, joint_bodies, body_at, jacobian, slope, impulse, velocity)
            if spread:
                advance_spread(moving, step_length * spring_slope, body_at, pattern, settings, velocity)
            error, size = respond(
                n,
                joint_bodies,
                laws,
                stiffness,
                damping,
                scale,
                settings,
                jacobian,
                deformation,
                lightness,
                impulse,
                velocity,
                response,
                residual,
                False,
            )
            if spread:
                spring = spread_residual(moving, settings, pattern, velocity)
                error += spring_light * spring * spring
            converged = error <= tolerance * (size + motion)
            if converged or predicting or last:
                break
            # Along the step the energy is convex: where it rises too steeply, its least value lies further back.
            fall = descent(n, moving, joint_bodies, jacobian, residual, solution)
            if spread:
                fall += spring * along(moving, pattern, solution)
            if search == 0:
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
            elif search % 3 == 2:
                new = 0.5 * (low + high)
            else:
                new = low + (high - low) * fall_low / (fall_low - fall_high)
                new = min(max(new, low + 0.02 * (high - low)), high - 0.02 * (high - low))
            step_length = new - share
            share = new
        predicting = False
        # Below this it is rounding that remains, and another step would not take it away.
        if steps > 3 and error >= 0.25 * best and error <= 1e6 * tolerance * (size + motion):
            converged = True
        best = min(best, error)
    total = size + motion
    return steps, converged, math.sqrt(error / total) if total > 0.0 else 0.0
