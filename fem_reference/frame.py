"""A plane frame of fibre beam elements: its forces and stiffness at given displacements."""

from __future__ import annotations

from dataclasses import dataclass

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
    plastic_strain : (n, 2, f) float
        Plastic strains, if this displacement is accepted.
    """

    internal: np.ndarray
    element_forces: np.ndarray
    matrices: np.ndarray
    strain: np.ndarray
    stress: np.ndarray
    plastic_strain: np.ndarray


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
    shear_stiffness : (n,) float
        GA_s [N].
    springs : (size,) float
        Stiffness of the springs to the ground.
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
    shear_stiffness: np.ndarray
    springs: np.ndarray
    fixed: np.ndarray
    settlement: np.ndarray
    size: int
    node_dofs: dict[str, np.ndarray]
    weight: np.ndarray
    element_weight: np.ndarray
    element_pattern: np.ndarray
    pattern: np.ndarray
    meshes: dict[str, MemberMesh]

    def respond(self, displacement: np.ndarray, plastic_strain: np.ndarray) -> Response:
        """Forces, stiffness and plastic strains at ``displacement`` (size,), from ``plastic_strain`` (n, 2, f)."""
        d = displacement[self.dofs]
        b = self.strain_matrix
        large = self.kinematics == "large"
        if large:
            q, t, r, z, length = self.chords.natural(d)
        strain = np.einsum("eqsi,ei->eqs", b, q if large else d)
        resultants, tangent, plastic = self.sections.respond(strain[..., 0], strain[..., 1], plastic_strain)
        stress = np.concatenate([resultants, self.shear_stiffness[:, None, None] * strain[..., 2:]], axis=-1)
        stiffness = np.zeros((*strain.shape, 3))
        stiffness[..., :2, :2] = tangent
        stiffness[..., 2, 2] = self.shear_stiffness[:, None]
        force = np.einsum("eqsi,eqs,eq->ei", b, stress, self.weights)
        weighted = np.matmul(stiffness * self.weights[..., None, None], b)
        matrices = np.matmul(np.swapaxes(b, -1, -2), weighted).sum(axis=1)
        if large:
            matrices = np.swapaxes(t, 1, 2) @ matrices @ t + corotational_tangent(force, r, z, length)
            force = np.einsum("eni,en->ei", t, force)
        elif self.kinematics == "p-delta":
            whole = self.chords.length
            axial = np.sum(self.weights * stress[..., 0], axis=1) / whole
            extra, turning = p_delta_terms(self.chords, d, axial, weighted[:, :, 0].sum(axis=1) / whole[:, None])
            force, matrices = force + extra, matrices + turning
        internal = np.bincount(self.dofs.ravel(), weights=force.ravel(), minlength=self.size)
        internal += self.springs * displacement
        return Response(internal, force, matrices, strain, stress, plastic)

    def dofs_of(self, axis: int) -> np.ndarray:
        """Degrees of freedom that displace along global x (0) or y (1)."""
        return np.unique(self.dofs[:, [axis, axis + 3]])

    def undeformed(self) -> np.ndarray:
        """Plastic strains of a virgin frame, (n, 2, fibres)."""
        return np.zeros((*self.weights.shape, self.sections.y.shape[-1]))

    def elastic_energy(self, response: Response) -> float:
        """Energy that unloading would give back, without the springs' [J]: ∫ σ² / 2E dV + ∫ γ² GA_s / 2 dx."""
        s = self.sections
        strain = response.strain[..., :1] - s.y * response.strain[..., 1:2] - response.plastic_strain
        fibres = 0.5 * np.sum(s.youngs_modulus * s.area * strain**2, axis=-1)
        shear = 0.5 * self.shear_stiffness[:, None] * response.strain[..., 2] ** 2
        return float(np.sum(self.weights * (fibres + shear)))

    def plastic_work(self, before: Response, after: Response) -> float:
        """Work of the fibre stresses on the plastic strains of a step, by the trapezoidal rule [J]."""
        s = self.sections
        flow = after.plastic_strain - before.plastic_strain
        mean = 0.5 * (before.strain + after.strain)
        elastic = mean[..., :1] - s.y * mean[..., 1:2] - 0.5 * (before.plastic_strain + after.plastic_strain)
        return float(np.sum(self.weights * np.sum(s.youngs_modulus * s.area * elastic * flow, axis=-1)))
