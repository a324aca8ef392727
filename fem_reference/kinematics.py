"""How displacements strain an element, and what its forces do where it has moved to.

Three ways, for n elements with 8 degrees of freedom each (x, y, θ at both ends, axial bubble, shear strain γ):

small      strains are B d, equilibrium is that of the undeformed frame.

p-delta    strains are B d; the mean axial force N of an element, which keeps its direction along the displaced chord,
           turns with the chord by ψ = z · d / L and pulls its ends across by N ψ:

               f = Bᵀ σ + N ψ z,   K = Bᵀ D B + N z zᵀ / L + ψ z ∂N/∂d.

large      corotational (M. A. Crisfield, Non-linear Finite Element Analysis of Solids and Structures, vol. 1, chapter
           7): the natural deformations q = (extension, end rotations from the chord, bubble, γ) strain the element
           as if they were small, σ = σ(B q), p = Bᵀ σ, and with T = ∂q/∂d

               f = Tᵀ p,   K = Tᵀ Bᵀ D B T + N z zᵀ / L + (M₁ + M₂)(r zᵀ + z rᵀ) / L².

r = (-c, -s, 0, c, s, 0, …) is the derivative of the chord's length, z / L with z = (s, -c, 0, -s, c, 0, …) that of its
angle; (c, s) is the chord's direction, displaced in the last case only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Chords:
    """Straight lines between the ends of n elements.

    Attributes
    ----------
    span : (n, 2) float
        From start to end, undeformed [m].
    """

    span: np.ndarray

    @property
    def length(self) -> np.ndarray:
        """Undeformed lengths, (n,) [m]."""
        return np.asarray(np.hypot(self.span[:, 0], self.span[:, 1]))

    def across(self, direction: np.ndarray) -> np.ndarray:
        """Vectors z for chords along ``direction`` (n, 2); (n, 8)."""
        c, s = direction.T
        nought = np.zeros_like(c)
        return np.stack([s, -c, nought, -s, c, nought, nought, nought], axis=-1)

    def along(self, direction: np.ndarray) -> np.ndarray:
        """Vectors r for chords along ``direction`` (n, 2); (n, 8)."""
        c, s = direction.T
        nought = np.zeros_like(c)
        return np.stack([-c, -s, nought, c, s, nought, nought, nought], axis=-1)

    def natural(self, d: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Natural deformations q (n, 5), T (n, 5, 8), r and z (n, 8) and chord lengths (n,) at d (n, 8)."""
        moved = d[:, 3:5] - d[:, 0:2]
        chord = self.span + moved
        length = np.hypot(chord[:, 0], chord[:, 1])
        # L - L₀ = (L² - L₀²) / (L + L₀) and the angle from its sine keep their digits where displacements are small.
        extension = np.sum(moved * (self.span + chord), axis=1) / (length + self.length)
        turn = np.arctan2(
            self.span[:, 0] * moved[:, 1] - self.span[:, 1] * moved[:, 0], np.sum(self.span * chord, axis=1)
        )
        bends = d[:, [2, 5]] - turn[:, None]
        bends = bends - 2.0 * np.pi * np.round(bends / (2.0 * np.pi))
        q = np.column_stack([extension, bends, d[:, 6:]])
        r, z = self.along(chord / length[:, None]), self.across(chord / length[:, None])
        t = np.zeros((len(d), 5, 8))
        t[:, 0] = r
        t[:, 1] = t[:, 2] = -z / length[:, None]
        t[:, 1, 2] += 1.0
        t[:, 2, 5] += 1.0
        t[:, 3, 6] = t[:, 4, 7] = 1.0
        return q, t, r, z, length


def p_delta_terms(
    chords: Chords, d: np.ndarray, axial_force: np.ndarray, axial_slope: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Forces N ψ z (n, 8) and their tangent (n, 8, 8), from mean axial forces N (n,) and ∂N/∂d (n, 8)."""
    length = chords.length
    z = chords.across(chords.span / length[:, None])
    psi = np.sum(z * d, axis=1) / length
    tangent = (axial_force / length)[:, None, None] * z[:, :, None] * z[:, None, :]
    tangent += psi[:, None, None] * z[:, :, None] * axial_slope[:, None, :]
    return (axial_force * psi)[:, None] * z, tangent


def corotational_tangent(forces: np.ndarray, r: np.ndarray, z: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Geometric stiffness (n, 8, 8) of natural forces ``forces`` (n, 5): N, M₁, M₂, …"""
    rz = r[:, :, None] * z[:, None, :]
    turning = (forces[:, 1] + forces[:, 2]) / length**2
    pulling = forces[:, 0] / length
    return np.asarray(
        pulling[:, None, None] * z[:, :, None] * z[:, None, :] + turning[:, None, None] * (rz + np.swapaxes(rz, 1, 2))
    )
