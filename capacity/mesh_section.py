"""Sections read from meshes of triangles or quadrilaterals, by meshio; groups of cells name materials."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from capacity.errors import InputError
from capacity.materials import Material, parse_material
from capacity.outline import Outline
from capacity.sections import Part, Section

# Corners of the triangles that each kind of cell is cut into; cells of second order keep their mid-side nodes.
_TRIANGLES = {
    "triangle": ((0, 1, 2),),
    "triangle6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad": ((0, 1, 2), (0, 2, 3)),
    "quad8": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
    "quad9": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
}


def section_from_mesh(path: Path, scale: float = 1.0, place: str = "mesh") -> Section:
    """The section that a plane mesh covers.

    Parameters
    ----------
    path : Path
        Any file that meshio reads, e.g. of Gmsh; x and y are the section's axes, z does not vary.
    scale : float
        Metres in one of the mesh's units of length.
    place : str
        For messages.

    Raises
    ------
    InputError
        For a file that cannot be read, cells that are inverted, flat, overlapping or not connected by an edge, and
        groups that name no material where there are several; the place is named.
    """
    points, groups = _read(path, scale, place)
    triangles = np.concatenate([cells for _, cells in groups])
    _check_cells(points, triangles, scale, place)
    if _signed_areas(points, triangles).sum() < 0.0:  # seen from behind
        groups = [(name, cells[:, ::-1]) for name, cells in groups]
    parts = []
    for name, cells in groups:
        material = _material(name, len(groups), place)
        parts.append(Part(_boundary(points, cells), material=material))
    return Section.drawn(path.name, parts)


def _read(path: Path, scale: float, place: str) -> tuple[np.ndarray, list[tuple[str, np.ndarray]]]:
    """Points (n, 2) [m] and the triangles of each group of cells."""
    import meshio

    try:
        mesh = meshio.read(path)
    except (meshio.ReadError, ValueError, KeyError, IndexError, OSError, SystemExit) as error:
        raise InputError(place, f'meshio cannot read "{path}" ({error})', "write a mesh such as section.msh") from error
    points = np.asarray(mesh.points, dtype=float) * scale
    if points.shape[1] > 2 and np.ptp(points[:, 2]) > 1e-9 * np.ptp(points[:, :2]):
        raise InputError(place, f'the points of "{path.name}" do not lie in one plane z', "mesh the section in x and y")
    names = {int(values[0]): name for name, values in mesh.field_data.items() if int(values[1]) == 2}
    found: dict[str, list[np.ndarray]] = {}
    for name, cells in _blocks(mesh, names):
        found.setdefault(name, []).append(cells)
    if not found:
        raise InputError(place, f'"{path.name}" has no triangles or quadrilaterals', "mesh the section's surface")
    return points[:, :2], [(name, np.concatenate(cells)) for name, cells in found.items()]


def _blocks(mesh: Any, names: dict[int, str]) -> Iterator[tuple[str, np.ndarray]]:
    tags = mesh.cell_data.get("gmsh:physical")
    for number, block in enumerate(mesh.cells):
        if block.type not in _TRIANGLES:
            continue
        cells = np.asarray(block.data)
        group = np.zeros(len(cells), dtype=int) if tags is None else np.asarray(tags[number]).astype(int)
        label = {tag: names.get(tag, "") for tag in np.unique(group).tolist()}
        if tags is None:
            sets = {
                name: np.asarray(members[number]).astype(int)
                for name, members in mesh.cell_sets.items()
                if members[number] is not None and not name.startswith("gmsh:")
            }
            for tag, (name, members) in enumerate(sets.items(), start=1):
                group[members], label[tag] = tag, name
        for tag in np.unique(group).tolist():
            for corners in _TRIANGLES[block.type]:
                yield label[tag], cells[group == tag][:, corners]


def _signed_areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    area: np.ndarray = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    return area


def _check_cells(points: np.ndarray, triangles: np.ndarray, scale: float, place: str) -> None:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    def refuse(cell: int, fault: str, cure: str) -> None:
        x, y = points[triangles[cell]].mean(axis=0) / scale
        raise InputError(place, f"the cell at ({x:.5g}, {y:.5g}) {fault}", cure)

    area = _signed_areas(points, triangles)
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


def _boundary(points: np.ndarray, triangles: np.ndarray) -> Outline:
    """Edges that no neighbour within the group runs the other way."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    n = len(points)
    keys = edges[:, 0] * n + edges[:, 1]
    outer = edges[~np.isin(keys, edges[:, 1] * n + edges[:, 0])]
    start, span = points[outer[:, 0]], points[outer[:, 1]] - points[outer[:, 0]]
    zeros = np.zeros(len(outer))
    return Outline(start, span, zeros, zeros, zeros, np.ones(len(outer)))


def _material(name: str, groups: int, place: str) -> Material | None:
    """The material a group names; a single group may have any name, the section's material is then given beside it."""
    try:
        return parse_material(name, f'{place} > group "{name}"')
    except InputError:
        if groups == 1:
            return None
        raise
