"""A plane frame of fibre beam elements: its forces and stiffness at given displacements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_reference.kinematics import Chords, corotational_tangent, p_delta_terms
from fem_reference.member_mesh import MemberMesh
from fem_reference.section_response import FibreSections
from scene.model import Kinematics

# Local columns that the natural deformations of an element stand for: u at its end, both rotations, bubble and γ.
NATURAL = [3, 2, 5, 6, 7]


@dataclass(frozen=True)
class Response:
    """A frame at one displacement.

    Attributes
    ----------
    internal : (size,) float
        Forces that hold the frame there [N, N m].
    element_forces : (n, 8) float
        The part of each element in that, in global axes.
    matrices : (n, 8, 8) float
        Element tangents.
    strain, stress : (n, 2, 3) float
        (ε₀, κ, γ) and (N, M, Q) at the quadrature points.
    stored : (n, 2) float
        Energy that unloading would give back there [J/m].
    slip : (n, 2, f, l) float
        Slips of the fibres' layers, if this displacement is accepted.
    springs : (size,) float
        Stiffness of the springs and bearings that act there.
    """

    internal: np.ndarray
    element_forces: np.ndarray
    matrices: np.ndarray
    strain: np.ndarray
    stress: np.ndarray
    stored: np.ndarray
    slip: np.ndarray
    springs: np.ndarray


@dataclass(frozen=True)
class Frame:
    """A meshed frame; n elements, 2 quadrature points, 8 degrees of freedom an element.

    Attributes
    ----------
    strain_matrix : (n, 2, 3, 8) float
        (ε₀, κ, γ) from an element's global degrees of freedom; with large displacements (n, 2, 3, 5), from its natural
        deformations.
    weights : (n, 2) float
        Quadrature weights [m].
    dofs : (n, 8) int
        Global degrees of freedom of an element: x, y, θ at both ends, axial bubble, γ.
    chords : Chords
    kinematics : str
    sections : FibreSections
    springs, bearings : (size,) float
        Stiffness of the springs to the ground, and of those that only push, against negative displacements.
    fixed : (k,) int
        Degrees of freedom that are prescribed, …
    settlement : (k,) float
        … and their values when all dead loads are on.
    size : int
        Number of degrees of freedom.
    node_dofs : dict[str, ndarray]
        x, y, θ of each node of the scene.
    weight : (size,) float
        Consistent nodal loads of own weight and dead loads.
    element_weight, element_pattern : (n, 8) float
        The parts of dead and of proportional loads that are spread over elements.
    pattern : (size,) float
        Proportional loads, or the unit force of the push; step loads when the scene moves.
    meshes : dict[str, MemberMesh]
        By member, in the order of the elements.
    """

    strain_matrix: np.ndarray
    weights: np.ndarray
    dofs: np.ndarray
    chords: Chords
    kinematics: Kinematics
    sections: FibreSections
    springs: np.ndarray
    bearings: np.ndarray
    fixed: np.ndarray
    settlement: np.ndarray
    size: int
    node_dofs: dict[str, np.ndarray]
    weight: np.ndarray
    element_weight: np.ndarray
    element_pattern: np.ndarray
    pattern: np.ndarray
    meshes: dict[str, MemberMesh]

    def respond(self, displacement: np.ndarray, slip: np.ndarray) -> Response:
        """Forces, stiffness and slips at ``displacement`` (size,), from ``slip`` (n, 2, f, l)."""
        d = displacement[self.dofs]
        large = self.kinematics == "large"
        if large:
            q, t, r, z, length = self.chords.natural(d)
        strain, stress, stored, force, matrices, axial_slope, slip = self.sections.respond(
            q if large else d, self.strain_matrix, self.weights, slip
        )
        if large:
            matrices = np.swapaxes(t, 1, 2) @ matrices @ t + corotational_tangent(force, r, z, length)
            force = np.einsum("eni,en->ei", t, force)
        elif self.kinematics == "p-delta":
            whole = self.chords.length
            axial = np.sum(self.weights * stress[..., 0], axis=1) / whole
            extra, turning = p_delta_terms(self.chords, d, axial, axial_slope / whole[:, None])
            force, matrices = force + extra, matrices + turning
        internal = np.bincount(self.dofs.ravel(), weights=force.ravel(), minlength=self.size)
        springs = self._acting(displacement)
        internal += springs * displacement
        return Response(internal, force, matrices, strain, stress, stored, slip, springs)

    def _acting(self, displacement: np.ndarray) -> np.ndarray:
        return np.asarray(self.springs + np.where(displacement <= 0.0, self.bearings, 0.0))

    def spring_energy(self, displacement: np.ndarray) -> float:
        """Energy in springs and bearings [J]."""
        return 0.5 * float(self._acting(displacement) @ displacement**2)

    def dofs_of(self, axis: int) -> np.ndarray:
        """Degrees of freedom that displace along global x (0) or y (1)."""
        return self._along[axis]

    @cached_property
    def _along(self) -> tuple[np.ndarray, np.ndarray]:
        return np.unique(self.dofs[:, [0, 3]]), np.unique(self.dofs[:, [1, 4]])

    def undeformed(self) -> np.ndarray:
        """Slips of a virgin frame, (n, 2, fibres, layers)."""
        return self.sections.virgin(self.weights.shape[1])

    def largest_plastic_strain(self, response: Response) -> np.ndarray:
        """Of any fibre, by size, at each quadrature point, (n, 2) [-]."""
        return np.asarray(np.abs(self.sections.plastic_strain(response.strain, response.slip)).max(axis=-1))

    def elastic_energy(self, response: Response) -> float:
        """Energy that unloading would give back, without the springs' [J]."""
        return float(np.sum(self.weights * response.stored))

    def plastic_work(self, before: Response, after: Response) -> float:
        """What the stresses have worked in a step, by the trapezoidal rule, and is not stored [J]."""
        strained = np.sum((before.stress + after.stress) * (after.strain - before.strain), axis=-1)
        return float(np.sum(self.weights * (0.5 * strained - after.stored + before.stored)))
