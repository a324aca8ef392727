"""What calibration decides, on other members than the built-in one."""

import msgspec
import numpy as np
import pytest
from cantilevers import SECTIONS, cantilever, reference_cantilever
from conftest import CASES
from frames import fixed_fixed, propped

from calibration import calibrate
from calibration.member_plans import MemberPlan
from calibration.planner import candidates, groups, relative_cost
from scene import parse_scene


@pytest.mark.parametrize("name", SECTIONS)
@pytest.mark.parametrize("target", [0.01, 0.004])
def test_target_is_met_and_the_model_follows_the_closed_form(name: str, target: float) -> None:
    """Cases C1: the model's own distance from the closed form is the one reported, within the reference's error."""
    result = calibrate(reference_cantilever(CASES[name]), target)
    outputs = CASES[name]["outputs"]
    assert result.target_met
    x, exact = np.array(outputs["delta_over_dy"]) * outputs["delta_y_m"], np.array(outputs["P_N"])
    load = np.interp(x, result.best.push.displacement, result.best.push.load)
    assert np.abs(load - exact).max() / exact.max() <= target + result.reference.error_estimate
    if target == 0.01:
        assert result.best.push.bodies <= 8


def test_shear_flexibility_is_in_both_models() -> None:
    scene = cantilever("rectangle 50x100 mm", 0.4, 0.012, theory="timoshenko")
    scene = msgspec.structs.replace(scene, reference="beam")
    result = calibrate(scene, 0.01)
    c = scene.capacity("beam")
    stiffness = 1.0 / (0.4**3 / (3.0 * c.EI) + 0.4 / c.GA_s)
    for curve in (result.reference, result.best.push):
        early = (curve.load > 0.0) & (curve.load < 0.4 * curve.load.max())
        slope = curve.displacement[early] @ curve.load[early] / (curve.displacement[early] @ curve.displacement[early])
        assert slope == pytest.approx(stiffness, rel=3e-3)


def test_shear_beyond_what_beams_know_is_named() -> None:
    """A cantilever of IPE 300 shorter than its depth: M_p / L is above Q_max, and the reference's beams do not mind."""
    scene = cantilever("IPE 300", 0.25, 0.002, theory="timoshenko")
    result = calibrate(scene, 0.01)
    assert result.target_met
    over = result.reference.load[-1] / scene.capacity("beam").Q_max
    assert over > 1.5
    assert any(f"shear comes to {100.0 * over:.0f} % of Q_max" in remark for remark in result.remarks)


def test_own_weight_is_carried_before_the_push() -> None:
    """Collapse at P = (M_p - q L² / 2) / L, in the reference and in the model."""
    scene = cantilever("rectangle 20x40 mm", 2.0, 0.3, gravity=9.81)
    collapse = (scene.capacity("beam").M_max - 7850 * 9.81 * 0.0008 * 2.0) / 2.0
    result = calibrate(scene, 0.02)
    assert result.target_met
    assert result.reference.load[-1] == pytest.approx(collapse, rel=1e-3)
    assert result.best.push.load.max() == pytest.approx(collapse, rel=0.02)


def test_hardening_is_in_both_models() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.05)
    hard = type(scene)(
        title="hardening",
        nodes=scene.nodes,
        members={
            "beam": type(scene.members["beam"])(
                start="root",
                end="tip",
                section=scene.members["beam"].section,
                material=type(scene.members["beam"].material)("", 210e9, 235e6, 7850.0, 0.3, 0.02 * 210e9),
                theory="euler-bernoulli",
            )
        },
        pushed=scene.push,
        gravity=scene.gravity,
    )
    result = calibrate(hard, 0.01)
    assert result.target_met
    assert result.reference.load[-1] > 1.05 * 29375.0


def cantilever_on_column() -> str:
    return """
    title = "beam on a column"
    gravity = 0.0
    [nodes.foot]
    at = [0.0, 0.0]
    support = "clamped"
    [nodes.knee]
    at = [0.0, 3.0]
    [nodes.tip]
    at = [3.0, 3.0]
    [members.column]
    from = "foot"
    to = "knee"
    section = "HEB 300"
    material = "S235"
    [members.beam]
    from = "knee"
    to = "tip"
    section = "IPE 200"
    material = "S235"
    [push]
    node = "tip"
    direction = [0, -1]
    distance = 0.2
    """


YIELDING, ELASTIC = MemberPlan("elastic-plastic", 1.4, 0.5), MemberPlan("elastic", 0.31, 0.4)


def test_models_are_tried_from_cheap_to_dear_and_differ_in_what_yields() -> None:
    scene = propped(0.02)
    models = candidates(scene, {"A-C": YIELDING, "C-B": ELASTIC})
    costs = [relative_cost(model, scene.members) for model in models]
    assert costs == sorted(costs)
    assert len(set(models)) == len(models)
    assert {model.of("C-B").joints for model in models} == {3}
    assert len({model.of("A-C") for model in models}) > 10


def test_members_alike_are_one_group() -> None:
    scene = fixed_fixed(0.05)
    assert groups(scene, {"A-C": YIELDING, "C-B": YIELDING}) == [["A-C", "C-B"]]
    assert groups(scene, {"A-C": YIELDING, "C-B": ELASTIC}) == [["A-C"]]


def test_a_member_that_stays_elastic_gets_three_elastic_joints_and_the_report_says_why() -> None:
    """A column of HEB 300 under a beam of IPE 200 that folds: both are followed within the target."""
    text = cantilever_on_column()
    result = calibrate(parse_scene(text, "test"), 0.01)
    assert result.target_met
    assert result.plans["column"].kind == "elastic"
    assert result.plans["beam"].kind == "elastic-plastic"
    model = result.best.model
    assert (model.of("column").joints, model.of("column").law) == (3, "elastic-plastic")
    used = result.plans["column"].utilisation
    assert 0.0 < used < 1.0
    assert used == pytest.approx(
        result.reference.load[-1] * 3.0 / result.capacity["column"].M_yield
        + result.reference.load[-1] / result.capacity["column"].N_max,
        rel=0.02,
    )
    assert "3 elastic joints" in result.why("column")
    assert "fibres" in result.why("beam") or "interaction" in result.why("beam")


@pytest.mark.parametrize("target", [0.0, -0.1, 1.0])
def test_impossible_targets_are_refused(target: float) -> None:
    with pytest.raises(ValueError, match="between 0 and 1"):
        calibrate(cantilever("rectangle 50x100 mm", 1.0, 0.05), target)
