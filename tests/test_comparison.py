"""`ductile compare`: what a project's own checks ask of two calibrations."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from command_line import ductile

from calibration import calibrate
from calibration.export import calibration_object
from scene import load_scene


@pytest.fixture(scope="module")
def calibration() -> dict[str, Any]:
    return json.loads(json.dumps(calibration_object(calibrate(load_scene("cantilever"), 0.05))))


@pytest.fixture
def pair(tmp_path: Path, calibration: dict[str, Any]) -> tuple[str, str, dict[str, Any]]:
    """The calibration as one file, the name of another, and a copy to be changed and written there."""
    before, after = tmp_path / "before.json", tmp_path / "after.json"
    before.write_text(json.dumps(calibration))
    return str(before), str(after), copy.deepcopy(calibration)


def test_the_same_calibration_has_not_changed(pair: tuple[str, str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    before, _, _ = pair
    assert ductile("compare", before, before) == 0
    assert "Nothing changed" in capsys.readouterr().out


@pytest.mark.parametrize(("growth", "status"), [(0.0009, 0), (0.0011, 1), (-0.01, 0)])
def test_an_error_that_grows_past_the_tolerance_ends_with_1(
    growth: float, status: int, pair: tuple[str, str, dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    before, after, changed = pair
    changed["errors"]["path_max"] += growth
    Path(after).write_text(json.dumps(changed))
    assert ductile("compare", before, after, "--json") == status
    answer = json.loads(capsys.readouterr().out)
    assert answer["grown"] == (["errors.path_max"] if status else [])
    assert [change["name"] for change in answer["changes"]] == ["errors.path_max"]
    assert ductile("compare", before, after, "--tolerance", "0.2 %") == 0


def test_signed_errors_count_by_their_size(pair: tuple[str, str, dict[str, Any]]) -> None:
    before, after, changed = pair
    changed["errors"]["collapse_load"] = -abs(changed["errors"]["collapse_load"]) - 0.002
    Path(after).write_text(json.dumps(changed))
    assert ductile("compare", before, after) == 1


@pytest.mark.parametrize("value", [None, float("nan")])
def test_an_error_that_is_not_given_any_more_counts_as_grown(
    value: float | None, pair: tuple[str, str, dict[str, Any]]
) -> None:
    before, after, changed = pair
    changed["errors"]["path_max"] = value
    Path(after).write_text(json.dumps(changed))
    assert ductile("compare", before, after) == 1


def test_model_capacity_and_speed_are_told_but_pass(
    pair: tuple[str, str, dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    before, after, changed = pair
    changed["model"]["rule"] = "equal"
    changed["capacity"]["beam"]["M_max"] *= 2.0
    changed["speed"]["microseconds_per_joint_step"] *= 3.0
    Path(after).write_text(json.dumps(changed))
    assert ductile("compare", before, after) == 0
    said = capsys.readouterr().out
    for text in ("model.rule", "lobatto", "equal", "capacity.beam.M_max", "speed.microseconds_per_joint_step"):
        assert text in said
    assert "2" in next(line for line in said.splitlines() if "M_max" in line).split()[-1]


@pytest.mark.parametrize(
    ("content", "fault"),
    [(None, "no such file"), ("{", "is not JSON"), ("[1]", "is not a calibration"), ("{}", "is not a calibration")],
)
def test_bad_files_end_with_2_and_one_plain_line(
    content: str | None, fault: str, pair: tuple[str, str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    before, after, _ = pair
    if content is not None:
        Path(after).write_text(content)
    for tokens in ((before, after), (after, before)):
        assert ductile("compare", *tokens) == 2
        out, error = capsys.readouterr()
        assert out == ""
        assert error.count("\n") == 1
        assert fault in error
        assert after in error
