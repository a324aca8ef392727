"""Limit load of a plate with a hole in tension, from a mesh file: P = fy (W - d) t.

A quarter of a plate of W = 20 mm with a hole of d = 4 mm, t = 1 mm, of quadrilaterals with 9 nodes. With a folder named
on the command line it leaves the mesh there, and the fields: open fields.pvd in ParaView.
"""

import sys
import tempfile
from pathlib import Path

import meshio
import numpy as np

from fem_reference import field_files, plane_push
from scene import parse_scene

COLUMNS, ROWS = 8, 8

SCENE = """
title = "Plate with a hole"
gravity = 0
[plane]
mesh = "{mesh}"
unit = "1 mm"
thickness = "1 mm"
material = "S235"
supports = {{ left = "roller-y", bottom = "roller-x" }}     # the planes of symmetry
[push]
node = "right"
direction = [1, 0]
distance = "0.06 mm"
"""


def write_mesh(path: Path) -> None:
    """The quarter between the hole and the plate's edges; elements grow from the hole outwards."""
    around, outwards = np.meshgrid(np.linspace(0.0, 1.0, 2 * COLUMNS + 1), np.linspace(0.0, 1.0, 2 * ROWS + 1))
    angle, share = 0.5 * np.pi * (1.0 - around.ravel()), outwards.ravel() ** 1.5
    ray = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    points = ray * (2.0 * (1.0 - share) + 10.0 / ray.max(axis=1) * share)[:, None]
    number = np.arange(len(points)).reshape(around.shape)
    local = ((0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0), (1, 1))
    cells = [number[2 * i + a, 2 * j + b] for a, b in local for i in range(ROWS) for j in range(COLUMNS)]
    meshio.write(path, meshio.Mesh(points, [("quad9", np.array(cells).reshape(9, -1).T)]))


def main(folder: Path | None = None) -> float:
    """Load at the end of the push over fy (W - d) t [-]."""
    with tempfile.TemporaryDirectory() as temporary:
        place = folder or Path(temporary)
        write_mesh(place / "plate.vtu")
        answer = plane_push(parse_scene(SCENE.format(mesh=place / "plate.vtu"), "plate"), tolerance=0.005)
        for name, text in field_files(answer.fields).items():
            (place / name).write_text(text, encoding="utf-8")
    print(f"{answer.outcome}, ± {100 * answer.error_estimate:.2f} %, {answer.elements} elements")
    return float(answer.load[-1]) / (235e6 * 16e-3 * 1e-3 / 2.0)


if __name__ == "__main__":
    print(f"P / fy (W - d) t = {main(Path(sys.argv[1]) if len(sys.argv) > 1 else None):.4f}")
