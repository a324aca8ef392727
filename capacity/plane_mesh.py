"""Plane meshes of triangles or quadrilaterals, read by meshio and checked."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from capacity.errors import InputError

#: Corners of the triangles that each kind of cell is cut into; cells of second order keep their mid-side nodes.
TRIANGLES = {
    "triangle": ((0, 1, 2),),
    "triangle6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad": ((0, 1, 2), (0, 2, 3)),
    "quad8": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
    "quad9": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
}


def read_plane_mesh(path: Path, scale: float, place: str) -> tuple[np.ndarray, Any]:
    """Points (n, 2) [m] of a mesh file in which one unit of length is ``scale`` metres, and the mesh as meshio has it.

    Raises
    ------
    InputError
        For a file that meshio cannot read, or points that do not lie in one plane z; ``place`` is named.
    """
    import meshio

    try:
        mesh = meshio.read(path)
    except (meshio.ReadError, ValueError, KeyError, IndexError, OSError, SystemExit) as error:
        raise InputError(place, f'meshio cannot read "{path}" ({error})', "write a mesh such as section.msh") from error
    points = np.asarray(mesh.points, dtype=float) * scale
    if not np.isfinite(points).all():
        raise InputError(place, f'"{path.name}" has a point that is not finite', "mend the mesh there")
    if points.shape[1] > 2 and np.ptp(points[:, 2]) > 1e-9 * np.ptp(points[:, :2]):
        raise InputError(place, f'the points of "{path.name}" do not lie in one plane z', "mesh it in x and y")
    return points[:, :2], mesh


def cell_groups(mesh: Any, path: Path, place: str) -> list[tuple[str, str, np.ndarray]]:
    """Name, meshio's type and nodes (n, k) of each group of plane cells; one without a name is called "".

    Raises
    ------
    InputError
        When there are no plane cells.
    """
    names = {int(values[0]): name for name, values in mesh.field_data.items() if int(values[1]) == 2}
    found = list(_groups(mesh, names))
    if not found:
        raise InputError(place, f'"{path.name}" has no triangles or quadrilaterals', "mesh the surface")
    return found


def _groups(mesh: Any, names: dict[int, str]) -> Iterator[tuple[str, str, np.ndarray]]:
    tags = mesh.cell_data.get("gmsh:physical")
    for number, block in enumerate(mesh.cells):
        if block.type not in TRIANGLES:
            continue
        cells = np.asarray(block.data)
        group = np.zeros(len(cells), dtype=int) if tags is None else np.asarray(tags[number]).astype(int)
        label = {tag: names.get(tag, "") for tag in np.unique(group).tolist()}
        if tags is None:
            for tag, (name, members) in enumerate(named_cells(mesh, number), start=1):
                group[members], label[tag] = tag, name
        for tag in np.unique(group).tolist():
            yield label[tag], block.type, cells[group == tag]


def named_cells(mesh: Any, number: int) -> Iterator[tuple[str, np.ndarray]]:
    """Name and members (k,) of the sets that a file forms of cells of its block ``number``."""
    for name, members in mesh.cell_sets.items():
        if members[number] is not None and not name.startswith("gmsh:"):
            yield name, np.asarray(members[number]).astype(int)


def signed_areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Areas (n,) of ``triangles`` (n, 3), positive where they run counter-clockwise [m²]."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    area: np.ndarray = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    return area


def check_cells(points: np.ndarray, triangles: np.ndarray, scale: float, place: str) -> None:
    """That ``triangles`` (n, 3) make up one body, each place of it once.

    Raises
    ------
    InputError
        When one is flat, inverted, over another, or not connected to the others by an edge; where it is, is said.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    def refuse(cell: int, fault: str, cure: str) -> None:
        x, y = points[triangles[cell]].mean(axis=0) / scale
        raise InputError(place, f"the cell at ({x:.5g}, {y:.5g}) {fault}", cure)

    area = signed_areas(points, triangles)
    flat = np.abs(area) <= 1e-12 * np.abs(area).max()
    if flat.any():
        refuse(int(np.argmax(flat)), "encloses nothing", "mend the mesh there")
    # Most of the area says which way round is right; the first cell where the two balance.
    lead = area.sum() if abs(area.sum()) > 1e-9 * np.abs(area).sum() else area[0]
    odd = area * lead < 0.0
    if odd.any():
        refuse(int(np.argmax(odd)), "is inverted", "number its corners the way of the others")
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    cell = np.tile(np.arange(len(triangles)), 3)
    _, first, count = np.unique(edges, axis=0, return_index=True, return_counts=True)
    if (count > 1).any():
        refuse(int(cell[first[np.argmax(count > 1)]]), "lies over another", "mesh each place once")
    _, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    n = len(triangles)
    links = coo_array((np.ones(len(cell)), (cell, n + which.ravel())), shape=(n + which.max() + 1,) * 2)
    label = connected_components(links, directed=False)[1][:n]
    main = np.bincount(label).argmax()
    if (label != main).any():
        refuse(int(np.argmax(label != main)), "is not connected to the others by an edge", "merge the mesh's nodes")


def cut_to_triangles(kind: str, cells: np.ndarray) -> np.ndarray:
    """Triangles (m, 3) that cover ``cells`` (n, k) of meshio's type ``kind``."""
    return np.concatenate([cells[:, corners] for corners in TRIANGLES[kind]])
