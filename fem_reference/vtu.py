"""States of a body as files that ParaView opens: a VTU file a state, and a PVD file that makes them a series."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np


def vtu_text(points: np.ndarray, kind: str, cells: np.ndarray, values: Mapping[str, np.ndarray]) -> str:
    """One state as the text of a VTU file, written by meshio.

    Parameters
    ----------
    points : (n, 2) float
        [m]
    kind : str
        meshio's name for the cells: ``"line"``, ``"triangle6"`` …
    cells : (c, k) int
    values : mapping of (n,) or (n, 2) float
        What is known at the points, by name; vectors get a third component of zero, which ParaView warps by.
    """
    import meshio

    def flat(rows: np.ndarray) -> np.ndarray:
        return np.column_stack([rows, np.zeros(len(rows))]) if rows.ndim == 2 else rows

    written = meshio.Mesh(
        flat(points),
        [(kind, cells)],
        point_data={key: np.ascontiguousarray(flat(rows), dtype=np.float32) for key, rows in values.items()},
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "state.vtu"
        meshio.vtu.write(path, written, binary=True, compression="zlib")
        return path.read_text(encoding="utf-8")


def series(name: str, times: Sequence[float], states: Sequence[str]) -> dict[str, str]:
    """Text of ``name``.pvd and of the VTU files of its ``states`` at ``times``, by file name."""
    files = {f"{name}-{i:02d}.vtu": text for i, text in enumerate(states)}
    entries = "\n".join(
        f'    <DataSet timestep="{time:.9g}" part="0" file="{file}"/>' for time, file in zip(times, files, strict=True)
    )
    files[f"{name}.pvd"] = (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f"  <Collection>\n{entries}\n  </Collection>\n</VTKFile>\n"
    )
    return files
