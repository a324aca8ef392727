"""Plane meshes of quadratic elements: triangles with 6 nodes or quadrilaterals with 9, sides straight or curved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from skfem import ElementQuad2, ElementTriP2
from skfem.quadrature import get_quadrature

#: Start, middle and end of each side, in an element's own numbering, by its number of nodes.
SIDES = {6: ((0, 3, 1), (1, 4, 2), (2, 5, 0)), 9: ((0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0))}
#: Nodes on a lattice that is four steps wide.
_LATTICE = {
    6: ((0, 0), (4, 0), (0, 4), (2, 0), (2, 2), (0, 2)),
    9: ((0, 0), (4, 0), (4, 4), (0, 4), (2, 0), (4, 2), (2, 4), (0, 2), (2, 2)),
}
#: The nodes of each of the four elements that one is divided into, on the same lattice.
_CHILDREN = {
    6: (
        *(tuple((x + i // 2, y + j // 2) for i, j in _LATTICE[6]) for x, y in ((0, 0), (2, 0), (0, 2))),
        ((2, 0), (2, 2), (0, 2), (2, 1), (1, 2), (1, 1)),
    ),
    9: tuple(tuple((x + i // 2, y + j // 2) for i, j in _LATTICE[9]) for x, y in ((0, 0), (2, 0), (2, 2), (0, 2))),
}
#: Polynomial degree that is integrated exactly: 3 × 3 points in quadrilaterals, 6 in triangles.
_DEGREE = {6: 4, 9: 5}


@dataclass(frozen=True)
class PlaneMesh:
    """A mesh of one kind of element.

    Attributes
    ----------
    points : (n, 2) float
        Nodes [m].
    cells : (m, 6) or (m, 9) int
        Corners, then middles of sides, then the centre of a quadrilateral, in the order of VTK.
    edges : dict[str, (k, 3) int]
        Named parts of the boundary: start, middle and end of each element side.
    group : (m,) int
        Number of each element's material.
    """

    points: np.ndarray
    cells: np.ndarray
    edges: dict[str, np.ndarray]
    group: np.ndarray

    @cached_property
    def boundary(self) -> np.ndarray:
        """All element sides with an element on one side only, (k, 3)."""
        sides = np.concatenate([self.cells[:, side] for side in SIDES[self.cells.shape[1]]])
        _, first, count = np.unique(sides[:, 1], return_index=True, return_counts=True)
        return np.asarray(sides[first[count == 1]])

    def with_sides(self) -> PlaneMesh:
        """The same mesh with the sides of its bounding box, as far as they have boundary on them, named too.

        Their names are "left", "right", "bottom" and "top"; names that are there already stay.
        """
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        near = 1e-6 * float(np.max(high - low))
        sides = self.boundary
        edges = dict(self.edges)
        for name, axis, at in (("left", 0, low), ("right", 0, high), ("bottom", 1, low), ("top", 1, high)):
            found = sides[(np.abs(self.points[sides, axis] - at[axis]) <= near).all(axis=1)]
            if len(found):
                edges.setdefault(name, found)
        return PlaneMesh(self.points, self.cells, edges, self.group)

    def shape_gradients(self) -> tuple[np.ndarray, np.ndarray]:
        """∂N/∂(x, y) at the quadrature points, (m, q, nodes, 2) [1/m], and the areas that these stand for, (m, q) [m²].

        Raises
        ------
        ValueError
            When the sides of an element are bent so far that it folds; the message gives its number.
        """
        nodes = self.cells.shape[1]
        local, weight = quadrature(nodes)
        slopes = shape_functions(nodes, local)[1]
        corners = self.points[self.cells]
        jacobian = np.einsum("qad,mai->mqid", slopes, corners)
        size = jacobian[..., 0, 0] * jacobian[..., 1, 1] - jacobian[..., 0, 1] * jacobian[..., 1, 0]
        if (size <= 0.0).any():
            raise ValueError(str(int(np.argmax((size <= 0.0).any(axis=1)))))
        gradients = np.einsum("qad,mqdi->mqai", slopes, np.linalg.inv(jacobian))
        return gradients, size * weight

    def refined(self) -> PlaneMesh:
        """Every element divided into four on its own, perhaps curved, sides."""
        nodes = self.cells.shape[1]
        lattice = sorted({place for child in _CHILDREN[nodes] for place in child})
        values = shape_functions(nodes, np.array(lattice).T / 4.0)[0]
        numbers = np.full((len(self.cells), len(lattice)), -1)
        for node, place in enumerate(_LATTICE[nodes]):
            numbers[:, lattice.index(place)] = self.cells[:, node]
        # Points at a quarter of a side are known by the corner and the middle that they lie between.
        halves, places = [], []
        for a, m, b in SIDES[nodes]:
            for corner in (a, b):
                (x0, y0), (x1, y1) = _LATTICE[nodes][corner], _LATTICE[nodes][m]
                places.append(lattice.index(((x0 + x1) // 2, (y0 + y1) // 2)))
                halves.append(np.sort(self.cells[:, [corner, m]], axis=1))
        pairs, which = np.unique(np.concatenate(halves), axis=0, return_inverse=True)
        count = len(self.points)
        numbers[:, places] = count + which.reshape(len(places), -1).T
        count += len(pairs)
        inside = numbers < 0
        numbers[inside] = count + np.arange(inside.sum())
        points = np.zeros((count + inside.sum(), 2))
        points[numbers.ravel()] = np.einsum("qa,mai->mqi", values, self.points[self.cells]).reshape(-1, 2)
        children = [numbers[:, [lattice.index(place) for place in child]] for child in _CHILDREN[nodes]]
        quarter = {(int(a), int(b)): len(self.points) + i for i, (a, b) in enumerate(pairs)}
        edges = {
            name: np.array(
                [
                    part
                    for a, m, b in sides.tolist()
                    for part in (
                        (a, quarter[min(a, m), max(a, m)], m),
                        (m, quarter[min(b, m), max(b, m)], b),
                    )
                ]
            ).reshape(-1, 3)
            for name, sides in self.edges.items()
        }
        return PlaneMesh(points, np.concatenate(children), edges, np.tile(self.group, len(children)))


def quadrature(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Quadrature points (2, q) and weights (q,) of the element with so many nodes."""
    local, weight = get_quadrature(_element(nodes), _DEGREE[nodes])
    return local, weight


def shape_functions(nodes: int, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions (q, nodes) and their slopes (q, nodes, 2) at local coordinates (2, q)."""
    element = _element(nodes)
    pairs = [element.lbasis(local, i) for i in range(nodes)]
    values = np.stack([np.broadcast_to(value, local.shape[1:]) for value, _ in pairs], axis=1)
    slopes = np.stack([np.stack(np.broadcast_arrays(*slope)).T for _, slope in pairs], axis=1)
    return values, slopes


def _element(nodes: int) -> ElementTriP2 | ElementQuad2:
    return ElementTriP2() if nodes == 6 else ElementQuad2()


def nearest_points(nodes: int) -> np.ndarray:
    """Number of the quadrature point that is nearest to each node of an element, (nodes,)."""
    places = np.array(_LATTICE[nodes]) / 4.0
    local, _ = quadrature(nodes)
    return np.asarray(np.argmin(np.linalg.norm(places[:, None, :] - local.T[None], axis=2), axis=1))
