"""A load pattern under displacement control: one spring on many bodies at once.

With a pattern p of forces on the bodies and w the displacement that it works on, ẇ = p·V, a spring of stiffness k
between w and where a driver wants it gives the load factor

    Λ = h k (w_driver - w*),   w* = w_n + h (β + δ) p·V,

so the matrix gains c p pᵀ with c = (β + δ) h² k. That couples all loaded bodies; by Sherman and Morrison's formula it
costs one more substitution, with H⁻¹ p:

    (H + c p pᵀ)⁻¹ R = x - H⁻¹p · c p·x / (1 + c p·H⁻¹p),   x = H⁻¹ R.
"""

from numba import njit

from sim.chipmunk import BODY_WORDS, MASS_INVERSE, MOMENT_INVERSE
from sim.kernels.blocks import substitute
from sim.kernels.layout import BETA, DELTA, SPREAD_GAP, SPREAD_IMPULSE, SPREAD_STIFFNESS, STEP
from sim.memory import floats


@njit(error_model="numpy")
def along(moving, pattern, vector):  # type: ignore[no-untyped-def]
    """p · a vector over the bodies."""
    total = 0.0
    for i in range(moving):
        total += pattern[i, 0] * vector[i, 0] + pattern[i, 1] * vector[i, 1] + pattern[i, 2] * vector[i, 2]
    return total


@njit(error_model="numpy")
def spread_residual(moving, settings, pattern, velocity):  # type: ignore[no-untyped-def]
    """Residual impulse of the spring, in units of the load factor."""
    h, k = settings[STEP], settings[SPREAD_STIFFNESS]
    reach = h * (settings[BETA] + settings[DELTA])
    return h * k * (settings[SPREAD_GAP] - reach * along(moving, pattern, velocity)) - settings[SPREAD_IMPULSE]


@njit(error_model="numpy")
def lightness_of(moving, body_at, pattern):  # type: ignore[no-untyped-def]
    """P · M⁻¹ p."""
    total = 0.0
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        total += (pattern[i, 0] ** 2 + pattern[i, 1] ** 2) * b[MASS_INVERSE] + pattern[i, 2] ** 2 * b[MOMENT_INVERSE]
    return total


@njit(error_model="numpy")
def add_spread(moving, pattern, amount, vector):  # type: ignore[no-untyped-def]
    """Add ``amount`` of the pattern to a vector over the bodies."""
    for i in range(moving):
        for j in range(3):
            vector[i, j] += amount * pattern[i, j]


@njit(error_model="numpy")
def spread_correction(  # type: ignore[no-untyped-def]
    moving, settings, pattern, column_start, column_rows, diagonal, scaled, solution, image
):
    """Turn x = H⁻¹ R into (H + c p pᵀ)⁻¹ R; returns p·ΔV and c."""
    c = settings[STEP] ** 2 * (settings[BETA] + settings[DELTA]) * settings[SPREAD_STIFFNESS]
    for i in range(moving):
        for j in range(3):
            image[i, j] = pattern[i, j]
    substitute(moving, 0, column_start, column_rows, diagonal, scaled, image)
    share = c * along(moving, pattern, solution) / (1.0 + c * along(moving, pattern, image))
    for i in range(moving):
        for j in range(3):
            solution[i, j] -= share * image[i, j]
    return along(moving, pattern, solution), c


@njit(error_model="numpy")
def advance_spread(moving, amount, body_at, pattern, settings, velocity):  # type: ignore[no-untyped-def]
    """Λ += amount and V += M⁻¹ p amount."""
    settings[SPREAD_IMPULSE] += amount
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        velocity[i, 0] += amount * pattern[i, 0] * b[MASS_INVERSE]
        velocity[i, 1] += amount * pattern[i, 1] * b[MASS_INVERSE]
        velocity[i, 2] += amount * pattern[i, 2] * b[MOMENT_INVERSE]
