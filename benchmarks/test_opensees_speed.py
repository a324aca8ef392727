"""Fibre cantilevers beside OpenSees in one run: time at equal error, and at equal size.

``pytest benchmarks/test_opensees_speed.py``; OpenSeesPy needs ``pip install openseespy`` and the libraries of BLAS and
LAPACK (Debian: libblas3, liblapack3). Only ratios carry over from one machine to another.
"""

import time
from collections.abc import Callable

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from capacity import moment_curvature, parse_material, parse_section
from fem_reference.frame_mesh import build_frame
from fem_reference.programme import trace
from scene import Scene, parse_scene

opensees = pytest.importorskip("openseespy.opensees", reason="needs pip install openseespy, and libblas3, liblapack3")

LENGTH, DEPTH, WIDTH = 1.0, 0.1, 0.05
E, FY, HARDENING = 210e9, 235e6, 0.01
STEPS, POINTS, FIBRES = 100, 5, 40
FARTHEST = 10.0 * FY * LENGTH**2 / (1.5 * E * DEPTH)  # ten times the deflection at first yield
SCENE = f"""
title = "cantilever"
gravity = 0
[nodes.root]
at = [0.0, 0.0]
support = "clamped"
[nodes.tip]
at = [{LENGTH}, 0.0]
[members.beam]
from = "root"
to = "tip"
section = "rectangle 50x100 mm"
material = "fy=235 MPa, E=210 GPa, Et=2.1 GPa"
theory = "euler-bernoulli"
[push]
node = "tip"
direction = [0, -1]
distance = {FARTHEST}
"""


def exact() -> np.ndarray:
    """Loads at the steps, by integration of the exact curvature along the beam."""
    curvature = np.append(np.linspace(0.0, 0.1, 400), np.linspace(0.1, 3.0, 4000)[1:])
    material = parse_material("fy=235 MPa, E=210 GPa, Et=2.1 GPa")
    moment = moment_curvature(parse_section("rectangle 50x100 mm"), material, curvature).moment
    arm = np.linspace(0.0, LENGTH, 4001)
    loads = np.linspace(0.0, 0.95 * moment[-1] / LENGTH, 2000)
    deflections = [np.trapezoid(np.interp(load * arm, moment, curvature) * arm, arm) for load in loads]
    return np.interp(np.linspace(0.0, FARTHEST, STEPS + 1)[1:], deflections, loads)


def opensees_push(elements: int, kind: str) -> np.ndarray:
    ops = opensees
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for i in range(elements + 1):
        ops.node(i + 1, LENGTH * i / elements, 0.0)
    ops.fix(1, 1, 1, 1)
    ops.uniaxialMaterial("Steel01", 1, FY, E, HARDENING)
    ops.section("Fiber", 1)
    ops.patch("rect", 1, FIBRES, 1, -DEPTH / 2, -WIDTH / 2, DEPTH / 2, WIDTH / 2)
    ops.beamIntegration("Lobatto", 1, 1, POINTS)
    ops.geomTransf("Linear", 1)
    for i in range(elements):
        ops.element(kind, i + 1, i + 1, i + 2, 1, 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(elements + 1, 0.0, -1.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("EnergyIncr", 1e-12, 50)
    ops.algorithm("Newton")
    ops.integrator("DisplacementControl", elements + 1, 2, -FARTHEST / STEPS)
    ops.analysis("Static")
    loads = np.zeros(STEPS)
    for k in range(STEPS):
        assert ops.analyze(1) == 0
        loads[k] = ops.getTime()
    return loads


def own_push(scene: Scene, elements: int, fibres: int) -> np.ndarray:
    frame = build_frame(scene, elements, fibres)
    points = np.linspace(0.0, FARTHEST, STEPS + 1)[1:]
    return np.array(trace(frame, frame.pattern, scene.push, [points]).load[1:])


def timed(run: Callable[[], np.ndarray], loads: np.ndarray) -> tuple[float, float]:
    """Least time of three runs [s], and the largest error of the load over the largest load."""
    least = np.inf
    for _ in range(3):
        start = time.perf_counter()
        found = run()
        least = min(least, time.perf_counter() - start)
    return least, float(np.abs(found - loads).max() / loads.max())


@pytest.mark.parametrize("kind", ["forceBeamColumn", "dispBeamColumn"])
@pytest.mark.parametrize("elements", [10, 50, 200])
def test_fibre_cantilever_beside_opensees(benchmark: BenchmarkFixture, elements: int, kind: str) -> None:
    """The reference with the fewest elements and fibres that are as exact as OpenSees; figures in the extra columns."""
    loads, scene = exact(), parse_scene(SCENE, "benchmark")
    own_push(scene, 4, 8)  # compiles
    theirs, their_error = timed(lambda: opensees_push(elements, kind), loads)
    same, same_error = timed(lambda: own_push(scene, elements, FIBRES), loads)
    for count in (4, 6, 8, 10, 14, 20, 28, 40, 56, 80, 112, 160, 200):
        fibres = min(FIBRES, 4 * ((count + 3) // 2))
        own, own_error = timed(lambda size=(count, fibres): own_push(scene, *size), loads)
        if own_error <= their_error:
            break
    benchmark.pedantic(own_push, (scene, count, fibres), rounds=3)
    benchmark.extra_info |= {
        "opensees_seconds": theirs,
        "opensees_error": their_error,
        "own_seconds_at_equal_error": own,
        "own_error": own_error,
        "own_elements_and_fibres": (count, fibres),
        "ratio_at_equal_error": own / theirs,
        "ratio_at_equal_elements": same / theirs,
        "own_error_at_equal_elements": same_error,
    }
    assert own_error <= their_error
