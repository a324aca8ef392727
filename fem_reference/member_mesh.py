"""One member of a frame as fibre beam elements, meshed and integrated with scikit-fem.

Along a member, with local displacements u (axial, quadratic with a bubble), w (transverse, cubic Hermite) and, for a
Timoshenko member, one shear strain γ an element:

    ε₀ = u',   κ = w'' - L_e γ ψ'',   γ,

where ψ is the Hermite function of w at the element's end: the bending part of w is w less the shear part γ x. Each
element then bears a constant N and Q and a linear M exactly. Two Radau points integrate it, exactly while it is
elastic; the one that is an end of the element faces the nearer end of the member, so that a hinge at a member's end
forms where it is and not a fraction of an element further in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Basis, ElementLineHermite, ElementLineP2, MeshLine

# Two-point Gauss–Radau rule on [0, 1], exact for quadratics (Abramowitz & Stegun, 25.4.31).
_RADAU_POINTS = np.array([0.0, 2.0 / 3.0])
_RADAU_WEIGHTS = np.array([0.25, 0.75])

_CLOSEST = 0.05

# Columns of an element's degrees of freedom (x, y, θ; x, y, θ; bubble; γ) that belong to u and to w.
AXIAL, TRANSVERSE, SHEAR = (0, 3, 6), (1, 2, 4, 5), 7


class LinearWithBubble(ElementLineP2):  # type: ignore[misc]
    """Quadratic functions by their values at the ends and what the middle has beyond the straight line between them.

    The bubble is then no part of a movement as a whole: with large displacements it is counted from the displaced
    chord, and loads along the member must come to its ends in full.
    """

    def lbasis(self, X: np.ndarray, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Function i and its slope at the points ``X``."""
        value, slope = super().lbasis(X, i)
        if i == 2:
            return value, slope
        middle, slope_of_middle = super().lbasis(X, 2)
        return value + 0.5 * middle, slope + 0.5 * slope_of_middle


@dataclass(frozen=True)
class MemberMesh:
    """A straight member of m elements in its own axes.

    Attributes
    ----------
    strain_matrix : (m, 2, 3, 8) float
        (ε₀, κ, γ) from an element's local degrees of freedom.
    weights : (m, 2) float
        Quadrature weights [m].
    stations : (m, 2) float
        Quadrature points, from the member's start [m].
    points : (m + 1,) float
        Element ends, from the member's start [m].
    """

    strain_matrix: np.ndarray
    weights: np.ndarray
    stations: np.ndarray
    points: np.ndarray

    def spread(self, along: float, across: float) -> np.ndarray:
        """Consistent local nodal loads (m, 8) of even loads ``along`` and ``across`` the member [N/m]."""
        mesh = MeshLine(self.points)
        bending = Basis(mesh, ElementLineHermite())
        axial = bending.with_element(LinearWithBubble())
        loads = np.zeros((len(self.points) - 1, 8))
        for column, function in zip(AXIAL, axial.basis, strict=True):
            loads[:, column] = np.sum(along * function[0] * axial.dx, axis=1)
        for column, function in zip(TRANSVERSE, bending.basis, strict=True):
            loads[:, column] = np.sum(across * function[0] * bending.dx, axis=1)
        return loads


def mesh_member(length: float, elements: int) -> MemberMesh:
    """Mesh a member of ``length`` [m] with ``elements`` elements, which shrink towards its ends."""
    mesh = MeshLine(length * _graded(elements))
    b = np.zeros((elements, 2, 3, 8))
    weights = np.zeros((elements, 2))
    stations = np.zeros((elements, 2))
    halves = (np.arange(elements // 2), np.arange(elements // 2, elements))
    for part, points in zip(halves, (_RADAU_POINTS, 1.0 - _RADAU_POINTS), strict=True):
        bending = Basis(mesh, ElementLineHermite(), elements=part, quadrature=(points[None], _RADAU_WEIGHTS))
        axial = bending.with_element(LinearWithBubble())
        for column, function in zip(AXIAL, axial.basis, strict=True):
            b[part, :, 0, column] = function[0].grad[0]
        for column, function in zip(TRANSVERSE, bending.basis, strict=True):
            b[part, :, 1, column] = function[0].hess[0, 0]
        weights[part] = bending.dx
        stations[part] = bending.global_coordinates()[0]
    b[:, :, 1, SHEAR] = -np.diff(mesh.p[0])[:, None] * b[:, :, 1, TRANSVERSE[2]]
    b[:, :, 2, SHEAR] = 1.0
    return MemberMesh(b, weights, stations, mesh.p[0])


def turned(rows: np.ndarray, c: float, s: float) -> np.ndarray:
    """Rows (…, 8) over local u, w as rows over global x, y: u = c X + s Y, w = -s X + c Y."""
    out = rows.copy()
    for x in (0, 3):
        out[..., x] = c * rows[..., x] - s * rows[..., x + 1]
        out[..., x + 1] = s * rows[..., x] + c * rows[..., x + 1]
    return out


def _graded(elements: int) -> np.ndarray:
    """Mesh points on [0, 1], closer together towards both ends.

    Where they are closest they are still `_CLOSEST` of an even spacing apart: an element's forces go with the inverse
    cube of its length, and in a very short one rounding of the displacements drowns them.
    """
    t = np.linspace(0.0, 1.0, elements + 1)
    near = np.minimum(t, 1.0 - t)
    far = _CLOSEST * near + (1.0 - _CLOSEST) * 2.0 * near**2
    return np.where(t < 0.5, far, 1.0 - far)
