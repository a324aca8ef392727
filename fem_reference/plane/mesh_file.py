"""Plane bodies from mesh files: any that meshio reads, of triangles or quadrilaterals, straight or quadratic.

Straight cells get a node in the middle of each side. Where a file has both kinds, quadrilaterals are cut in two.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from capacity import InputError, Material
from capacity.mesh_section import group_material
from capacity.plane_mesh import cell_groups, check_cells, cut_to_triangles, named_cells, read_plane_mesh, signed_areas
from fem_reference.plane.mesh import PlaneMesh

_CORNERS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}
#: The two triangles of a quadrilateral with 9 nodes.
_HALVES = ((0, 1, 2, 4, 5, 8), (0, 2, 3, 8, 6, 7))
#: The same cells seen from behind.
_REVERSED = {6: (0, 2, 1, 5, 4, 3), 9: (0, 3, 2, 1, 7, 6, 5, 4, 8)}


def body_from_mesh(
    path: Path, scale: float, material: Material | None, place: str = "plane.mesh"
) -> tuple[PlaneMesh, list[Material]]:
    """The mesh in a file, and the materials of its groups.

    Parameters
    ----------
    path : Path
    scale : float
        Metres in one of the mesh's units of length.
    material : Material, optional
        Of cells whose group names none.
    place : str
        For messages.

    Raises
    ------
    InputError
        For a file that cannot be read, cells that are inverted, flat, folded, overlapping or not connected by an edge,
        and groups without a material; the place is named.
    """
    if not path.is_file():
        raise InputError(place, f'there is no file "{path}"', "write the path of a mesh")
    points, source = read_plane_mesh(path, scale, place)
    groups = cell_groups(source, path, place)
    check_cells(points, np.concatenate([cut_to_triangles(kind, cells) for _, kind, cells in groups]), scale, place)
    names = list(dict.fromkeys(name for name, _, _ in groups))
    materials = [_material(name, len(names), material, place) for name in names]
    points, blocks = _quadratic(points, [(kind, cells) for _, kind, cells in groups])
    if len({block.shape[1] for block in blocks}) > 1:
        blocks = [np.concatenate([b[:, half] for half in _HALVES]) if b.shape[1] == 9 else b for b in blocks]
    cells = np.concatenate(blocks)
    if signed_areas(points, cells[:, :3]).sum() < 0.0:
        cells = cells[:, _REVERSED[cells.shape[1]]]
    group = np.concatenate([np.full(len(b), names.index(g[0])) for b, g in zip(blocks, groups, strict=True)])
    used, numbers = np.unique(cells, return_inverse=True)
    mesh = PlaneMesh(points[used], numbers.reshape(cells.shape), {}, group)
    _check_folds(mesh, scale, place)
    new = np.full(len(points), -1)
    new[used] = np.arange(len(used))
    return PlaneMesh(mesh.points, mesh.cells, _named_edges(source, mesh, new), group).with_sides(), materials


def _material(name: str, groups: int, given: Material | None, place: str) -> Material:
    found = group_material(name, 1 if given is not None else groups, place) or given
    if found is None:
        raise InputError("plane.material", "the mesh has no material", 'write material = "S235"')
    if found.curve is not None:
        cure = 'give the slope beyond yield instead, for example "Et=2 GPa"'
        raise InputError("plane.material", "a table of stresses is not modelled in plane stress yet", cure)
    return found


def _quadratic(points: np.ndarray, blocks: list[tuple[str, np.ndarray]]) -> tuple[np.ndarray, list[np.ndarray]]:
    """Points, and cells with 6 or 9 nodes; nodes that a cell lacks are added where a straight one would have them."""
    found, extra = [], [points]
    count = len(points)
    sides = [
        np.sort(cells[:, [(i, (i + 1) % corners) for i in range(corners)]].reshape(-1, 2), axis=1)
        for kind, cells in blocks
        if (corners := _CORNERS[kind]) == cells.shape[1]
    ]
    if sides:
        ends, which = np.unique(np.concatenate(sides), axis=0, return_inverse=True)
        extra.append(points[ends].mean(axis=1))
        middles = iter(np.split(count + which, np.cumsum([len(s) for s in sides])[:-1]))
        count += len(ends)
    for kind, cells in blocks:
        corners = _CORNERS[kind]
        if cells.shape[1] == corners:
            cells = np.concatenate([cells, next(middles).reshape(-1, corners)], axis=1)
        if cells.shape[1] == 8:
            at = np.concatenate(extra)[cells]
            # Where the eight shape functions of a serendipity element have their centre.
            extra.append(0.5 * at[:, 4:].sum(axis=1) - 0.25 * at[:, :4].sum(axis=1))
            cells = np.concatenate([cells, count + np.arange(len(cells))[:, None]], axis=1)
            count += len(cells)
        found.append(cells)
    return np.concatenate(extra), found


def _check_folds(mesh: PlaneMesh, scale: float, place: str) -> None:
    try:
        mesh.shape_gradients()
    except ValueError as error:
        x, y = mesh.points[mesh.cells[int(str(error))]].mean(axis=0) / scale
        fault = f"the cell at ({x:.5g}, {y:.5g}) folds over itself"
        raise InputError(place, fault, "move the nodes on its sides nearer to the middle") from error


def _named_edges(source: Any, mesh: PlaneMesh, new: np.ndarray) -> dict[str, np.ndarray]:
    """Element sides on the boundary that the file gives a name, by lines or by points."""
    sides = mesh.boundary
    by_ends = {frozenset((int(a), int(b))): i for i, (a, _, b) in enumerate(sides.tolist())}
    found: dict[str, list[int]] = {}
    for name, lines in _named_lines(source):
        hit = [by_ends.get(frozenset(map(int, new[line]))) for line in lines[:, :2]]
        found.setdefault(name, []).extend(i for i in hit if i is not None)
    for name, members in source.point_sets.items():
        inside = np.zeros(len(mesh.points) + 1, dtype=bool)
        inside[new[np.asarray(members).astype(int)]] = True
        inside[-1] = False  # where points of no cell went
        found.setdefault(name, []).extend(np.flatnonzero(inside[sides[:, [0, 2]]].all(axis=1)).tolist())
    return {name: sides[np.unique(which)] for name, which in found.items() if which}


def _named_lines(source: Any) -> Iterator[tuple[str, np.ndarray]]:
    names = {int(values[0]): name for name, values in source.field_data.items() if int(values[1]) == 1}
    tags = source.cell_data.get("gmsh:physical")
    for number, block in enumerate(source.cells):
        if block.type not in ("line", "line3"):
            continue
        if tags is not None:
            group = np.asarray(tags[number]).astype(int)
            for tag in np.unique(group).tolist():
                yield names.get(tag, str(tag)), block.data[group == tag]
        for name, members in named_cells(source, number):
            yield name, block.data[members]
