"""What leads along a path: load, displacement and arc length; limit points, snap-through, snap-back, mechanisms."""

from typing import Any

import msgspec
import numpy as np
import pytest
from cantilevers import cantilever
from frames import frame_scene, portal

from fem_reference import pushover
from scene import Scene

STRONG = "fy=1e6 MPa, E=210 GPa, rho=7850 kg/m^3"
EA = 210e9 * 0.01
HALF, RISE = 1.0, 0.1


def controlled(scene: Scene, control: str, **fields: Any) -> Scene:
    return msgspec.structs.replace(scene, pushed=msgspec.structs.replace(scene.push, control=control, **fields))


def truss(distance: float, spring: float = 0.0) -> Scene:
    """Two elastic bars that meet at C, RISE above their supports; pushed down, perhaps through a softer bar above."""
    nodes = {"A": (-HALF, 0.0, "pinned"), "C": (0.0, RISE, "free"), "B": (HALF, 0.0, "pinned")}
    members = [("A", "C"), ("C", "B")]
    if spring:
        nodes["T"] = (0.0, RISE + 1.0, "roller-y")
        members.append(("C", "T"))
    node = "T" if spring else "C"
    push = f'[push]\nnode = "{node}"\ndirection = [0, -1]\ndistance = {distance!r}\ncontrol = "arc-length"'
    scene = frame_scene(nodes, members, push, section="rectangle 100x100 mm", material=STRONG, kinematics="large")
    hinged = {}
    for name, m in scene.members.items():
        material = m.material if name != "C-T" else type(m.material)("soft", spring / 0.01, 1e12, 1.0)
        hinged[name] = msgspec.structs.replace(m, material=material, releases=("from", "to"))
    return msgspec.structs.replace(scene, members=hinged)


def truss_load(sag: np.ndarray) -> np.ndarray:
    """P = 2 EA (L₀ - L) / L₀ · (rise - sag) / L, engineering strain (Crisfield, vol. 1, section 1.2)."""
    whole, now = np.hypot(HALF, RISE), np.hypot(HALF, RISE - sag)
    return np.asarray(2.0 * EA * (whole - now) / whole * (RISE - sag) / now)


def test_a_shallow_truss_snaps_through() -> None:
    answer = pushover(truss(2.4 * RISE))
    np.testing.assert_allclose(answer.load, truss_load(answer.displacement), rtol=1e-6, atol=1e-6 * answer.load.max())
    sags = np.linspace(0.0, RISE, 20001)
    highest = truss_load(sags).max()
    assert answer.outcome.startswith("limit point")
    first = answer.load[: len(answer.load) // 2].max()
    assert first == pytest.approx(highest, rel=1e-3)
    assert answer.load.min() == pytest.approx(-highest, rel=1e-3)


def test_a_truss_under_a_soft_bar_snaps_back() -> None:
    """The pushed end goes by the sag and by how much the soft bar shortens: u = w + P / k."""
    spring = truss_load(np.array([0.4 * RISE]))[0] / RISE
    answer = pushover(truss(4.0 * RISE, spring))
    assert "snap-back" in answer.outcome
    assert (np.diff(answer.displacement) < 0.0).any()
    sags = np.linspace(0.0, 2.6 * RISE, 40001)
    curve = np.column_stack([sags + truss_load(sags) / spring, truss_load(sags)])
    size = np.array([answer.displacement.max(), answer.load.max()])
    for point in np.column_stack([answer.displacement, answer.load]) / size:
        assert np.linalg.norm(curve / size - point, axis=1).min() <= 1e-3


def test_arc_length_goes_the_way_of_displacement_control_past_a_limit_load() -> None:
    scene = portal(4.0, 6.0, 2.0, "B", 0.2, "p-delta")
    by_displacement = pushover(scene, 1e-3)
    by_arc = pushover(controlled(scene, "arc-length"), 2e-3)
    assert by_arc.outcome.startswith("limit point")
    assert by_arc.displacement[-1] >= 0.2
    expected = np.interp(by_arc.displacement, by_displacement.displacement, by_displacement.load)
    inside = by_arc.displacement <= 0.2
    assert np.abs(by_arc.load - expected)[inside].max() <= 2e-3 * by_displacement.load.max()
    assert [hinge.node for hinge in by_arc.hinges] == [hinge.node for hinge in by_displacement.hinges]


def test_load_control_stops_at_a_mechanism_and_says_so() -> None:
    scene = controlled(cantilever("rectangle 50x100 mm", 1.0, 0.1), "load", distance=0.0, largest_load=35e3)
    answer = pushover(scene)
    assert answer.outcome.startswith("mechanism")
    assert answer.load.max() == pytest.approx(29375.0, rel=6e-3)  # the last of 200 steps that is borne
    assert answer.load.max() <= 29375.0
    assert answer.imbalance <= 1e-5


def test_load_control_stops_at_a_limit_point_and_says_so() -> None:
    scene = portal(4.0, 6.0, 2.0, "B", 0.2, "p-delta")
    highest = pushover(scene, 1e-3).load.max()
    answer = pushover(controlled(scene, "load", distance=0.0, largest_load=1.2 * float(highest)), 5e-3)
    assert answer.outcome.startswith("limit point")
    assert highest * 0.99 <= answer.load.max() <= highest * 1.001


def test_load_control_of_what_is_borne_comes_to_its_load() -> None:
    scene = controlled(cantilever("rectangle 50x100 mm", 1.0, 0.1), "load", distance=0.0, largest_load=10e3)
    answer = pushover(scene)
    assert answer.outcome == "reached the end of its programme"
    assert answer.displacement[-1] == pytest.approx(10e3 / (3.0 * 875e3), rel=1e-6)
