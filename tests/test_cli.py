"""The command line is a contract: keys, exit statuses, messages, files."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import ductile
from conftest import CASES

from scene import builtin_text


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    """`ductile calibrate cantilever --json` in a process of its own, and the folder it wrote."""
    folder = tmp_path_factory.mktemp("run")
    done = subprocess.run(
        [sys.executable, "-m", "calibration.cli", "calibrate", "cantilever", "--json"],
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parent.parent)},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), folder / "out" / "cantilever"


def test_calibrate_prints_the_keys_of_the_contract(calibrated: tuple[dict[str, Any], Path]) -> None:
    answer, _ = calibrated
    assert answer["scene"] == "cantilever"
    assert set(answer["capacity"]["beam"]) >= {"N_max", "Q_max", "M_max"}
    assert set(answer["reference"]) >= {"method", "displacement", "load", "error_estimate", "seconds"}
    wanted = {"rule", "bodies", "joints", "law", "dt", "iterations", "displacement", "load", "seconds"}
    assert set(answer["model"]) >= wanted
    assert set(answer["errors"]) >= {"path_max", "stiffness", "collapse_load"}
    assert set(answer["speed"]) >= {"seconds_per_simulated_second", "microseconds_per_joint_step"}
    for tried in answer["pareto"]:
        assert set(tried) >= {"rule", "joints", "law", "dt", "iterations", "path_max", "seconds"}
    assert answer["target_error"] == 0.01
    assert answer["target_met"] is True


def test_reference_follows_the_closed_form(calibrated: tuple[dict[str, Any], Path]) -> None:
    """The 20 points of case C1-rect within 0.2 %."""
    answer, outputs = calibrated[0], CASES["C1-rect"]["outputs"]
    x = np.array(outputs["delta_over_dy"]) * outputs["delta_y_m"]
    load = np.interp(x, answer["reference"]["displacement"], answer["reference"]["load"])
    np.testing.assert_allclose(load, outputs["P_N"], rtol=2e-3)
    assert answer["reference"]["error_estimate"] <= 0.01 / 5.0


def test_model_is_within_one_percent_with_few_bodies(calibrated: tuple[dict[str, Any], Path]) -> None:
    answer = calibrated[0]
    model, reference = answer["model"], answer["reference"]
    load = np.interp(reference["displacement"], model["displacement"], model["load"])
    path = np.abs(load - reference["load"]).max() / np.abs(reference["load"]).max()
    assert path == pytest.approx(answer["errors"]["path_max"], rel=1e-9)
    assert path <= 0.01
    assert model["bodies"] <= 8
    assert model["unconverged"] == 0


def test_the_model_chosen_is_the_cheapest_tried_that_meets_the_target(calibrated: tuple[dict[str, Any], Path]) -> None:
    tried = calibrated[0]["pareto"]
    met = [trial for trial in tried if trial["path_max"] <= 0.01]
    assert min(met, key=lambda trial: trial["cost"])["path_max"] == calibrated[0]["errors"]["path_max"]
    assert min(trial["path_max"] for trial in tried if trial not in met) > 0.01
    assert {trial["law"] for trial in tried} >= {"elastic-plastic", "fibre"}


def test_files_are_complete(calibrated: tuple[dict[str, Any], Path]) -> None:
    answer, folder = calibrated
    names = {"report.html", "report.md", "calibration.json", "joints.json", "reference.csv", "model.csv"}
    assert {path.name for path in folder.iterdir()} == names
    assert [path.name for path in folder.parent.iterdir()] == ["cantilever"]
    assert json.loads((folder / "calibration.json").read_text()) == answer
    curve = np.loadtxt(folder / "reference.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(curve[:, 1], answer["reference"]["load"])


def test_result_says_what_members_need_and_how_far_each_kind_of_answer_is_off(
    calibrated: tuple[dict[str, Any], Path],
) -> None:
    answer, folder = calibrated
    assert answer["limit"] == ""
    assert answer["members"]["beam"]["kind"] == "elastic-plastic"
    assert answer["members"]["beam"]["utilisation"] == pytest.approx(1.5, rel=1e-3)  # M_p / M_yield of a rectangle
    assert abs(answer["errors"]["frequency"]) < 1e-3
    assert [hinge["where"] for hinge in answer["hinges"]] == ["root"]
    assert answer["hinges_in_order"] is True
    markdown = (folder / "report.md").read_text(encoding="utf-8")
    page = (folder / "report.html").read_text(encoding="utf-8")
    for title in ("Capacities", "What each member needs", "Errors", "Hinges", "Joints", "Speed against error"):
        assert f"## {title}\n" in markdown
        assert f"<h2>{title}</h2>" in page
    assert markdown.count("| 2 |") >= len(answer["pareto"])  # iterations of every model tried


def test_page_stands_alone(calibrated: tuple[dict[str, Any], Path]) -> None:
    page = (calibrated[1] / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 2
    assert "Target met" in page
    # Names of XML vocabularies are no addresses to fetch from.
    fetched = re.findall(r"<(?:script|link|img|iframe)\b[^>]*(?:src|href)=|url\(\s*['\"]?http|@import", page)
    assert not fetched
    assert "nan" not in page.lower().replace("finance", "")


def test_joint_table_builds_the_same_bodies_elsewhere(calibrated: tuple[dict[str, Any], Path]) -> None:
    table = json.loads((calibrated[1] / "joints.json").read_text())
    assert len(table["bodies"]) == calibrated[0]["model"]["bodies"]
    assert len(table["joints"]) == calibrated[0]["model"]["joints"]
    assert sum(body["mass"] for body in table["bodies"]) == pytest.approx(7850 * 0.005)
    assert table["joints"][0]["a"] == "ground"
    assert sum(joint["length"] for joint in table["joints"]) == pytest.approx(1.0, abs=0.05)
    for joint in table["joints"]:
        assert joint["elastic_stiffness"]["rotation"] == pytest.approx(875000.0 / joint["length"])
        assert sum(joint["law"]["area"]) == pytest.approx(0.005)
        assert joint["anchor_b"][1] == pytest.approx(0.0, abs=1e-12)


def test_running_again_gives_the_same_numbers(
    calibrated: tuple[dict[str, Any], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ductile("calibrate", "cantilever", "--json", "-o", str(tmp_path / "again")) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["errors"] == calibrated[0]["errors"]
    assert again["model"]["load"] == calibrated[0]["model"]["load"]
    assert again["reference"]["load"] == calibrated[0]["reference"]["load"]
    one, other = ((folder / "joints.json").read_bytes() for folder in (calibrated[1], tmp_path / "again"))
    assert one == other


def test_target_that_is_not_met_ends_with_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("calibrate", "cantilever", "--target-error", "0.02 %", "-o", str(tmp_path / "o")) == 1
    shown = capsys.readouterr().out
    assert shown.startswith("Target missed")
    assert "What limits it" in shown
    assert (tmp_path / "o" / "report.html").exists()


def test_report_begins_with_the_verdict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("calibrate", "cantilever", "-o", str(tmp_path / "o")) == 0
    said = capsys.readouterr().out
    assert said.startswith("Target met")
    assert "29.38 kN m" in said


@pytest.mark.parametrize(("criterion", "share"), [("tresca", 0.5), ("von-mises", 0.5773502691896258)])
def test_capacity_of_a_rectangle(criterion: str, share: float, capsys: pytest.CaptureFixture[str]) -> None:
    """The paper's Table 1: N = b h fy, Q = 0.5 (0.577) b h fy, M = 0.25 b h² fy."""
    status = ductile("capacity", "rectangle 50x100 mm", "--material", "S235", "--criterion", criterion, "--json")
    assert status == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["N_max"] == pytest.approx(0.05 * 0.1 * 235e6, rel=1e-12)
    assert answer["Q_max"] == pytest.approx(share * 0.05 * 0.1 * 235e6, rel=1e-12)
    assert answer["M_max"] == pytest.approx(0.25 * 0.05 * 0.1**2 * 235e6, rel=1e-12)


def test_scenes_are_listed_and_written_out(capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("scenes") == 0
    assert "cantilever" in capsys.readouterr().out
    assert ductile("scenes", "cantilever") == 0
    assert capsys.readouterr().out == builtin_text("cantilever")


BAD = [
    (["calibrate", "nowhere.toml"], "no such file"),
    (["calibrate", "cantilevr"], "did you mean cantilever"),
    (["calibrate", "cantilever", "--target-error", "5 kg"], "--target-error"),
    (["calibrate", "cantilever", "--target-error", "0"], "greater than zero"),
    (["calibrate", "cantilever", "--target-error", "200 %"], "not below 100 %"),
    (["calibrate", "cantilever", "--tagret-error", "1 %"], "--tagret-error"),
    (["calibrate"], "SCENE"),
    (["calibrat", "cantilever"], "calibrat"),
    (["capacity", "IPE 305"], "did you mean"),
    (["capacity", "IPE 300", "--material", "S999"], "no known grade"),
    (["capacity", "IPE 300", "--criterion", "rankine"], "tresca or von-mises"),
    (["scenes", "nosuch"], "no scene"),
]


@pytest.mark.parametrize(("tokens", "fault"), BAD, ids=lambda value: " ".join(value) if isinstance(value, list) else "")
def test_bad_input_ends_with_2_and_one_plain_line(
    tokens: list[str], fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ductile(*tokens) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.startswith("ductile: ")
    assert error.count("\n") == 1
    assert fault in error
    assert "Traceback" not in error
    assert not list(tmp_path.iterdir())


def test_faults_in_a_scene_file_leave_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("my.toml").write_text(builtin_text("cantilever").replace("distance", "distanc"), encoding="utf-8")
    assert ductile("calibrate", "my.toml") == 2
    assert 'my.toml > push: unknown key "distanc"' in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["my.toml"]


def test_output_that_is_a_file_is_refused_before_the_work(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taken").write_text("mine")
    assert ductile("calibrate", "cantilever", "-o", str(tmp_path / "taken")) == 2
    assert "is a file" in capsys.readouterr().err
    assert (tmp_path / "taken").read_text() == "mine"


def test_a_scene_that_cannot_stand_is_told_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "heavy.toml"
    scene.write_text(builtin_text("cantilever").replace('"0 m/s^2"', '"9810 m/s^2"'), encoding="utf-8")
    assert ductile("calibrate", str(scene), "-o", str(tmp_path / "o")) == 2
    assert "own weight" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize("command", [["simulate"], ["calibrate"], ["export", "--engine", "json"], ["study"], ["fit"]])
def test_joints_are_of_one_material(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    two = "rectangle 50x100 mm of S355 + rectangle 50x10 mm at 0,100 mm"
    Path("two.toml").write_text(builtin_text("cantilever").replace("rectangle 50x100 mm", two), encoding="utf-8")
    assert ductile(command[0], "two.toml", *command[1:]) == 2
    assert "members.beam.section: joints are of one material" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["two.toml"]
