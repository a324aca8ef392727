"""Sections read from meshes of triangles or quadrilaterals, by meshio; groups of cells name materials."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from capacity.errors import InputError
from capacity.materials import Material, parse_material
from capacity.outline import Outline
from capacity.plane_mesh import cell_groups, check_cells, cut_to_triangles, read_plane_mesh, signed_areas
from capacity.sections import Part, Section


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
    check_cells(points, triangles, scale, place)
    if signed_areas(points, triangles).sum() < 0.0:  # seen from behind
        groups = [(name, cells[:, ::-1]) for name, cells in groups]
    parts = []
    for name, cells in groups:
        material = group_material(name, len(groups), place)
        parts.append(Part(_boundary(points, cells), material=material))
    return Section.drawn(path.name, parts)


def _read(path: Path, scale: float, place: str) -> tuple[np.ndarray, list[tuple[str, np.ndarray]]]:
    """Points (n, 2) [m] and the triangles of each group of cells."""
    points, mesh = read_plane_mesh(path, scale, place)
    found: dict[str, list[np.ndarray]] = {}
    for name, kind, cells in cell_groups(mesh, path, place):
        found.setdefault(name, []).append(cut_to_triangles(kind, cells))
    return points, [(name, np.concatenate(cells)) for name, cells in found.items()]


def _boundary(points: np.ndarray, triangles: np.ndarray) -> Outline:
    """Edges that no neighbour within the group runs the other way."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    n = len(points)
    keys = edges[:, 0] * n + edges[:, 1]
    outer = edges[~np.isin(keys, edges[:, 1] * n + edges[:, 0])]
    start, span = points[outer[:, 0]], points[outer[:, 1]] - points[outer[:, 0]]
    zeros = np.zeros(len(outer))
    return Outline(start, span, zeros, zeros, zeros, np.ones(len(outer)))


def group_material(name: str, groups: int, place: str) -> Material | None:
    """The material a group of cells names; a single group may have any name, its material is then given beside it."""
    try:
        return parse_material(name, f'{place} > group "{name}"')
    except InputError:
        if groups == 1:
            return None
        raise
