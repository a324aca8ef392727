"""A plane frame of fibre beam elements, meshed and integrated with scikit-fem.

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

from fem_reference.section_response import FibreSections
from scene import Scene

# Two-point Gauss–Radau rule on [0, 1], exact for quadratics (Abramowitz & Stegun, 25.4.31).
_RADAU_POINTS = np.array([0.0, 2.0 / 3.0])
_RADAU_WEIGHTS = np.array([0.25, 0.75])

_CLOSEST = 0.05
_SUPPORTED = {"free": (), "pinned": (0, 1), "clamped": (0, 1, 2)}


@dataclass(frozen=True)
class Frame:
    """A meshed frame; n elements, 2 quadrature points, 8 degrees of freedom an element.

    Attributes
    ----------
    strain_matrix : (n, 2, 3, 8) float
        (ε₀, κ, γ) from an element's global degrees of freedom.
    weights : (n, 2) float
        Quadrature weights [m].
    dofs : (n, 8) int
        Global degrees of freedom of an element: x, y, θ at both ends, axial bubble, γ.
    sections : FibreSections
    shear_stiffness : (n,) float
        GA_s [N].
    fixed : (k,) int
        Degrees of freedom that are zero.
    size : int
        Number of degrees of freedom.
    node_dofs : dict[str, ndarray]
        x, y, θ of each node of the scene.
    weight : (size,) float
        Consistent nodal loads of the members' own weight.
    """

    strain_matrix: np.ndarray
    weights: np.ndarray
    dofs: np.ndarray
    sections: FibreSections
    shear_stiffness: np.ndarray
    fixed: np.ndarray
    size: int
    node_dofs: dict[str, np.ndarray]
    weight: np.ndarray

    def respond(
        self, displacement: np.ndarray, plastic_strain: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Internal forces (size,), element tangents (n, 8, 8) and trial plastic strains at ``displacement`` (size,)."""
        b = self.strain_matrix
        strain = np.einsum("eqsi,ei->eqs", b, displacement[self.dofs])
        resultants, tangent, plastic = self.sections.respond(strain[..., 0], strain[..., 1], plastic_strain)
        stress = np.concatenate([resultants, self.shear_stiffness[:, None, None] * strain[..., 2:]], axis=-1)
        stiffness = np.zeros((*strain.shape, 3))
        stiffness[..., :2, :2] = tangent
        stiffness[..., 2, 2] = self.shear_stiffness[:, None]
        force = np.einsum("eqsi,eqs,eq->ei", b, stress, self.weights)
        weighted = stiffness * self.weights[..., None, None]
        matrices = np.matmul(np.swapaxes(b, -1, -2), np.matmul(weighted, b)).sum(axis=1)
        internal = np.bincount(self.dofs.ravel(), weights=force.ravel(), minlength=self.size)
        return internal, matrices, plastic

    def undeformed(self) -> np.ndarray:
        """Plastic strains of a virgin frame, (n, 2, fibres)."""
        return np.zeros((*self.weights.shape, self.sections.y.shape[-1]))


def build_frame(scene: Scene, elements: int, fibres: int) -> Frame:
    """Mesh every member of ``scene`` with ``elements`` elements and ``fibres`` fibres a section.

    Elements shrink towards a member's ends with the distance, for that is where hinges form.
    """
    ends = {name: np.arange(3) + 3 * i for i, name in enumerate(scene.nodes)}
    size = 3 * len(ends)
    parts: list[_MeshedMember] = []
    for name in scene.members:
        part = _mesh_member(scene, name, elements, ends, size)
        size = part.next_dof
        parts.append(part)
    sections = [scene.members[name].section.fibres(fibres) for name in scene.members]
    materials = [scene.members[name].material for name in scene.members]

    def each(values: list[float]) -> np.ndarray:
        return np.repeat(np.array(values), elements)[:, None, None]

    fixed = [ends[name][list(_SUPPORTED[node.support])] for name, node in scene.nodes.items()]
    fixed += [part.dofs[:, 7] for name, part in zip(scene.members, parts, strict=True) if _is_shear_rigid(scene, name)]
    weight = np.zeros(size)
    for part in parts:
        np.add.at(weight, part.dofs, part.weight)
    return Frame(
        strain_matrix=np.concatenate([part.strain_matrix for part in parts]),
        weights=np.concatenate([part.weights for part in parts]),
        dofs=np.concatenate([part.dofs for part in parts]),
        sections=FibreSections(
            y=np.repeat([s.y for s in sections], elements, axis=0)[:, None, :],
            area=np.repeat([s.area for s in sections], elements, axis=0)[:, None, :],
            youngs_modulus=each([m.youngs_modulus for m in materials]),
            yield_stress=each([m.yield_stress for m in materials]),
            tangent_modulus=each([m.tangent_modulus for m in materials]),
        ),
        shear_stiffness=each([scene.capacity(name).GA_s for name in scene.members]).ravel(),
        fixed=np.concatenate(fixed).astype(int),
        size=size,
        node_dofs=ends,
        weight=weight,
    )


@dataclass(frozen=True)
class _MeshedMember:
    strain_matrix: np.ndarray
    weights: np.ndarray
    dofs: np.ndarray
    weight: np.ndarray
    next_dof: int


def _is_shear_rigid(scene: Scene, name: str) -> bool:
    return scene.members[name].theory == "euler-bernoulli"


def _graded(elements: int) -> np.ndarray:
    """Mesh points on [0, 1], closer together towards both ends.

    Where they are closest they are still `_CLOSEST` of an even spacing apart: an element's forces go with the inverse
    cube of its length, and in a very short one rounding of the displacements drowns them.
    """
    t = np.linspace(0.0, 1.0, elements + 1)
    near = np.minimum(t, 1.0 - t)
    far = _CLOSEST * near + (1.0 - _CLOSEST) * 2.0 * near**2
    return np.where(t < 0.5, far, 1.0 - far)


def _mesh_member(scene: Scene, name: str, elements: int, ends: dict[str, np.ndarray], first: int) -> _MeshedMember:
    member = scene.members[name]
    c, s, length = scene.axis(name)
    mesh = MeshLine(length * _graded(elements))
    b = np.zeros((elements, 2, 3, 8))
    weights = np.zeros((elements, 2))
    halves = (np.arange(elements // 2), np.arange(elements // 2, elements))
    for part, points in zip(halves, (_RADAU_POINTS, 1.0 - _RADAU_POINTS), strict=True):
        bending = Basis(mesh, ElementLineHermite(), elements=part, quadrature=(points[None], _RADAU_WEIGHTS))
        axial = bending.with_element(ElementLineP2())
        for column, function in zip((0, 3, 6), axial.basis, strict=True):
            b[part, :, 0, column] = function[0].grad[0]
        for column, function in zip((1, 2, 4, 5), bending.basis, strict=True):
            b[part, :, 1, column] = function[0].hess[0, 0]
        weights[part] = bending.dx
    b[:, :, 1, 7] = -np.diff(mesh.p[0])[:, None] * b[:, :, 1, 4]
    b[:, :, 2, 7] = 1.0
    local = b.copy()
    for x in (0, 3):  # local u, w to global x, y: u = c X + s Y, w = -s X + c Y
        b[..., x] = c * local[..., x] - s * local[..., x + 1]
        b[..., x + 1] = s * local[..., x] + c * local[..., x + 1]

    inner = first + np.arange(3 * (elements - 1)).reshape(-1, 3)
    node = np.vstack([ends[member.start], inner, ends[member.end]])
    bubbles = first + inner.size + np.arange(elements)
    dofs = np.column_stack([node[:-1], node[1:], bubbles, bubbles + elements])

    load = -member.material.density * member.section.area * scene.gravity
    bending = Basis(mesh, ElementLineHermite())
    axial = bending.with_element(ElementLineP2())
    weight = np.zeros((elements, 8))
    for column, function in zip((0, 3, 6), axial.basis, strict=True):
        weight[:, column] = np.sum(load * s * function[0] * bending.dx, axis=1)
    for column, function in zip((1, 2, 4, 5), bending.basis, strict=True):
        weight[:, column] = np.sum(load * c * function[0] * bending.dx, axis=1)
    turned = weight.copy()
    for x in (0, 3):
        turned[:, x] = c * weight[:, x] - s * weight[:, x + 1]
        turned[:, x + 1] = s * weight[:, x] + c * weight[:, x + 1]
    return _MeshedMember(b, weights, dofs, turned, int(dofs.max()) + 1)
