"""A load pattern under displacement control: one spring on many bodies at once.

With a pattern p of forces on the bodies and w the displacement that it works on, ẇ = p·V, a spring of stiffness k
between w and where a driver wants it gives the load factor

    Λ = h k (w_driver - w*),   w* = w_n + h (β + δ) p·V,

so the matrix gains c p pᵀ with c = (β + δ) h² k. That couples all loaded bodies; by Sherman and Morrison's formula it
costs one more substitution. With z = H⁻¹ Jᵀ r for the joints' residuals and y = H⁻¹ p, the spring's own residual ρ
changes the load factor by ΔΛ, and the velocities by ΔV:

    ΔΛ = (ρ - c p·z) / (1 + c p·y),   ΔV = z + ΔΛ y.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import solve
from sim.kernels.layout import BETA, DELTA, INVERSE_I, INVERSE_M, SPREAD_GAP, SPREAD_IMPULSE, SPREAD_STIFFNESS, STEP
from sim.memory import kernel


@kernel
def along(t, pattern, vector):  # type: ignore[no-untyped-def]
    """p · a vector over the bodies."""
    total = 0.0
    for i in range(t[at.MOVING]):
        total += pattern[i, 0] * vector[i, 0] + pattern[i, 1] * vector[i, 1] + pattern[i, 2] * vector[i, 2]
    return total


@kernel
def spread_residual(t):  # type: ignore[no-untyped-def]
    """Residual impulse ρ of the spring, in units of the load factor, and p · M⁻¹ p."""
    settings, pattern, weight = views.settings(t), views.per_body(t, at.PATTERN), views.weight(t)
    h, k = settings[STEP], settings[SPREAD_STIFFNESS]
    reach = h * (settings[BETA] + settings[DELTA])
    light = 0.0
    for i in range(t[at.MOVING]):
        light += (pattern[i, 0] ** 2 + pattern[i, 1] ** 2) * weight[i, INVERSE_M]
        light += pattern[i, 2] ** 2 * weight[i, INVERSE_I]
    moved = reach * along(t, pattern, views.per_body(t, at.VELOCITY))
    return h * k * (settings[SPREAD_GAP] - moved) - settings[SPREAD_IMPULSE], light


@kernel
def spread_factor(t):  # type: ignore[no-untyped-def]
    """c, the spring's part of the matrix."""
    settings = views.settings(t)
    return settings[STEP] ** 2 * (settings[BETA] + settings[DELTA]) * settings[SPREAD_STIFFNESS]


@kernel
def spread_step(t, residual):  # type: ignore[no-untyped-def]
    """Turn z into ΔV in the structure's solution, which it leaves y in its image for; returns ΔΛ."""
    pattern, c = views.per_body(t, at.PATTERN), spread_factor(t)
    solution, image = views.per_body(t, at.SOLUTION), views.per_body(t, at.IMAGE)
    for i in range(t[at.MOVING]):
        for j in range(3):
            image[i, j] = pattern[i, j]
    solve(t, 0, image)
    change = (residual - c * along(t, pattern, solution)) / (1.0 + c * along(t, pattern, image))
    for i in range(t[at.MOVING]):
        for j in range(3):
            solution[i, j] += change * image[i, j]
    return change


@kernel
def advance_spread(t, amount):  # type: ignore[no-untyped-def]
    """Λ += amount and V += M⁻¹ p amount."""
    settings, pattern, weight = views.settings(t), views.per_body(t, at.PATTERN), views.weight(t)
    velocity = views.per_body(t, at.VELOCITY)
    settings[SPREAD_IMPULSE] += amount
    for i in range(t[at.MOVING]):
        velocity[i, 0] += amount * pattern[i, 0] * weight[i, INVERSE_M]
        velocity[i, 1] += amount * pattern[i, 1] * weight[i, INVERSE_M]
        velocity[i, 2] += amount * pattern[i, 2] * weight[i, INVERSE_I]
