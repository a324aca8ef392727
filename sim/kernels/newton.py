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

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import factorise_matrix, solve
from sim.kernels.layout import STEP, TANGENT
from sim.kernels.residual import (
    advance,
    apply,
    descend,
    descent,
    gather,
    motion_scale,
    reach_of,
    respond,
    respond_along_lines,
    respond_stiffer,
    strip_tangents,
)
from sim.kernels.spread import advance_spread, along, spread_factor, spread_residual, spread_step
from sim.memory import inlined, kernel

MOST_NEWTON_STEPS = 200
#: After so many steps, begin anew with joints that are soft, and go on to stiffer ones.
_PATIENCE = 15
# Resistance of joints that are soft, over their bodies' inertia, and by how much they are made stiffer at a time.
_SOFT, _STIFFER = 10.0, 30.0
MOST_SEARCHES = 40
_KINK = 1e-3
_MOST_REFINEMENTS = 5


@inlined
def restart(t):  # type: ignore[no-untyped-def]
    """Apply the last step's impulses, which a step starts from, to velocities without joints.

    From those, forces would be differences of numbers a million times their size.
    """
    apply(t, views.per_joint(t, at.IMPULSE), 1.0, 0.0)
    if t[at.SPREAD] == 1:
        settings = views.settings(t)
        amount, settings[at.SPREAD_IMPULSE] = settings[at.SPREAD_IMPULSE], 0.0
        advance_spread(t, amount)


@inlined
def measure(t):  # type: ignore[no-untyped-def]
    """Residuals of the joints and of the load pattern's spring; returns their energy, that of all, and the spring's."""
    error, size = respond(t)
    spring, of_spring = pull(t)
    return error + of_spring, size, spring


@inlined
def measure_along_lines(t, tangents, first):  # type: ignore[no-untyped-def]
    """As `measure`, for laws that are lines with these tangents."""
    error, size = respond_along_lines(t, tangents, first)
    spring, of_spring = pull(t)
    return error + of_spring, size, spring


@inlined
def pull(t):  # type: ignore[no-untyped-def]
    """Residual of the load pattern's spring, if there is one, and its energy."""
    if t[at.SPREAD] == 0:
        return 0.0, 0.0
    spring, light = spread_residual(t)
    return spring, light * spring * spring


@kernel
def newton_step(t, factor, spring):  # type: ignore[no-untyped-def]
    """Find ΔV and Δλ with the factor at hand, and go there.

    Returns how fast the energy falls along ΔV at first, and the spring's ΔΛ.
    """
    solution, change, fall = views.per_body(t, at.SOLUTION), 0.0, 0.0
    gather(t, views.per_joint(t, at.RESIDUAL), solution)
    solve(t, 0, solution)
    if t[at.SPREAD] == 1:
        change = spread_step(t, spring)
        fall = spring * along(t, views.per_body(t, at.PATTERN), solution)
    fall += descend(t, factor, 1.0)
    if t[at.SPREAD] == 1:
        advance_spread(t, change)
    return fall, change


@kernel
def go_on(t, length, change):  # type: ignore[no-untyped-def]
    """Go ``length`` of the last Newton step, and of the spring's ``change`` in it, once more."""
    advance(t, length)
    if t[at.SPREAD] == 1:
        advance_spread(t, length * change)


@inlined
def predict(t, factor, enough):  # type: ignore[no-untyped-def]
    """The first solve of a step: goes on with the tangents of a last step that flowed, or takes all joints as elastic.

    At the velocities without joints all of them may seem to yield, and from there the way to the solution is long.
    Returns what `measure` does then, and the `motion_scale`.
    """
    if t[at.FLOWING] == 0:
        return predict_elastic(t, factor, enough)
    strip_tangents(t)
    _, _, spring = measure_along_lines(t, views.response(t), TANGENT)
    factorise_matrix(t, factor)
    newton_step(t, factor, spring)
    error, size, spring = measure(t)
    return error, size, spring, motion_scale(t)


@kernel
def predict_elastic(t, factor, enough):  # type: ignore[no-untyped-def]
    """Take every joint as elastic; refined where joints are so stiff that they seem to yield by rounding alone."""
    before, size, spring = measure_along_lines(t, views.stiffness(t), 0)
    factorise_matrix(t, factor)
    error, motion = before, 0.0
    for _ in range(_MOST_REFINEMENTS):
        newton_step(t, factor, spring)
        error, size, spring = measure(t)
        motion = motion_scale(t)
        if error <= enough * (size + motion):
            break
        rest, _, spring = measure_along_lines(t, views.stiffness(t), 0)
        if rest > 0.1 * before or rest <= enough * size:
            error, size, spring = measure(t)
            break
        before = rest
    return error, size, spring, motion


@inlined
def iterate(t, predicting):  # type: ignore[no-untyped-def]
    """Newton's method from the present velocities; returns steps taken, whether it converged, and the residual.

    The first solve of a step is ``predicting``. The residual is finite if impulses and velocities are.
    """
    settings = views.settings(t)
    factor, tolerance, rounding = settings[STEP] * reach_of(t), settings[at.TOLERANCE], settings[at.ROUNDING]
    steps, begun = 0, 0
    if predicting:
        error, size, spring, motion = predict(t, factor, tolerance)
        steps = 1
    else:
        error, size, spring = measure(t)
        motion = motion_scale(t)
    converged = error <= tolerance * (size + motion) + rounding
    best = error
    while not converged and steps < MOST_NEWTON_STEPS and math.isfinite(error):
        steps += 1
        if steps == _PATIENCE:
            error, size, spring = resist(t, softness(t, factor))
            gone, begun, best = 0.0, steps, error
        else:
            factorise_matrix(t, factor)
            start, change = newton_step(t, factor, spring)
            error, size, spring, gone = search(t, factor, start, change, tolerance, motion, steps >= _PATIENCE)
        converged = error <= tolerance * (size + motion) + rounding
        # Below this it is rounding that remains, and another step would not take it away; one that was cut short says
        # so only when many have been taken.
        enough = 3 if gone == 1.0 else _PATIENCE
        if steps - begun > enough and error >= 0.25 * best and error <= 1e6 * tolerance * (size + motion):
            converged = True
        best = min(best, error)
        if settings[at.SOFT] < 1.0 and (converged or steps - begun > _PATIENCE):
            error, size, spring = stiffen(t, factor, spring)
            converged = settings[at.SOFT] == 1.0 and error <= tolerance * (size + motion) + rounding
            begun, best = steps, error
    if settings[at.SOFT] != 1.0:
        error, size, spring = resist(t, 1.0)
    if steps > (1 if predicting else 0):
        motion = motion_scale(t)
    total = size + motion + rounding / tolerance
    return steps, converged, math.sqrt(error / total) if 0.0 < total < math.inf else total


@kernel
def softness(t, factor):  # type: ignore[no-untyped-def]
    """Share of their stiffness with which all joints resist no more than some times as much as their bodies' inertia.

    Where weak joints are stiff beyond that, the energy has a kink wherever one begins to yield, each in the way of all
    others, and Newton's method gets nowhere. Which joints yield is decided by their strength and by the bodies'
    inertia, so joints that are soft find it out in a few steps; then they are made stiffer, and stiffer again, each
    time with those yielding that did, see `stiffen`.
    """
    lightness, stiffness, most = views.per_joint(t, at.LIGHTNESS), views.stiffness(t), 0.0
    for k in range(t[at.JOINTS]):
        for i, word in ((0, 0), (1, 3), (2, 5)):
            most = max(most, factor * stiffness[k, word] * lightness[k, i])
    return min(_SOFT / most, 1.0) if most > 0.0 else 1.0


@kernel
def stiffen(t, factor, spring):  # type: ignore[no-untyped-def]
    """Make soft joints stiffer, along their lines first; returns what `measure` does then."""
    settings = views.settings(t)
    ratio = min(_STIFFER, 1.0 / settings[at.SOFT])
    respond_stiffer(t, ratio)
    factorise_matrix(t, factor)
    newton_step(t, factor, spring)
    return resist(t, ratio * settings[at.SOFT] if ratio == _STIFFER else 1.0)


@kernel
def resist(t, share):  # type: ignore[no-untyped-def]
    """Have all joints resist with a ``share`` of their stiffness; returns what `measure` does then."""
    views.settings(t)[at.SOFT] = share
    return measure(t)


@kernel
def search(t, factor, start, change, tolerance, motion, careful):  # type: ignore[no-untyped-def]
    """Line search: how far to go of the step just taken; returns what `measure` does there, and how far it went.

    Along it the energy is convex, and falls with ``start`` at first: where it rises too steeply in the end, its least
    value lies further back. How steeply it falls is piecewise straight, with jumps of slope where joints begin or cease
    to yield: the next place to look at is where the straight lines at both ends of what is left come to nought. Steps
    that come after many others are ``careful``: by false position, which ends nearer to a kink.
    """
    length, low, high, line_low, line_high = 1.0, 0.0, 1.0, 1.0, 1.0
    gone, last = 1.0, False
    fall_low, fall_high = start, 0.0
    error, size, spring = 0.0, 0.0, 0.0
    for attempt in range(MOST_SEARCHES):
        if length != gone:
            go_on(t, length - gone, change)
            gone = length
        error, size, spring = measure(t)
        if last or error <= tolerance * (size + motion):
            break
        fall, bend = slope_along(t, factor, spring, change)
        if abs(fall) <= 0.3 * start or (attempt == 0 and fall >= -0.5 * start):
            break
        nought = length + fall / bend if bend > 0.0 else 0.5 * (low + high)
        if fall > 0.0:
            low, fall_low, line_low = length, fall, nought
        else:
            high, fall_high, line_high = length, fall, nought
        if high - low <= _KINK * high:
            # The slope jumps here, where a joint stops yielding. Beyond the jump its tangent is the stiff one, and
            # the next step can follow it; before it the same step would be tried again.
            if fall <= 0.0:
                break
            length, last = high, True
        else:
            length = min(line_low, line_high)
            if careful:
                length = low + (high - low) * fall_low / (fall_low - fall_high)
                length = min(max(length, low + 0.02 * (high - low)), high - 0.02 * (high - low))
            if attempt % 3 == 2 or not low < length < high:
                length = 0.5 * (low + high)
    return error, size, spring, gone


@kernel
def slope_along(t, factor, spring, change):  # type: ignore[no-untyped-def]
    """How fast the energy falls along the direction, the load pattern's spring included, and how fast that falls."""
    fall, bend = descent(t, factor)
    if t[at.SPREAD] == 1:
        way = along(t, views.per_body(t, at.PATTERN), views.per_body(t, at.SOLUTION))
        fall += spring * way
        bend += (spread_factor(t) * way + change) * way
    return fall, bend
