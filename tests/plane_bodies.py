"""Plane bodies for tests: meshes, and bodies held and pushed by their edges."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from capacity import Material, parse_material
from fem_reference.plane.beam_mesh import tensor_mesh
from fem_reference.plane.boundary import boundary
from fem_reference.plane.continuum import Continuum
from fem_reference.plane.equilibrium import Body
from fem_reference.plane.j2 import J2, Hardening
from fem_reference.plane.mesh import PlaneMesh

STEEL = parse_material("fy=235 MPa, E=210 GPa, rho=7850 kg/m^3")
#: Two triangles of 6 nodes in a quadrilateral of 9.
HALVES = ((0, 1, 2, 4, 5, 8), (0, 2, 3, 8, 6, 7))


def free_continuum(mesh: PlaneMesh, material: Material = STEEL, thickness: float = 0.05) -> Continuum:
    """A continuum on which nothing is held: two degrees of freedom a node, along x and y."""
    count = len(mesh.points)
    law = J2.of([material], mesh.group)
    return Continuum(mesh, thickness, law, np.arange(2 * count).reshape(count, 2), np.tile(np.eye(2), (count, 1, 1)))


def held_body(
    mesh: PlaneMesh,
    root: str = "clamped",
    material: Material = STEEL,
    hardening: Hardening = "kinematic",
    direction: tuple[float, float] = (0.0, -1.0),
    thickness: float = 0.05,
) -> Body:
    """A body held at its left edge and pushed at its right."""
    edges = boundary(mesh, {"left": root}, "right", direction, "test")
    continuum = Continuum(mesh, thickness, J2.of([material], mesh.group, hardening), edges.dofs, edges.axes)
    return Body(continuum, edges, np.zeros(continuum.size))


def square(cells: int, kind: str, skew: float = 0.0, bend: float = 0.0) -> PlaneMesh:
    """The unit square in ``cells`` × ``cells`` quadrilaterals or twice as many triangles, skewed and bent inside."""
    places = np.linspace(0.0, 1.0, cells + 1)
    mesh = tensor_mesh(places, places)
    corners = np.unique(mesh.cells[:, :4])
    x, y = mesh.points.T
    bump = np.sin(np.pi * x) * np.sin(np.pi * y)
    moved = mesh.points + skew * bump[:, None] * np.array([1.0, -0.6])
    if not bend:  # straight sides between the moved corners
        straight = moved.copy()
        for a, m, b in ((0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0)):
            straight[mesh.cells[:, m]] = 0.5 * (moved[mesh.cells[:, a]] + moved[mesh.cells[:, b]])
        straight[mesh.cells[:, 8]] = moved[mesh.cells[:, :4]].mean(axis=1)
        moved = straight
    else:
        inside = (bump > 1e-9) & ~np.isin(np.arange(len(x)), corners)
        moved[inside] += bend * np.cos(7.0 * moved[inside, ::-1]) / cells
    cut = mesh.cells if kind == "quadrilaterals" else np.concatenate([mesh.cells[:, half] for half in HALVES])
    return PlaneMesh(moved, cut, {}, np.zeros(len(cut), dtype=int)).with_sides()


def solved_elastically(continuum: Continuum, prescribed: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Elastic displacements (size,) with those of ``prescribed`` given."""
    k = continuum.dofs.shape[1]
    rows, columns = np.repeat(continuum.dofs, k, axis=1).ravel(), np.tile(continuum.dofs, (1, k)).ravel()
    matrix = coo_matrix((continuum.elastic.ravel(), (rows, columns)), shape=(continuum.size,) * 2).tocsr()
    d = np.zeros(continuum.size)
    d[prescribed] = value
    free = np.setdiff1d(np.arange(continuum.size), prescribed)
    d[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ d)[free])
    return d
