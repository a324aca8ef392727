"""Every example runs and gives its number; the README quotes the same."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
EXAMPLES = {
    "01_capacity": (147.7, 0.05),  # kN m: W_pl = 628.4 cm³ (EN 10365 tables) times 235 MPa
    "02_reference": (29.375, 0.001),  # kN: b h² fy / 4 L
    # rad: with the force and its moment kept for 1/60 s, as they are given, the second-order scheme finds 0.892 in
    # steps of 1/15360 s and 0.893 of 1/60000 s; with the moment that the turning shelf leaves it at each of them,
    # steps of 1/20000 s give 0.817
    "03_joints_in_a_space": (-0.889, 0.0089),
    "04_calibrate": (0.68, 0.01),  # % of the peak load
    "05_car_on_ramp": (16.3, 0.1),  # %: the original's own code at the same step
    "06_plate_with_a_hole": (1.002, 0.001),  # Gaydon & McCrum (1954): 1, which finite elements approach from above
    # mm: 200 kg x 9.81 x 0.4 m / (9261 N m - 200 kg x 9.81 x 0.85 m) = 103 mm, less a tenth for blow and vibration;
    # steps of 1/32000 s give 92.8
    "07_section_to_game_loop": (92.8, 2.0),
}


def run(name: str) -> float:
    spec = importlib.util.spec_from_file_location(name, ROOT / "examples" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return float(module.main())


def test_every_example_is_tested() -> None:
    assert {path.stem for path in (ROOT / "examples").glob("*.py")} == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_example(name: str) -> None:
    value, tolerance = EXAMPLES[name]
    assert run(name) == pytest.approx(value, abs=tolerance)


def test_readme_quotes_the_examples(capsys: pytest.CaptureFixture[str]) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"within {run('04_calibrate'):.2f} %" in readme
    said = capsys.readouterr().out
    assert said.startswith("5 bodies")
    assert "five rigid bodies" in readme
    assert f"{run('01_capacity'):.1f} kN m" in readme
