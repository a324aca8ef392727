"""Reference cases as scene files, calibrated; all of them are run by benchmarks/open_cases.py."""

import numpy as np
import pytest
from conftest import CASES
from open_scenes import open_scenes

from calibration import calibrate
from scene import parse_scene

SCENES = open_scenes(CASES)


@pytest.mark.parametrize(
    ("name", "target"),
    [
        ("C2-fixedfixed-udl", 0.01),
        ("C2-propped-centre", 0.003),
        ("C2-portal-table-L4-HV0.3", 0.01),
        ("C4-rect-n0.5-p-delta", 0.01),
        ("C3-rect", 0.01),
    ],
)
def test_the_cheapest_model_tried_that_meets_the_target_is_chosen(name: str, target: float) -> None:
    result = calibrate(parse_scene(SCENES[name], name), target)
    assert result.target_met
    assert result.limit == ""
    met = [trial.cost for trial in result.trials if trial.errors.path_max <= target]
    assert result.best.cost == min(met)
    assert result.best.push.unconverged == 0


def test_a_clamped_beam_under_an_even_load_carries_all_of_it() -> None:
    """C2-fixedfixed-udl: elastic stiffness 384 EI / L⁴ of the load per length; bits of members at nodes bear theirs."""
    scene = parse_scene(SCENES["C2-fixedfixed-udl"], "test")
    result = calibrate(scene, 0.02)
    assert result.best.errors.stiffness == pytest.approx(0.0, abs=2e-3)
    outputs = CASES["C2-fixedfixed-udl"]["outputs"]["distributed"]
    load = np.interp(outputs["delta_mid_m"], result.best.push.displacement, result.best.push.load)
    collapse = CASES["C2-fixedfixed-udl"]["outputs"]["concentrated_hinge"]["w2_collapse_N_per_m"]
    assert np.abs(load / collapse - outputs["w_over_wp"]).max() <= 0.02 + result.reference.error_estimate
