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
part of s, with c / h(β + δ) in D. `approach` has the steps in turn, and what is done where they get nowhere.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import factorise_matrix, solve
from sim.kernels.layout import TANGENT
from sim.kernels.residual import (
    advance,
    apply,
    descend,
    descent,
    gather,
    motion_scale,
    respond,
    respond_along_lines,
    strip_tangents,
)
from sim.kernels.spread import advance_spread, along, spread_factor, spread_residual, spread_step
from sim.memory import inlined, kernel

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
