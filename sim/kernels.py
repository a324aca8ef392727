"""The structure solver, compiled: one implicit step of a whole structure inside Chipmunk's solver.

With body velocities V, masses M, joint deformations q = (u, v, θ), J = ∂q̇/∂V, step h and a law's force s(q) with
tangent D = ∂s/∂q, the joint impulses λ solve

    λ = -h s(q*),   q* = qₙ + h J [(β + δ) V - β Vₙ],   M (V - V̂) = Jᵀ λ,

where V̂ are the velocities without the joints. That is where a convex function of V is least (elastic energy, plastic
dissipation, and kinetic distance to V̂), so Newton's method with a line search finds it:

    (M + (β + δ) h² Jᵀ D J) ΔV = Jᵀ r,   r = -h s(q*) - λ,
    Δλ = r - (β + δ) h² D J ΔV,          V += M⁻¹ Jᵀ Δλ.

Bodies are only ever changed by pairs of impulses ± Jᵀ Δλ, so momentum is kept to rounding, converged or not.
β = 0, δ = 1 is implicit Euler; β = ¼, δ = 0 the average-acceleration rule.

The matrix has a 3 × 3 block for every body and every joint. It is factored as L D Lᵀ over a pattern with fill that is
found when the structure is built (`sim.ordering`), so any graph of bodies will do.
"""

import math

import numpy as np
from numba import cfunc, njit, types

from sim.chipmunk import ANGLE, BODY_WORDS, CONTROL, MASS, MOMENT, SPIN, VX, X
from sim.memory import call_law, floats, integers, table

# Words of the control table (int64): sizes, counters, then addresses.
BODIES, MOVING, JOINTS, LOWER = 0, 1, 2, 3
STATUS, NEWTON_STEPS, SOLVES, UNCONVERGED = 4, 5, 6, 7
FRESH = 8
ADDRESSES = 9
(
    BODY_AT,
    JOINT_BODIES,
    GEOMETRY,
    LAWS,
    STIFFNESS,
    COLUMN_START,
    COLUMN_ROWS,
    FILL_TARGETS,
    JOINT_SLOT,
    SETTINGS,
    JACOBIAN,
    DEFORMATION,
    IMPULSE,
    RESIDUAL,
    SLOPE,
    RESPONSE,
    VELOCITY,
    SOLUTION,
    DIAGONAL,
    LOWER_BLOCKS,
    SCALED_BLOCKS,
    RESULT,
) = range(ADDRESSES, ADDRESSES + 22)
CONTROL_WORDS = ADDRESSES + 22

# Settings (float64).
STEP, BETA, DELTA, TOLERANCE, LAST_RESIDUAL = 0, 1, 2, 3, 4
SETTINGS_WORDS = 5

# Per joint: geometry is anchor on a, anchor on b (body coordinates), rest angle of the joint's frame on a and on b,
# share α of b's rotation in the frame; response is s (3) and D as 00 01 02 11 12 22; result is q* (3), force (3),
# elastic energy, work dissipated so far.
GEOMETRY_WORDS = 7
RESPONSE_WORDS = 9
RESULT_WORDS = 8

OK, NOT_FINITE = 0, 1

_MOST_NEWTON_STEPS = 40
_MOST_SEARCHES = 12


@njit
def prepare(n, joint_bodies, body_at, geometry, settings, jacobian, deformation):  # type: ignore[no-untyped-def]
    """Deformation q and its exact gradient J at the bodies' present positions.

    With d the vector between the two anchors and e, n the axes of a frame that turns with the angle
    ψ = (1 - α)(θa + φa) + α (θb + φb):

        u = e·d,  v = n·d,  θ = (θb + φb) - (θa + φa),
        u̇ = e·ḋ + (n·d) ψ̇,  v̇ = n·ḋ - (e·d) ψ̇.

    The terms in ψ̇ make the pair of forces exactly free of moment, so angular momentum is kept.
    """
    beta, h = settings[BETA], settings[STEP]
    for k in range(n):
        a = floats(body_at[joint_bodies[k, 0]], BODY_WORDS)
        b = floats(body_at[joint_bodies[k, 1]], BODY_WORDS)
        g = geometry[k]
        ca, sa, cb, sb = math.cos(a[ANGLE]), math.sin(a[ANGLE]), math.cos(b[ANGLE]), math.sin(b[ANGLE])
        rax, ray = ca * g[0] - sa * g[1], sa * g[0] + ca * g[1]
        rbx, rby = cb * g[2] - sb * g[3], sb * g[2] + cb * g[3]
        dx = b[X] + rbx - a[X] - rax
        dy = b[X + 1] + rby - a[X + 1] - ray
        alpha = g[6]
        angle_a, angle_b = a[ANGLE] + g[4], b[ANGLE] + g[5]
        psi = (1.0 - alpha) * angle_a + alpha * angle_b
        c, s = math.cos(psi), math.sin(psi)
        u, v = c * dx + s * dy, -s * dx + c * dy
        j = jacobian[k]
        j[0], j[1], j[2] = -c, -s, c * ray - s * rax + (1.0 - alpha) * v
        j[3], j[4], j[5] = c, s, -c * rby + s * rbx + alpha * v
        j[6], j[7], j[8] = s, -c, -s * ray - c * rax - (1.0 - alpha) * u
        j[9], j[10], j[11] = -s, c, s * rby + c * rbx - alpha * u
        j[12], j[13], j[14], j[15], j[16], j[17] = 0.0, 0.0, -1.0, 0.0, 0.0, 1.0
        q = deformation[k]
        q[0], q[1], q[2] = u, v, angle_b - angle_a
        if beta != 0.0:
            for i in range(3):
                m = 6 * i
                rate = j[m] * a[VX] + j[m + 1] * a[VX + 1] + j[m + 2] * a[SPIN]
                rate += j[m + 3] * b[VX] + j[m + 4] * b[VX + 1] + j[m + 5] * b[SPIN]
                q[i] -= beta * h * rate


@njit
def respond(  # type: ignore[no-untyped-def]
    n,
    moving,
    joint_bodies,
    body_at,
    laws,
    stiffness,
    settings,
    jacobian,
    deformation,
    impulse,
    velocity,
    response,
    residual,
    predicting,
):
    """Residual r of every joint at the present velocities; returns its energy and the scale to judge it by.

    While ``predicting``, every law is replaced by its elastic line through the deformation qₙ at the step's start.
    """
    h = settings[STEP]
    reach = h * (settings[BETA] + settings[DELTA])
    error, scale = 0.0, 0.0
    q, move = np.empty(3), np.empty(3)
    for k in range(n):
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        j, va, vb = jacobian[k], velocity[ia], velocity[ib]
        for i in range(3):
            m = 6 * i
            rate = j[m] * va[0] + j[m + 1] * va[1] + j[m + 2] * va[2]
            rate += j[m + 3] * vb[0] + j[m + 4] * vb[1] + j[m + 5] * vb[2]
            move[i] = reach * rate
            q[i] = deformation[k, i] if predicting else deformation[k, i] + move[i]
        call_law(laws[k, 0], laws[k, 2], laws[k, 3], q.ctypes.data, response[k].ctypes.data)
        if predicting:
            e, r = stiffness[k], response[k]
            r[0] += e[0] * move[0] + e[1] * move[1] + e[2] * move[2]
            r[1] += e[1] * move[0] + e[3] * move[1] + e[4] * move[2]
            r[2] += e[2] * move[0] + e[4] * move[1] + e[5] * move[2]
            for i in range(6):
                r[3 + i] = e[i]
        for i in range(3):
            residual[k, i] = -h * response[k, i] - impulse[k, i]
        for side in range(2):
            body = joint_bodies[k, side]
            if body < moving:
                b = floats(body_at[body], BODY_WORDS)
                o = 3 * side
                for i in range(3):
                    inverse = 1.0 / b[MOMENT] if i == 2 else 1.0 / b[MASS]
                    wrong = j[o + i] * residual[k, 0] + j[6 + o + i] * residual[k, 1] + j[12 + o + i] * residual[k, 2]
                    whole = j[o + i] * impulse[k, 0] + j[6 + o + i] * impulse[k, 1] + j[12 + o + i] * impulse[k, 2]
                    error += inverse * wrong * wrong
                    scale += inverse * whole * whole
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        v = velocity[i]
        scale += b[MASS] * (v[0] * v[0] + v[1] * v[1]) + b[MOMENT] * v[2] * v[2]
    return error, scale


@njit
def assemble(  # type: ignore[no-untyped-def]
    n, moving, joint_bodies, body_at, joint_slot, factor, response, jacobian, diagonal, lower
):
    """M + factor Jᵀ D J as 3 × 3 blocks, D from the joints' last response."""
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        diagonal[i, :] = 0.0
        diagonal[i, 0] = b[MASS]
        diagonal[i, 4] = b[MASS]
        diagonal[i, 8] = b[MOMENT]
    lower[:, :] = 0.0
    left = np.empty((3, 3))
    right = np.empty((3, 3))
    for k in range(n):
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        j = jacobian[k]
        t = response[k]
        d00, d01, d02 = factor * t[3], factor * t[4], factor * t[5]
        d11, d12, d22 = factor * t[6], factor * t[7], factor * t[8]
        for c in range(3):
            x, y, z = j[c], j[6 + c], j[12 + c]
            left[0, c] = d00 * x + d01 * y + d02 * z
            left[1, c] = d01 * x + d11 * y + d12 * z
            left[2, c] = d02 * x + d12 * y + d22 * z
            x, y, z = j[3 + c], j[9 + c], j[15 + c]
            right[0, c] = d00 * x + d01 * y + d02 * z
            right[1, c] = d01 * x + d11 * y + d12 * z
            right[2, c] = d02 * x + d12 * y + d22 * z
        if ia < moving:
            for r in range(3):
                for c in range(3):
                    diagonal[ia, 3 * r + c] += j[r] * left[0, c] + j[6 + r] * left[1, c] + j[12 + r] * left[2, c]
        if ib < moving:
            for r in range(3):
                for c in range(3):
                    diagonal[ib, 3 * r + c] += j[3 + r] * right[0, c] + j[9 + r] * right[1, c] + j[15 + r] * right[2, c]
        slot = joint_slot[k]
        if slot >= 0:
            block = lower[slot]
            o, other = (0, right) if ia > ib else (3, left)
            for r in range(3):
                for c in range(3):
                    block[3 * r + c] += (
                        j[o + r] * other[0, c] + j[6 + o + r] * other[1, c] + j[12 + o + r] * other[2, c]
                    )


@njit(inline="always")
def factorise_block(a):  # type: ignore[no-untyped-def]
    """L D Lᵀ of a symmetric 3 × 3 block in place: 1/d₀ l₁₀ l₂₀ · 1/d₁ l₂₁ · · 1/d₂.

    Not its inverse by cofactors: with rigid springs beside light bodies the minors cancel and every digit is lost.
    """
    d0 = 1.0 / a[0]
    l10, l20 = a[1] * d0, a[2] * d0
    d1 = 1.0 / (a[4] - l10 * a[1])
    l21 = (a[5] - l20 * a[1]) * d1
    d2 = 1.0 / (a[8] - l20 * a[2] - l21 * (a[5] - l20 * a[1]))
    a[0], a[1], a[2], a[4], a[5], a[8] = d0, l10, l20, d1, l21, d2


@njit(inline="always")
def solve_block(a, x, y, z):  # type: ignore[no-untyped-def]
    """Solve with a block that `factorise_block` has factored."""
    y -= a[1] * x
    z = (z - a[2] * x - a[5] * y) * a[8]
    y = y * a[4] - a[5] * z
    return x * a[0] - a[1] * y - a[2] * z, y, z


@njit
def factorise(moving, column_start, column_rows, fill_targets, diagonal, lower, scaled):  # type: ignore[no-untyped-def]
    """Block L D Lᵀ in place: ``diagonal`` is factored, ``scaled`` becomes L.

    ``fill_targets`` lists where the update of each pair of a column's rows goes.
    """
    at = 0
    for k in range(moving):
        d = diagonal[k]
        factorise_block(d)
        first, last = column_start[k], column_start[k + 1]
        for p in range(first, last):
            block, out = lower[p], scaled[p]
            for r in range(0, 9, 3):
                out[r], out[r + 1], out[r + 2] = solve_block(d, block[r], block[r + 1], block[r + 2])
        for p in range(first, last):
            source = lower[p]
            subtract_product(diagonal[column_rows[p]], scaled[p], source)
            for q in range(p + 1, last):
                subtract_product(lower[fill_targets[at]], scaled[q], source)
                at += 1


@njit(inline="always")
def subtract_product(target, a, b):  # type: ignore[no-untyped-def]
    """target -= a bᵀ for 3 × 3 blocks."""
    for r in range(0, 9, 3):
        x, y, z = a[r], a[r + 1], a[r + 2]
        target[r] -= x * b[0] + y * b[1] + z * b[2]
        target[r + 1] -= x * b[3] + y * b[4] + z * b[5]
        target[r + 2] -= x * b[6] + y * b[7] + z * b[8]


@njit
def substitute(moving, column_start, column_rows, diagonal, scaled, x):  # type: ignore[no-untyped-def]
    """Solve L D Lᵀ x = b in place; ``x`` holds b."""
    for k in range(moving):
        v = x[k]
        for p in range(column_start[k], column_start[k + 1]):
            w, f = x[column_rows[p]], scaled[p]
            for r in range(3):
                w[r] -= f[3 * r] * v[0] + f[3 * r + 1] * v[1] + f[3 * r + 2] * v[2]
    for k in range(moving - 1, -1, -1):
        v = x[k]
        v[0], v[1], v[2] = solve_block(diagonal[k], v[0], v[1], v[2])
        for p in range(column_start[k], column_start[k + 1]):
            w, f = x[column_rows[p]], scaled[p]
            for r in range(3):
                v[r] -= f[r] * w[0] + f[3 + r] * w[1] + f[6 + r] * w[2]


@njit
def gather(n, moving, joint_bodies, jacobian, per_joint, per_body):  # type: ignore[no-untyped-def]
    """Jᵀ times a vector of joint impulses."""
    per_body[:moving, :] = 0.0
    for k in range(n):
        j, r = jacobian[k], per_joint[k]
        for side in range(2):
            body = joint_bodies[k, side]
            if body < moving:
                o, x = 3 * side, per_body[body]
                for i in range(3):
                    x[i] += j[o + i] * r[0] + j[6 + o + i] * r[1] + j[12 + o + i] * r[2]


@njit
def advance(n, moving, share, joint_bodies, body_at, jacobian, slope, impulse, velocity):  # type: ignore[no-untyped-def]
    """λ += share Δλ and V += share M⁻¹ Jᵀ Δλ."""
    for k in range(n):
        j = jacobian[k]
        x, y, z = share * slope[k, 0], share * slope[k, 1], share * slope[k, 2]
        impulse[k, 0] += x
        impulse[k, 1] += y
        impulse[k, 2] += z
        for side in range(2):
            body = joint_bodies[k, side]
            if body < moving:
                b = floats(body_at[body], BODY_WORDS)
                o, v = 3 * side, velocity[body]
                v[0] += (j[o] * x + j[6 + o] * y + j[12 + o] * z) / b[MASS]
                v[1] += (j[o + 1] * x + j[7 + o] * y + j[13 + o] * z) / b[MASS]
                v[2] += (j[o + 2] * x + j[8 + o] * y + j[14 + o] * z) / b[MOMENT]


@njit
def linearise(  # type: ignore[no-untyped-def]
    n, moving, joint_bodies, factor, jacobian, residual, response, solution, slope
):
    """Δλ = r - factor D J ΔV."""
    for k in range(n):
        j, d = jacobian[k], response[k]
        x, y, z = 0.0, 0.0, 0.0
        for side in range(2):
            body = joint_bodies[k, side]
            if body < moving:
                o, v = 3 * side, solution[body]
                x += j[o] * v[0] + j[o + 1] * v[1] + j[o + 2] * v[2]
                y += j[6 + o] * v[0] + j[7 + o] * v[1] + j[8 + o] * v[2]
                z += j[12 + o] * v[0] + j[13 + o] * v[1] + j[14 + o] * v[2]
        slope[k, 0] = residual[k, 0] - factor * (d[3] * x + d[4] * y + d[5] * z)
        slope[k, 1] = residual[k, 1] - factor * (d[4] * x + d[6] * y + d[7] * z)
        slope[k, 2] = residual[k, 2] - factor * (d[5] * x + d[7] * y + d[8] * z)


@njit
def descent(n, moving, joint_bodies, jacobian, residual, direction):  # type: ignore[no-untyped-def]
    """r · J ΔV: how fast the incremental energy falls along ΔV."""
    total = 0.0
    for k in range(n):
        j, r = jacobian[k], residual[k]
        for side in range(2):
            body = joint_bodies[k, side]
            if body < moving:
                o, x = 3 * side, direction[body]
                for i in range(3):
                    total += x[i] * (j[o + i] * r[0] + j[6 + o + i] * r[1] + j[12 + o + i] * r[2])
    return total


@njit
def solve(c, h):  # type: ignore[no-untyped-def]
    """Newton's method to convergence, from the bodies' velocities to the velocities with the joints."""
    t = integers(c, CONTROL_WORDS)
    bodies, moving, n, m = t[BODIES], t[MOVING], t[JOINTS], t[LOWER]
    body_at = integers(t[BODY_AT], bodies)
    joint_bodies = integers(t[JOINT_BODIES], 2 * n).reshape(n, 2)
    laws = integers(t[LAWS], 4 * n).reshape(n, 4)
    column_start, column_rows = integers(t[COLUMN_START], moving + 1), integers(t[COLUMN_ROWS], m)
    targets, joint_slot = integers(t[FILL_TARGETS], 1), integers(t[JOINT_SLOT], n)
    settings = floats(t[SETTINGS], SETTINGS_WORDS)
    stiffness, jacobian = table(t[STIFFNESS], n, 6), table(t[JACOBIAN], n, 18)
    deformation, impulse, residual = table(t[DEFORMATION], n, 3), table(t[IMPULSE], n, 3), table(t[RESIDUAL], n, 3)
    slope, response = table(t[SLOPE], n, 3), table(t[RESPONSE], n, RESPONSE_WORDS)
    velocity, solution = table(t[VELOCITY], bodies, 3), table(t[SOLUTION], moving, 3)
    diagonal, lower, scaled = table(t[DIAGONAL], moving, 9), table(t[LOWER_BLOCKS], m, 9), table(t[SCALED_BLOCKS], m, 9)

    for i in range(bodies):
        b = floats(body_at[i], BODY_WORDS)
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = b[VX], b[VX + 1], b[SPIN]
    factor = h * h * (settings[BETA] + settings[DELTA])
    tolerance = settings[TOLERANCE]
    # The first solve of a step takes every joint as elastic: at the velocities without joints all of them may seem to
    # yield, and from there the way to the solution is long.
    predicting = t[FRESH] == 1
    t[FRESH] = 0
    t[SOLVES] += 1
    error, scale = respond(
        n,
        moving,
        joint_bodies,
        body_at,
        laws,
        stiffness,
        settings,
        jacobian,
        deformation,
        impulse,
        velocity,
        response,
        residual,
        predicting,
    )
    converged = not predicting and error <= tolerance * scale
    best = error
    for step in range(_MOST_NEWTON_STEPS):
        if converged:
            break
        t[NEWTON_STEPS] += 1
        assemble(n, moving, joint_bodies, body_at, joint_slot, factor, response, jacobian, diagonal, lower)
        factorise(moving, column_start, column_rows, targets, diagonal, lower, scaled)
        gather(n, moving, joint_bodies, jacobian, residual, solution)
        substitute(moving, column_start, column_rows, diagonal, scaled, solution)
        linearise(n, moving, joint_bodies, factor, jacobian, residual, response, solution, slope)
        start = descent(n, moving, joint_bodies, jacobian, residual, solution)
        advance(n, moving, 1.0, joint_bodies, body_at, jacobian, slope, impulse, velocity)
        error, scale = respond(
            n,
            moving,
            joint_bodies,
            body_at,
            laws,
            stiffness,
            settings,
            jacobian,
            deformation,
            impulse,
            velocity,
            response,
            residual,
            False,
        )
        converged = error <= tolerance * scale
        if converged:
            break
        if predicting:
            predicting = False
            best = error
            continue
        # Along the step the energy is convex: where it rises too steeply at the end, its least value lies before.
        fall = descent(n, moving, joint_bodies, jacobian, residual, solution)
        if fall < -0.5 * start:
            share, low, high, fall_low, fall_high = 1.0, 0.0, 1.0, start, fall
            for _ in range(_MOST_SEARCHES):
                new = low + (high - low) * fall_low / (fall_low - fall_high)
                new = min(max(new, low + 0.05 * (high - low)), high - 0.05 * (high - low))
                advance(n, moving, new - share, joint_bodies, body_at, jacobian, slope, impulse, velocity)
                share = new
                error, scale = respond(
                    n,
                    moving,
                    joint_bodies,
                    body_at,
                    laws,
                    stiffness,
                    settings,
                    jacobian,
                    deformation,
                    impulse,
                    velocity,
                    response,
                    residual,
                    False,
                )
                fall = descent(n, moving, joint_bodies, jacobian, residual, solution)
                if abs(fall) <= 0.3 * start:
                    break
                if fall > 0.0:
                    low, fall_low = new, fall
                else:
                    high, fall_high = new, fall
            converged = error <= tolerance * scale
        # Below this it is rounding that remains, and another step would not take it away.
        if step >= 3 and error >= 0.25 * best and error <= 1e6 * tolerance * scale:
            converged = True
        best = min(best, error)
    settings[LAST_RESIDUAL] = math.sqrt(error / scale) if scale > 0.0 else 0.0
    finite = True
    for i in range(moving):
        finite = finite and math.isfinite(velocity[i, 0] + velocity[i, 1] + velocity[i, 2])
    if not finite:
        t[STATUS] = NOT_FINITE
        impulse[:, :] = 0.0
        return
    if not converged:
        t[UNCONVERGED] += 1
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        b[VX], b[VX + 1], b[SPIN] = velocity[i, 0], velocity[i, 1], velocity[i, 2]


@njit
def commit(c):  # type: ignore[no-untyped-def]
    """Let every law take over the plastic state at the step's final q*, and write down what the joints bear."""
    t = integers(c, CONTROL_WORDS)
    bodies, n = t[BODIES], t[JOINTS]
    body_at = integers(t[BODY_AT], bodies)
    joint_bodies = integers(t[JOINT_BODIES], 2 * n).reshape(n, 2)
    laws = integers(t[LAWS], 4 * n).reshape(n, 4)
    settings, jacobian = floats(t[SETTINGS], SETTINGS_WORDS), table(t[JACOBIAN], n, 18)
    deformation, impulse = table(t[DEFORMATION], n, 3), table(t[IMPULSE], n, 3)
    result = table(t[RESULT], n, RESULT_WORDS)
    h = settings[STEP]
    reach = h * (settings[BETA] + settings[DELTA])
    out = np.empty(2)
    for k in range(n):
        a = floats(body_at[joint_bodies[k, 0]], BODY_WORDS)
        b = floats(body_at[joint_bodies[k, 1]], BODY_WORDS)
        j = jacobian[k]
        for i in range(3):
            m = 6 * i
            rate = j[m] * a[VX] + j[m + 1] * a[VX + 1] + j[m + 2] * a[SPIN]
            rate += j[m + 3] * b[VX] + j[m + 4] * b[VX + 1] + j[m + 5] * b[SPIN]
            result[k, i] = deformation[k, i] + reach * rate
            result[k, 3 + i] = -impulse[k, i] / h
        call_law(laws[k, 1], laws[k, 2], laws[k, 3], result[k].ctypes.data, out.ctypes.data)
        result[k, 6] = out[0]
        result[k, 7] += out[1]


_STEP_SIGNATURE = types.void(types.int64, types.float64)


@cfunc(_STEP_SIGNATURE, cache=True)
def pre_step(constraint, h):  # type: ignore[no-untyped-def]
    c = integers(constraint, CONTROL + 1)[CONTROL]
    t = integers(c, CONTROL_WORDS)
    n = t[JOINTS]
    settings = floats(t[SETTINGS], SETTINGS_WORDS)
    settings[STEP] = h
    t[FRESH] = 1
    table(t[IMPULSE], n, 3)[:, :] = 0.0
    prepare(
        n,
        integers(t[JOINT_BODIES], 2 * n).reshape(n, 2),
        integers(t[BODY_AT], t[BODIES]),
        table(t[GEOMETRY], n, GEOMETRY_WORDS),
        settings,
        table(t[JACOBIAN], n, 18),
        table(t[DEFORMATION], n, 3),
    )


@cfunc(_STEP_SIGNATURE, cache=True)
def apply_cached_impulse(constraint, ratio):  # type: ignore[no-untyped-def]
    """Nothing: the implicit solve needs no warm start."""


@cfunc(_STEP_SIGNATURE, cache=True)
def apply_impulse(constraint, h):  # type: ignore[no-untyped-def]
    solve(integers(constraint, CONTROL + 1)[CONTROL], h)


@cfunc(types.float64(types.int64), cache=True)
def get_impulse(constraint):  # type: ignore[no-untyped-def]
    """The largest impulse of any joint, N s."""
    t = integers(integers(constraint, CONTROL + 1)[CONTROL], CONTROL_WORDS)
    impulse = table(t[IMPULSE], t[JOINTS], 3)
    largest = 0.0
    for k in range(t[JOINTS]):
        largest = max(largest, math.hypot(impulse[k, 0], impulse[k, 1]))
    return largest


@cfunc(types.void(types.int64, types.int64), cache=True)
def after_step(constraint, space):  # type: ignore[no-untyped-def]
    commit(integers(constraint, CONTROL + 1)[CONTROL])


#: Chipmunk's table of functions for a constraint.
FUNCTIONS = np.array([f.address for f in (pre_step, apply_cached_impulse, apply_impulse, get_impulse)], dtype=np.int64)
AFTER_STEP = after_step.address
