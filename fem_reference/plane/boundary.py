"""What holds, pushes and loads the edges of a plane body.

A pushed edge moves as one along the push and is free across it. A held edge is

    clamped             u = v = 0;
    contraction-free    along its normal u = 0; along itself only the mean is held, weighted with 1 - (2 y / h)², the
                        shear of an elastic beam of rectangular section: the edge may grow thinner;
    roller-x, roller-y  free to move along x, or y, alone.

Means are held by rows r with r · d = 0, so that their reactions are spread as the weights are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from capacity import InputError
from fem_reference.plane.mesh import PlaneMesh

_HOLDS = {"clamped": (True, True), "roller-x": (False, True), "roller-y": (True, False)}
#: Gauss points on (0, 1): exact for the square of a quadratic shape function.
_GAUSS, _WEIGHT = (0.5 + 0.5 * np.polynomial.legendre.leggauss(3)[0], 0.5 * np.polynomial.legendre.leggauss(3)[1])
_SHAPES = np.stack([(1 - _GAUSS) * (1 - 2 * _GAUSS), 4 * _GAUSS * (1 - _GAUSS), _GAUSS * (2 * _GAUSS - 1)], axis=1)
_SLOPES = np.stack([4 * _GAUSS - 3, 4 - 8 * _GAUSS, 4 * _GAUSS - 1], axis=1)


@dataclass(frozen=True)
class Boundary:
    """Degrees of freedom of a mesh with what is done to its edges.

    Attributes
    ----------
    dofs : (nodes, 2) int
        By node; on the pushed edge, the second is the same for all.
    axes : (nodes, 2, 2) float
        Rows are the directions of the two; on the pushed edge, the second is that of the push.
    fixed : (k,) int
        Degrees of freedom that are held at zero.
    rows : (m, size) float
        Held means.
    control : int
        The pushed edge's degree of freedom.
    position, directions : (size, 2) float
        Where each degree of freedom is [m], and along which unit vector.
    """

    dofs: np.ndarray
    axes: np.ndarray
    fixed: np.ndarray
    rows: np.ndarray
    control: int
    position: np.ndarray
    directions: np.ndarray


def boundary(
    mesh: PlaneMesh,
    supports: Mapping[str, str],
    pushed: str,
    direction: tuple[float, float],
    place: str,
    *,
    half: bool = False,
) -> Boundary:
    """The boundary of ``mesh`` with its edges held as ``supports`` say and the edge ``pushed`` along ``direction``.

    With ``half``, the mesh is the upper half of a body, and the parabola of a contraction-free edge that of the whole.

    Raises
    ------
    InputError
        When the same nodes are pushed and held that way, a contraction-free edge is not straight along x or y, or what
        is held leaves the body free to move; ``place`` is named.
    """
    count = len(mesh.points)
    along = np.array(direction) / np.hypot(*direction)
    grip = np.unique(mesh.edges[pushed])
    axes = np.tile(np.eye(2), (count, 1, 1))
    axes[grip] = np.array([[along[1], -along[0]], along])
    numbers = np.arange(2 * count).reshape(count, 2)
    numbers[grip, 1] = numbers[grip[0], 1]
    used, dofs = np.unique(numbers, return_inverse=True)
    dofs = dofs.reshape(count, 2)
    fixed = [np.zeros(0, dtype=int)]
    rows: list[np.ndarray] = []
    for name, kind in supports.items():
        nodes = np.unique(mesh.edges[name])
        holds = _HOLDS.get(kind, (False, False))
        if kind == "contraction-free":
            normal, weights = _parabola(mesh, name, place, half)
            holds = (normal == 0, normal == 1)
            rows.append(np.zeros(len(used)))
            rows[-1][dofs[nodes, 1 - normal]] = weights[nodes]
        square = all(abs(along[axis]) < 1e-9 for axis in np.flatnonzero(holds))
        if len(np.intersect1d(nodes, grip)) and not (square and kind in _HOLDS):
            fault = f'the edges "{name}" and "{pushed}" share nodes that are held the way they are pushed'
            raise InputError(place, fault, "hold or push another edge")
        for axis in np.flatnonzero(holds):
            fixed += [dofs[nodes, part][np.abs(axes[nodes, part, axis]) > 0.5] for part in (0, 1)]
    found = Boundary(
        dofs,
        axes,
        np.unique(np.concatenate(fixed)),
        np.array(rows).reshape(len(rows), len(used)),
        int(dofs[grip[0], 1]),
        np.repeat(mesh.points, 2, axis=0)[used],
        axes.reshape(-1, 2)[used],
    )
    _check_held(found, mesh, grip, place)
    return found


def edge_weights(
    mesh: PlaneMesh, name: str, profile: Callable[[np.ndarray], np.ndarray] = lambda at: np.ones(at.shape[:-1])
) -> np.ndarray:
    """∫ N p ds along an edge by node, (nodes,), for a ``profile`` p of positions (…, 2) [m]."""
    sides = mesh.edges[name]
    ends = mesh.points[sides]
    length = np.linalg.norm(np.einsum("qa,sad->sqd", _SLOPES, ends), axis=2)
    shares = (length * profile(np.einsum("qa,sad->sqd", _SHAPES, ends)) * _WEIGHT) @ _SHAPES
    return np.bincount(sides.ravel(), weights=shares.ravel(), minlength=len(mesh.points))


def _parabola(mesh: PlaneMesh, name: str, place: str, half: bool) -> tuple[int, np.ndarray]:
    """The axis normal to a straight edge, and weights by node that sum to one."""
    at = mesh.points[np.unique(mesh.edges[name])]
    low, high = at.min(axis=0), at.max(axis=0)
    normal = int(np.argmin(high - low))
    size, middle = (high - low)[1 - normal], 0.5 * (high + low)[1 - normal]
    if half:
        size, middle = 2.0 * size, low[1 - normal]
    if (high - low)[normal] > 1e-9 * size:
        fault = f'the edge "{name}" is not straight along x or y'
        raise InputError(place, fault, 'hold it with "clamped", or turn the mesh')
    weights = edge_weights(mesh, name, lambda x: 1.0 - (2.0 * (x[..., 1 - normal] - middle) / size) ** 2)
    return normal, weights / weights.sum()


def _check_held(found: Boundary, mesh: PlaneMesh, grip: np.ndarray, place: str) -> None:
    """That no rigid motion is free: two translations and the rotation, as the constraints see them."""
    x, y = (mesh.points - mesh.points.mean(axis=0)).T
    size = max(np.ptp(x), np.ptp(y))
    one, none = np.ones_like(x), np.zeros_like(x)
    rigid = np.stack([np.stack([one, none, -y / size], axis=1), np.stack([none, one, x / size], axis=1)], axis=1)
    moves = np.einsum("ned,ndr->ner", found.axes, rigid)
    by_dof = np.zeros((len(found.position), 3))
    by_dof[found.dofs] = moves
    seen = np.concatenate([by_dof[found.fixed], found.rows @ by_dof, moves[grip, 1] - moves[grip[0], 1]])
    if np.linalg.matrix_rank(seen, tol=1e-6) < 3:
        raise InputError(place, "the supports leave the body free to move or to turn", 'hold an edge with "clamped"')
