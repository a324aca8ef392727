"""Masses of a frame, and its natural frequencies.

The consistent mass of an element follows from the functions that interpolate its displacements (J. S. Archer,
Consistent mass matrix for distributed mass systems, J. Struct. Div. ASCE 89, 1963):

    m = ∫ ρ A (N_uᵀ N_u + N_wᵀ N_w) dx

integrated with scikit-fem; in a Timoshenko member also the rotatory inertia ∫ ρ I φ² dx of its sections (S. P.
Timoshenko, On the correction for shear of the differential equation for transverse vibrations of prismatic bars, Phil.
Mag. 41, 1921), whose rotation φ is taken as linear between the nodes. Frequencies ω solve K φ = ω² M φ; those of
Hermite elements fall to the exact ones with h⁴.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh
from skfem import Basis, ElementLineHermite, ElementLineP1, MeshLine

from fem_reference.frame import Frame
from fem_reference.frame_mesh import build_frame
from fem_reference.member_mesh import AXIAL, TRANSVERSE, LinearWithBubble, turned
from scene import Scene

_COARSEST = 20
# Shares of ω² ~ Σ K / Σ M: where modes are looked for from, and what is a movement without deformation.
_BELOW, _RIGID = 1e-9, 1e-14
# Columns of an element's degrees of freedom that are rotations of its ends.
_TURNS = (2, 5)


@dataclass(frozen=True)
class Masses:
    """Masses of a frame.

    Attributes
    ----------
    matrices : (n, 8, 8) float
        Consistent masses of the elements, in global axes.
    nodal : (size,) float
        Masses of the bodies fixed to nodes [kg].
    """

    matrices: np.ndarray
    nodal: np.ndarray

    def momentum(self, frame: Frame, velocity: np.ndarray) -> np.ndarray:
        """M v of the members and bodies, (size,)."""
        parts = np.einsum("eij,ej->ei", self.matrices, velocity[frame.dofs])
        return np.asarray(
            np.bincount(frame.dofs.ravel(), weights=parts.ravel(), minlength=frame.size) + self.nodal * velocity
        )


def masses(scene: Scene, frame: Frame) -> Masses:
    """Masses of ``scene``'s members and bodies on the mesh of ``frame``."""
    parts = []
    for name, mesh in frame.meshes.items():
        c, s, _ = scene.axis(name)
        member = scene.members[name]
        line = MeshLine(mesh.points)
        bending = Basis(line, ElementLineHermite(), intorder=6)
        # With large displacements the axial bubble is measured from the displaced chord, and has no mass of its own.
        large = frame.kinematics == "large"
        axial = bending.with_element(ElementLineP1() if large else LinearWithBubble())
        count = len(mesh.points) - 1
        matrix = np.zeros((count, 8, 8))
        for basis, columns in ((axial, AXIAL[: axial.Nbfun]), (bending, TRANSVERSE)):
            values = [np.broadcast_to(function[0], basis.dx.shape) for function in basis.basis]
            for i, a in zip(columns, values, strict=True):
                for j, b in zip(columns, values, strict=True):
                    matrix[:, i, j] = np.sum(a * b * basis.dx, axis=1)
        matrix *= member.mass_per_length
        if member.theory == "timoshenko":
            inertia = member.material.density * member.section.second_moment_of_area
            matrix[np.ix_(range(count), _TURNS, _TURNS)] += (
                inertia * np.diff(mesh.points)[:, None, None] / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
            )
        half = turned(matrix, c, s)
        parts.append(turned(np.swapaxes(half, 1, 2), c, s))
    nodal = np.zeros(frame.size)
    for name, node in scene.nodes.items():
        nodal[frame.node_dofs[name][:2]] = node.mass
    return Masses(np.concatenate(parts), nodal)


@dataclass(frozen=True)
class Modes:
    """Natural frequencies of small vibrations about the undeformed state.

    Attributes
    ----------
    frequency : (k,) float
        From the lowest [Hz]; 0 where nothing holds the frame.
    error_estimate : (k,) float
        Difference from those of half as many elements, as a share [-].
    shape : (k, size) float
        Displacements of all degrees of freedom, largest component 1.
    bending : (k,) float
        Share of the movement that is across the members: near 1 in bending, near 0 in stretching [-].
    frame : Frame
        Whose degrees of freedom these are.
    """

    frequency: np.ndarray
    error_estimate: np.ndarray
    shape: np.ndarray
    bending: np.ndarray
    frame: Frame


def natural_modes(scene: Scene, count: int = 3, elements: int = 2 * _COARSEST) -> Modes:
    """The lowest ``count`` natural modes, from meshes of ``elements`` and of half as many elements a member."""
    coarse = _modes(scene, count, elements // 2)[0]
    fine, shape, frame = _modes(scene, count, elements)
    across = frame.chords.across(frame.chords.span / frame.chords.length[:, None])[:, 3:5]
    moved = shape[:, frame.dofs[:, 3:5]]
    bending = np.sum(np.sum(moved * across, axis=2) ** 2, axis=1) / np.sum(moved**2, axis=(1, 2))
    error = np.abs(fine - coarse) / np.where(fine > 0.0, fine, 1.0)
    return Modes(fine, error, shape, bending, frame)


def _modes(scene: Scene, count: int, elements: int) -> tuple[np.ndarray, np.ndarray, Frame]:
    frame = build_frame(scene, elements, 8)
    mass = masses(scene, frame)
    stiffness = frame.respond(np.zeros(frame.size), frame.undeformed()).matrices
    free = np.setdiff1d(np.arange(frame.size), frame.fixed)

    def assembled(parts: np.ndarray, diagonal: np.ndarray) -> sparse.csc_matrix:
        rows, columns = np.repeat(frame.dofs, 8, axis=1).ravel(), np.tile(frame.dofs, (1, 8)).ravel()
        whole = sparse.coo_matrix((parts.ravel(), (rows, columns)), shape=(frame.size,) * 2).tocsr()
        return (whole + sparse.diags(diagonal))[free][:, free].tocsc()

    stiff, inert = assembled(stiffness, frame.springs), assembled(mass.matrices, mass.nodal)
    scale = stiff.diagonal().sum() / inert.diagonal().sum()
    # Looked for from below 0, where there is a factor also if nothing holds the frame.
    squares, vectors = eigsh(stiff, k=count, M=inert, sigma=-_BELOW * scale, v0=np.ones(free.size))
    order = np.argsort(squares)
    squares = np.where(squares < _RIGID * scale, 0.0, squares)
    shape = np.zeros((count, frame.size))
    shape[:, free] = (vectors / np.abs(vectors).max(axis=0)).T[order]
    return np.sqrt(squares[order]) / (2.0 * np.pi), shape, frame
