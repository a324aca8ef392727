"""Plane stress against CalculiX in one run: ``pytest benchmarks/test_plane_speed.py -s``.

A clamped cantilever, L/h = 5, perfectly plastic, on 40 × 8 quadratic elements, pushed to eight times its deflection at
first yield in 50 equal increments. CalculiX takes its CPS8R (8 nodes, reduced integration), of one millimetre, for a
thick section comes out too stiff there. Errors are of the load over the path, against the finest mesh of the reference.
CalculiX is the Debian package calculix-ccx.
"""

import shutil
import statistics
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from capacity import parse_material
from fem_reference.plane.beam_mesh import beam_mesh, tensor_mesh
from fem_reference.plane.boundary import boundary
from fem_reference.plane.continuum import Continuum
from fem_reference.plane.equilibrium import Body
from fem_reference.plane.j2 import J2
from fem_reference.plane.mesh import PlaneMesh
from fem_reference.plane.path import trace

LENGTH, DEPTH, THICKNESS = 0.5, 0.1, 0.001
ACROSS, ALONG, INCREMENTS, FARTHEST = 8, 40, 50, 0.0149206349
DISTANCES = np.linspace(0.0, FARTHEST, INCREMENTS + 1)[1:]
RUNS = 3
LEAST_RATIO = 5.0


def loads(mesh: PlaneMesh) -> np.ndarray:
    edges = boundary(mesh, {"left": "clamped"}, "right", (0.0, -1.0), "benchmark")
    law = J2.of([parse_material("fy=235 MPa, E=210 GPa")], mesh.group)
    continuum = Continuum(mesh, THICKNESS, law, edges.dofs, edges.axes)
    return np.array(trace(Body(continuum, edges, np.zeros(continuum.size)), [DISTANCES]).load[1:])


def own() -> np.ndarray:
    x, y = np.linspace(0.0, LENGTH, ALONG + 1), np.linspace(-0.5 * DEPTH, 0.5 * DEPTH, ACROSS + 1)
    return loads(tensor_mesh(x, y))


def calculix(folder: Path) -> np.ndarray:
    (folder / "beam.inp").write_text(deck(), encoding="utf-8")
    subprocess.run(["ccx", "beam"], cwd=folder, check=True, capture_output=True)
    lines = (folder / "beam.dat").read_text(encoding="utf-8").splitlines()
    totals = [lines[i + 2].split() for i, line in enumerate(lines) if "total force" in line]
    return np.array([-float(total[1]) for total in totals])


def deck() -> str:
    """The same body as CalculiX reads it, in mm and MPa."""
    places = [(i, j) for i in range(2 * ALONG + 1) for j in range(2 * ACROSS + 1) if not (i % 2 and j % 2)]
    number = {place: k for k, place in enumerate(places, 1)}
    dx, dy = 500.0 * LENGTH / ALONG, 500.0 * DEPTH / ACROSS
    nodes = [f"{k}, {i * dx!r}, {j * dy!r}, 0." for (i, j), k in number.items()]
    ring = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    origins = [(i, j) for i in range(0, 2 * ALONG, 2) for j in range(0, 2 * ACROSS, 2)]
    elements = [f"{k}, " + ", ".join(str(number[i + a, j + b]) for a, b in ring) for k, (i, j) in enumerate(origins, 1)]
    ends = {name: [number[i, j] for j in range(2 * ACROSS + 1)] for name, i in (("ROOT", 0), ("TIP", 2 * ALONG))}
    sets = [line for name, members in ends.items() for line in (f"*NSET, NSET={name}", *(f"{n}," for n in members))]
    return "\n".join(
        [
            "*NODE, NSET=ALL",
            *nodes,
            "*ELEMENT, TYPE=CPS8R, ELSET=BEAM",
            *elements,
            *sets,
            "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*PLASTIC\n235., 0.",
            f"*SOLID SECTION, ELSET=BEAM, MATERIAL=STEEL\n{1e3 * THICKNESS!r}",
            "*BOUNDARY\nROOT, 1, 2",
            f"*STEP, INC=1000\n*STATIC, DIRECT\n{1.0 / INCREMENTS!r}, 1.",
            f"*BOUNDARY\nTIP, 2, 2, {-1e3 * FARTHEST!r}",
            "*NODE PRINT, NSET=TIP, TOTALS=ONLY\nRF\n*END STEP\n",
        ]
    )


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed: apt-get install calculix-ccx")
def test_five_times_faster_than_calculix_at_no_greater_error(tmp_path: Path) -> None:
    own()  # the first run also loads libraries
    seconds: dict[str, list[float]] = {"own": [], "calculix": []}
    found: dict[str, np.ndarray] = {}
    for _ in range(RUNS):  # in turns, so that both meet the same machine
        for name, run in (("own", own), ("calculix", lambda: calculix(tmp_path))):
            started = time.perf_counter()
            found[name] = run()
            seconds[name].append(time.perf_counter() - started)
    exact = loads(beam_mesh(LENGTH, DEPTH, 2))
    errors = {name: float(np.abs(path - exact).max() / exact.max()) for name, path in found.items()}
    median = {name: statistics.median(values) for name, values in seconds.items()}
    ratio = statistics.median(b / a for a, b in zip(seconds["own"], seconds["calculix"], strict=True))
    print(f"\nmedian of {RUNS}: own {median['own']:.2f} s, CalculiX {median['calculix']:.2f} s, ratio {ratio:.1f}")
    print(f"error of the load: own {errors['own']:.2%}, CalculiX {errors['calculix']:.2%}")
    assert len(found["calculix"]) == INCREMENTS
    assert errors["own"] <= errors["calculix"]
    assert ratio >= LEAST_RATIO
