"""Stress resultants of fibre sections and what they do to an element, at every quadrature point of a frame at once.

A fibre at height y has strain ε = ε₀ - y κ and the law of its material: elastic–perfectly plastic layers in parallel
(J. F. Besseling, A theory of elastic, plastic, and creep deformations, J. Appl. Mech. 25, 1958). Layer j takes the
share E_(j-1) - E_j of the stiffness, yields at the strain ε_j, and has slipped by s_j:

    σ = E_n ε + Σ_j (E_(j-1) - E_j) clip(ε - s_j, -ε_j, ε_j).

On first loading that is the curve through the breaks ε_j with slopes E_j; unloading is the same curve at twice the size
(Masing), so hardening is kinematic. One layer is bilinear kinematic hardening. The section gives N = Σ A σ and
M = -Σ A y σ.

The fibres of all elements are one loop of compiled code: there are some thousand of them in a frame, visited in every
Newton step.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

#: Least tangent modulus over E in the Newton matrix. A section that yields throughout has no stiffness left, not even
#: axially, and a member beyond it could slide off; the floor keeps the matrix regular and leaves the forces alone.
TANGENT_FLOOR = 1e-7


@dataclass(frozen=True)
class FibreSections:
    """Fibre sections of n elements, of m kinds with f fibres each, of r materials with l layers each.

    Attributes
    ----------
    kind : (n,) int
        Which of the m sections an element has.
    y, area : (m, f) float
        Fibre heights [m] and areas [m²].
    material : (m, f) int
        Which of the r materials a fibre is of.
    youngs_modulus : (r,) float
        E [Pa].
    last_slope : (r,) float
        Slope of the stress–strain curve beyond its last break [Pa].
    breaks, drops : (r, l) float
        Strains ε_j at which the slope changes [-], and by how much it falls there [Pa].
    shear_stiffness : (n,) float
        GA_s [N].
    """

    kind: np.ndarray
    y: np.ndarray
    area: np.ndarray
    material: np.ndarray
    youngs_modulus: np.ndarray
    last_slope: np.ndarray
    breaks: np.ndarray
    drops: np.ndarray
    shear_stiffness: np.ndarray

    def virgin(self, points: int) -> np.ndarray:
        """Slips of sections that were never loaded, (n, points, f, l)."""
        return np.zeros((len(self.kind), points, self.y.shape[1], self.breaks.shape[1]))

    def respond(
        self, deformation: np.ndarray, strain_matrix: np.ndarray, weights: np.ndarray, slip: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Elements of q quadrature points and k degrees of freedom.

        Parameters
        ----------
        deformation : (n, k) float
            Degrees of freedom of each element.
        strain_matrix : (n, q, 3, k) float
            (ε₀ [-], κ [1/m], γ [-]) from them.
        weights : (n, q) float
            Quadrature weights [m].
        slip : (n, q, f, l) float
            Slips before this step [-].

        Returns
        -------
        strain, stress : (n, q, 3) float
            (ε₀, κ, γ) and (N, M, Q).
        stored : (n, q) float
            Energy that unloading would give back, ∫ σ² / 2E dA + GA_s γ² / 2 [J/m].
        force : (n, k) float
            Σ w Bᵀ (N, M, Q).
        matrix : (n, k, k) float
            Its derivative, with the tangent of a fibre no less than `TANGENT_FLOOR` E.
        axial_slope : (n, k) float
            Derivative of Σ w N.
        slip : (n, q, f, l) float
            Slips if this step is accepted.
        """
        n, q, _, k = strain_matrix.shape
        strain, stress, stored = np.empty((n, q, 3)), np.empty((n, q, 3)), np.empty((n, q))
        force, matrix, axial_slope = np.zeros((n, k)), np.zeros((n, k, k)), np.zeros((n, k))
        after = np.empty_like(slip)
        _elements(
            deformation, strain_matrix, weights, self.kind, self.y, self.area, self.material,
            self.youngs_modulus, self.last_slope, self.breaks, self.drops, self.shear_stiffness, slip,
            strain, stress, stored, force, matrix, axial_slope, after,
        )  # fmt: skip
        return strain, stress, stored, force, matrix, axial_slope, after

    def plastic_strain(self, strain: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """ε - σ / E of every fibre, (n, q, f), at strains (n, q, 3) with the slips (n, q, f, l) that belong to them."""
        plastic = np.empty(slip.shape[:3])
        _plastic_strain(
            strain, slip, self.kind, self.y, self.material, self.youngs_modulus, self.last_slope, self.drops, plastic
        )
        return plastic


@njit(cache=True, error_model="numpy")
def _elements(  # type: ignore[no-untyped-def]
    deformation, strain_matrix, weights, kind, y, area, material,
    youngs_modulus, last_slope, breaks, drops, shear_stiffness, slip,
    strain, stress, stored, force, matrix, axial_slope, after,
):  # fmt: skip
    n, points, _, size = strain_matrix.shape
    fibres, layers = slip.shape[2], slip.shape[3]
    weighted = np.empty((3, size))
    for e in range(n):
        m = kind[e]
        shear = shear_stiffness[e]
        for p in range(points):
            b, w = strain_matrix[e, p], weights[e, p]
            for row in range(3):
                total = 0.0
                for i in range(size):
                    total += b[row, i] * deformation[e, i]
                strain[e, p, row] = total
            axial, curvature, sliding = strain[e, p, 0], strain[e, p, 1], strain[e, p, 2]
            N = M = ea = es = ei = energy = 0.0
            for f in range(fibres):
                height = y[m, f]
                here = axial - height * curvature
                r = material[m, f]
                modulus, last = youngs_modulus[r], last_slope[r]
                sigma, slope = last * here, last
                for j in range(layers):
                    elastic, most, share = here - slip[e, p, f, j], breaks[r, j], drops[r, j]
                    if elastic > most:
                        sigma += share * most
                        after[e, p, f, j] = here - most
                    elif elastic < -most:
                        sigma -= share * most
                        after[e, p, f, j] = here + most
                    else:
                        sigma += share * elastic
                        slope += share
                        after[e, p, f, j] = slip[e, p, f, j]
                pull, stiffness = area[m, f] * sigma, area[m, f] * max(slope, TANGENT_FLOOR * modulus)
                N += pull
                M -= pull * height
                energy += pull * sigma / modulus
                ea += stiffness
                es -= stiffness * height
                ei += stiffness * height * height
            Q = shear * sliding
            stress[e, p, 0], stress[e, p, 1], stress[e, p, 2] = N, M, Q
            stored[e, p] = 0.5 * (energy + Q * sliding)
            for i in range(size):
                weighted[0, i] = w * (ea * b[0, i] + es * b[1, i])
                weighted[1, i] = w * (es * b[0, i] + ei * b[1, i])
                weighted[2, i] = w * shear * b[2, i]
                axial_slope[e, i] += weighted[0, i]
                force[e, i] += w * (N * b[0, i] + M * b[1, i] + Q * b[2, i])
            for i in range(size):
                for j in range(i + 1):
                    matrix[e, i, j] += b[0, i] * weighted[0, j] + b[1, i] * weighted[1, j] + b[2, i] * weighted[2, j]
        for i in range(size):
            for j in range(i):
                matrix[e, j, i] = matrix[e, i, j]


@njit(cache=True, error_model="numpy")
def _plastic_strain(  # type: ignore[no-untyped-def]
    strain, slip, kind, y, material, youngs_modulus, last_slope, drops, plastic
):  # fmt: skip
    n, points, fibres, layers = slip.shape
    for e in range(n):
        for p in range(points):
            for f in range(fibres):
                here = strain[e, p, 0] - y[kind[e], f] * strain[e, p, 1]
                r = material[kind[e], f]
                of_layers = 0.0
                for j in range(layers):
                    of_layers += (here - slip[e, p, f, j]) * drops[r, j]
                plastic[e, p, f] = here - (last_slope[r] * here + of_layers) / youngs_modulus[r]
