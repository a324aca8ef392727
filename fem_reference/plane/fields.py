"""Fields of a plane body as files that ParaView opens: a VTU file a state, and a PVD file that makes them a series."""

from __future__ import annotations

import numpy as np

from fem_reference.plane.continuum import Continuum, State
from fem_reference.plane.j2 import MODES, von_mises
from fem_reference.plane.mesh import nearest_points
from fem_reference.plane.push import Fields
from fem_reference.vtu import series, vtu_text

_CELLS = {6: "triangle6", 9: "quad9"}


def field_files(fields: Fields, name: str = "fields") -> dict[str, str]:
    """Text of ``name``.pvd and of one VTU file a state, by file name.

    The time of a state in the series is the way of the pushed edge so far [m].
    """
    states = [vtu(fields.continuum, state) for state in fields.states]
    way = np.append(0.0, np.cumsum(np.abs(np.diff(fields.displacement))))
    return series(name, way.tolist(), states)


def vtu(continuum: Continuum, state: State) -> str:
    """One state as the text of a VTU file: displacement [m], stresses [Pa] and plastic strain [-] at the nodes."""
    mesh = continuum.mesh
    stress = at_nodes(continuum, state.stress @ MODES)
    moved = continuum.nodal_displacement(state.displacement)
    data = {
        "displacement": moved,
        "stress_xx": stress[:, 0],
        "stress_yy": stress[:, 1],
        "stress_xy": stress[:, 2],
        "von_mises": at_nodes(continuum, von_mises(state.stress)[..., None])[:, 0],
        "equivalent_plastic_strain": at_nodes(continuum, state.accumulated[..., None])[:, 0],
    }
    return vtu_text(mesh.points, _CELLS[mesh.cells.shape[1]], mesh.cells, data)


def at_nodes(continuum: Continuum, values: np.ndarray) -> np.ndarray:
    """Values (n, q, c) at quadrature points as values (nodes, c): of the nearest point in each element, their mean.

    An extrapolation to the nodes would leave the yield surface; this does not.
    """
    cells = continuum.mesh.cells
    nearest = values[:, nearest_points(cells.shape[1])]
    count = len(continuum.mesh.points)
    shares = np.bincount(cells.ravel(), minlength=count)
    sums = [np.bincount(cells.ravel(), weights=part.ravel(), minlength=count) for part in np.moveaxis(nearest, -1, 0)]
    return np.asarray(np.stack(sums, axis=1) / shares[:, None])
