"""A plane body of quadratic elements: strains from displacements, forces and tangent from stresses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_reference.plane.j2 import J2, MODES
from fem_reference.plane.mesh import PlaneMesh, quadrature, shape_functions


@dataclass(frozen=True)
class State:
    """A body at rest in a deformed shape; n elements of q points, strains and stresses in the modes of `j2`.

    Attributes
    ----------
    displacement : (size,) float
        By degree of freedom [m].
    internal : (size,) float
        Forces that the stresses pull on the degrees of freedom with [N].
    matrices : (n, k, k) float
        Consistent tangent of each element [N/m].
    strain, stress, plastic_strain : (n, q, 3) float
        ε [-], σ [Pa], εp [-].
    accumulated : (n, q) float
        Equivalent plastic strain [-].
    """

    displacement: np.ndarray
    internal: np.ndarray
    matrices: np.ndarray
    strain: np.ndarray
    stress: np.ndarray
    plastic_strain: np.ndarray
    accumulated: np.ndarray


class Continuum:
    """Elements with their strain matrices; small displacements.

    Parameters
    ----------
    mesh : PlaneMesh
    thickness : float
        [m].
    law : J2
    dofs : (nodes, 2) int
        Degrees of freedom of each node; nodes that move together share one.
    axes : (nodes, 2, 2) float
        Rows are the directions of each node's two degrees of freedom.

    Raises
    ------
    ValueError
        When an element folds; the message gives its number.
    """

    def __init__(self, mesh: PlaneMesh, thickness: float, law: J2, dofs: np.ndarray, axes: np.ndarray) -> None:
        gradients, area = mesh.shape_gradients()
        n, q, k, _ = gradients.shape
        self.mesh, self.law, self.thickness = mesh, law, thickness
        self.node_dofs, self.axes = dofs, axes
        self.dofs = dofs[mesh.cells].reshape(n, 2 * k)
        self.size = int(dofs.max()) + 1
        #: Volume that each quadrature point stands for [m³].
        self.volume = area * thickness
        # ε11, ε22 and engineering ε12 of each node's displacements, turned to modes and to the nodes' own axes.
        cartesian = np.zeros((n, q, 3, k, 2))
        cartesian[:, :, 0, :, 0] = cartesian[:, :, 2, :, 1] = gradients[..., 0]
        cartesian[:, :, 1, :, 1] = cartesian[:, :, 2, :, 0] = gradients[..., 1]
        modes = np.einsum("ab,nqbkd->nqakd", MODES, cartesian)
        if not np.array_equal(axes, np.broadcast_to(np.eye(2), axes.shape)):
            modes = np.einsum("nqakd,nked->nqake", modes, axes[mesh.cells])
        self._strain = modes.reshape(n, q * 3, 2 * k)
        self._weighted = np.ascontiguousarray(
            (self._strain * np.repeat(self.volume, 3, axis=1)[..., None]).swapaxes(1, 2)
        )
        #: Elastic stiffness of each element, (n, k, k) [N/m].
        self.elastic: np.ndarray = self._weighted @ (np.tile(law.stiffness[:, 0], q)[..., None] * self._strain)

    def undeformed(self) -> State:
        """The virgin body."""
        n, q = self.volume.shape
        none = np.zeros((n, q, 3))
        at_rest = np.zeros(self.size)
        return State(at_rest, at_rest, self.elastic, none, none, none, np.zeros((n, q)))

    def respond(self, displacement: np.ndarray, before: State) -> State:
        """The body at ``displacement`` (size,), after the converged state ``before``.

        Raises
        ------
        ArithmeticError
            When a strain is not finite.
        """
        n, q = self.volume.shape
        strain = (self._strain @ displacement[self.dofs][..., None]).reshape(n, q, 3)
        found = self.law.respond(strain, before.plastic_strain, before.accumulated)
        force = (self._weighted @ found.stress.reshape(n, q * 3, 1))[..., 0]
        return State(
            displacement,
            self.gather(force),
            self._tangents(found.flows, found.tangent),
            strain,
            found.stress,
            found.plastic_strain,
            found.accumulated,
        )

    def _tangents(self, flows: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """Element matrices; only elements with a point that flows are formed anew."""
        where = np.flatnonzero(flows.any(axis=1))
        if not len(where):
            return self.elastic
        q = flows.shape[1]
        moduli = np.zeros((len(where), q, 3, 3))
        moduli[..., range(3), range(3)] = self.law.stiffness[where]
        moduli[flows[where]] = tangent
        strain = self._strain[where].reshape(len(where), q, 3, -1)
        matrices = self.elastic.copy()
        matrices[where] = self._weighted[where] @ (moduli @ strain).reshape(len(where), q * 3, -1)
        return matrices

    def gather(self, forces: np.ndarray) -> np.ndarray:
        """Sum of element ``forces`` (n, k) by degree of freedom, (size,) [N]."""
        return np.asarray(np.bincount(self.dofs.ravel(), weights=forces.ravel(), minlength=self.size))

    @cached_property
    def shape_values(self) -> np.ndarray:
        """Shape functions at the quadrature points, (q, nodes)."""
        nodes = self.mesh.cells.shape[1]
        values, _ = shape_functions(nodes, quadrature(nodes)[0])
        return values

    def body_force(self, force: np.ndarray) -> np.ndarray:
        """Consistent loads of a ``force`` per volume, (n, 2) by element [N/m³]."""
        nodal = np.einsum("nq,qk,nd->nkd", self.volume, self.shape_values, force)
        return self.gather(np.einsum("nkd,nked->nke", nodal, self.axes[self.mesh.cells]).reshape(len(nodal), -1))

    def nodal_displacement(self, displacement: np.ndarray) -> np.ndarray:
        """Displacements x, y of all nodes, (nodes, 2) [m]."""
        return np.asarray(np.einsum("ke,ked->kd", displacement[self.node_dofs], self.axes))

    def elastic_energy(self, state: State) -> float:
        """½ ∫ σ·(ε - εp) dV [J]."""
        return 0.5 * float(np.einsum("nq,nqi,nqi->", self.volume, state.stress, state.strain - state.plastic_strain))

    def plastic_work(self, before: State, after: State) -> float:
        """∫ σ·Δεp dV of a step by the trapezoidal rule [J]."""
        mean = 0.5 * (before.stress + after.stress)
        return float(np.einsum("nq,nqi,nqi->", self.volume, mean, after.plastic_strain - before.plastic_strain))
