"""The reference against closed forms, and how fast it converges."""

from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np
import pytest
from cantilevers import SECTIONS, cantilever, reference_cantilever

from capacity import InputError, moment_curvature, parse_material
from fem_reference import NotConverged, pushover
from fem_reference.frame_mesh import build_frame
from fem_reference.programme import trace
from scene import Scene


def loads(scene: Scene, elements: int, fibres: int, distances: np.ndarray) -> np.ndarray:
    frame = build_frame(scene, elements, fibres)
    path = trace(frame, frame.pattern, scene.push, [distances])
    assert path.imbalance <= 1e-5
    assert not path.stopped
    return np.array(path.load[1:])


@pytest.mark.parametrize("name", SECTIONS)
def test_cantilever_follows_the_closed_form(name: str, case: Callable[[str], dict[str, Any]]) -> None:
    """Twenty points of the closed-form moment–curvature integration, within 0.1 % and within the own estimate."""
    reference = case(name)
    answer = pushover(reference_cantilever(reference), tolerance=5e-4)
    outputs = reference["outputs"]
    displacement = np.array(outputs["delta_over_dy"]) * outputs["delta_y_m"]
    load = np.interp(displacement, answer.displacement, answer.load)
    exact = np.array(outputs["P_N"])
    assert answer.error_estimate <= 5e-4
    assert np.abs(load / exact - 1.0).max() <= 1e-3
    assert np.abs(load - exact).max() / exact.max() <= answer.error_estimate


def test_collapse_load_is_exact_on_any_mesh() -> None:
    """The end's quadrature point is at the end, so the hinge is: P = M_p / L."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.1)
    assert loads(scene, 4, 8, np.array([0.05, 0.1]))[-1] == pytest.approx(29375.0, rel=1e-6)


def test_a_bar_pulled_along_its_axis_never_bears_more_than_it_can() -> None:
    """All its sections yield at once, at N_pl and a displacement of fy L / E."""
    scene = cantilever("rectangle 50x100 mm", 2.0, 20e-3)
    push = msgspec.structs.replace(scene.push, direction=(1.0, 0.0))
    answer = pushover(msgspec.structs.replace(scene, pushed=push))
    exact = np.minimum(answer.displacement * 210e9 / 2.0, 235e6) * 0.05 * 0.1
    np.testing.assert_allclose(answer.load, exact, atol=1e-8 * 235e6 * 0.05 * 0.1)
    assert answer.imbalance <= 1e-8


def test_error_falls_with_the_square_of_the_element_size() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.02)
    distances = np.linspace(0.0, 0.02, 41)[1:]
    counts = np.array([4, 8, 16, 32])
    exact = loads(scene, 128, 64, distances)
    errors = [np.abs(loads(scene, int(n), 64, distances) - exact).max() for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] > 1.8


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
def test_elastic_stiffness_is_exact(theory: str) -> None:
    """P / δ = 1 / (L³ / 3EI + L / GA_s), the second term for Timoshenko only."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 1e-3, theory=theory)
    c = scene.capacity("beam")
    flexibility = 1.0 / (3.0 * c.EI) + (1.0 / c.GA_s if theory == "timoshenko" else 0.0)
    assert loads(scene, 4, 8, np.array([1e-3]))[0] == pytest.approx(1e-3 / flexibility, rel=1e-7)


def test_own_weight_takes_its_share_of_the_collapse_load() -> None:
    """P = (M_p - q L² / 2) / L with q = ρ g A."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.1, gravity=9.81)
    weight = 7850.0 * 9.81 * 0.005
    assert loads(scene, 20, 24, np.linspace(0.0, 0.1, 21)[1:])[-1] == pytest.approx(29375.0 - weight / 2.0, rel=1e-5)


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0, -1.3])
def test_a_turned_frame_answers_the_same(turn: float) -> None:
    straight = cantilever("rectangle 50x100 mm", 1.0, 0.03)
    c, s = np.cos(turn), np.sin(turn)
    nodes = dict(straight.nodes)
    nodes["tip"] = type(nodes["tip"])(at=(float(c), float(s)))
    moved = type(straight)(
        title="turned",
        nodes=nodes,
        members=straight.members,
        pushed=type(straight.push)(node="tip", direction=(float(s), float(-c)), distance=straight.push.distance),
        gravity=straight.gravity,
    )
    distances = np.linspace(0.0, 0.03, 11)[1:]
    np.testing.assert_allclose(loads(moved, 10, 12, distances), loads(straight, 10, 12, distances), rtol=1e-7)


def test_a_structure_that_cannot_carry_its_weight_is_reported() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.1, gravity=9810.0)
    with pytest.raises(NotConverged, match="own weight"):
        pushover(scene)


def test_a_mechanism_is_told_instead_of_an_empty_path() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.05)
    hinged = msgspec.structs.replace(scene.members["beam"], releases=("from",))
    with pytest.raises(NotConverged, match=r"beyond a displacement of 0 m.*take a release out"):
        pushover(msgspec.structs.replace(scene, members={"beam": hinged}))


def test_a_table_that_grows_steeper_is_refused() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.1)
    steel = parse_material("curve=0.001:200 0.01:210 0.02:300 MPa")
    member = msgspec.structs.replace(scene.members["beam"], material=steel)
    with pytest.raises(InputError, match=r"members\.beam\.material: its stress–strain curve grows steeper"):
        pushover(msgspec.structs.replace(scene, members={"beam": member}))


def test_a_cantilever_of_a_table_follows_the_integrated_curvature() -> None:
    """Deflection at a tip load by ∫ κ(P x) x dx with the exact moment–curvature of `capacity`."""
    steel = parse_material("curve=0.0011:231 0.004:260 0.02:320 0.15:400 MPa")
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.1)
    member = msgspec.structs.replace(scene.members["beam"], material=steel)
    answer = pushover(msgspec.structs.replace(scene, members={"beam": member}))
    curvature = np.append(np.linspace(0.0, 0.1, 300), np.linspace(0.1, 2.0, 1500)[1:])
    moment = moment_curvature(member.section, steel, curvature).moment
    arm = np.linspace(0.0, 1.0, 2001)
    for share in (0.3, 0.6, 0.9, 1.0):
        load = share * answer.load[-1]
        deflection = np.trapezoid(np.interp(load * arm, moment, curvature) * arm, arm)
        found = float(np.interp(deflection, answer.displacement, answer.load))
        assert found == pytest.approx(load, rel=1e-3)
