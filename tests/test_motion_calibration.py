"""Scenes that move, calibrated: a mass on a beam under a sudden load, elastic and beyond."""

import json
import math
from pathlib import Path

import pytest
from command_line import ductile
from frames import frame_text

from calibration.comparable_motion import follow_model
from scene import parse_scene
from sim import Model

LENGTH, MASS = 1.5, 500.0
SLENDER = "rectangle 100x40 mm"


def sudden(share: float, duration: float) -> str:
    """A cantilever of 50 × 100 mm with a heavy mass at its tip; P is a share of M_p / L."""
    P = share * 0.05 * 0.1**2 / 4.0 * 235e6 / LENGTH
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (LENGTH, 0.0, "free")}
    load = f'node = "B"\nforce = [0.0, {-P!r}]\nkind = "step"'
    motion = f'[motion]\nduration = {duration!r}\nwatch = "B"\ndirection = [0, -1]'
    text = frame_text(nodes, [("A", "B")], motion, [load], section="rectangle 50x100 mm")
    return text.replace('support = "free"', f'support = "free"\nmass = {MASS!r}')


def test_a_sudden_elastic_load_sags_twice_as_far_at_the_frequency_of_one_mass(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Peak 2 P L³ / 3 EI, ω² = 3 EI / (M + 33/140 m) L³ (Rayleigh), rest at half the peak."""
    (tmp_path / "scene.toml").write_text(sudden(0.3, 0.1))
    arguments = ("--target-error", "3 %", "-o", str(tmp_path / "out"), "--json")
    assert ductile("calibrate", str(tmp_path / "scene.toml"), *arguments) == 0
    whole = json.loads(capsys.readouterr().out)
    EI = 210e9 * 0.05 * 0.1**3 / 12.0
    static = 0.3 * 0.05 * 0.1**2 / 4.0 * 235e6 / LENGTH * LENGTH**3 / (3.0 * EI)
    assert whole["reference"]["peak"] == pytest.approx(2.0 * static, rel=0.01)
    assert max(map(abs, whole["model"]["displacement"])) == pytest.approx(2.0 * static, rel=0.04)
    assert whole["model"]["law"] == "elastic-plastic"
    assert abs(whole["errors"]["peak"]) <= 0.03
    assert abs(whole["errors"]["residual"]) <= 0.03
    assert abs(whole["errors"]["frequency"]) <= 0.002
    assert whole["errors"]["plastic_work"] is None
    mass = MASS + 33.0 / 140.0 * 7850.0 * 0.005 * LENGTH
    period = 2.0 * math.pi / math.sqrt(3.0 * EI / (mass * LENGTH**3))
    time = whole["reference"]["time"]
    first = max(range(len(time)), key=lambda i: whole["reference"]["displacement"][i] if time[i] < period else 0.0)
    assert time[first] == pytest.approx(0.5 * period, rel=0.02)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        *("report.html", "report.md", "calibration.json"),
        *("joints.json", "reference.csv", "model.csv"),
    }
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "displacement at rest" in page
    assert "first natural frequency" in page


def test_what_stays_bent_is_part_of_the_target(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "scene.toml").write_text(sudden(0.7, 0.15))
    arguments = ("--target-error", "3 %", "-o", str(tmp_path / "out"))
    assert ductile("calibrate", str(tmp_path / "scene.toml"), *arguments) == 0
    assert capsys.readouterr().out.startswith("Target met. ")
    whole = json.loads((tmp_path / "out" / "calibration.json").read_text(encoding="utf-8"))
    assert whole["model"]["dissipated"] > 0.0
    met = [tried for tried in whole["pareto"] if max(abs(tried["peak"]), abs(tried["residual"])) <= 0.03]
    assert whole["errors"]["peak"] in {tried["peak"] for tried in met}
    assert abs(whole["errors"]["residual"]) <= 0.03


def test_each_member_is_given_what_it_needs_and_why(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A beam on a stub column: the beam yields at its root, and a stiff arm that nothing bears on is a rigid piece."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (LENGTH, 0.0, "free"), "C": (LENGTH, 0.1, "free")}
    load = f'node = "B"\nforce = [0.0, {-0.7 * 0.05 * 0.1**2 / 4.0 * 235e6 / LENGTH!r}]\nkind = "step"'
    motion = '[motion]\nduration = 0.15\nwatch = "B"\ndirection = [0, -1]'
    text = frame_text(nodes, [("A", "B"), ("B", "C")], motion, [load], section="rectangle 50x100 mm")
    text = text.replace("[nodes.C]", f"mass = {MASS!r}\n[nodes.C]")
    (tmp_path / "scene.toml").write_text(text)
    arguments = ("--target-error", "3 %", "-o", str(tmp_path / "out"), "--json")
    assert ductile("calibrate", str(tmp_path / "scene.toml"), *arguments) == 0
    whole = json.loads(capsys.readouterr().out)
    beam, arm = whole["members"]["A-B"], whole["members"]["B-C"]
    assert beam["kind"] == "elastic-plastic"
    assert beam["utilisation"] > 1.0
    assert "times the forces of first yield" in beam["why"]
    assert arm["kind"] == "rigid"
    assert arm["model"]["joints"] == 2
    assert "one rigid piece" in arm["why"]
    # The only hinge is that of the root.
    (hinge,) = whole["hinges"]
    assert hinge["where"] == "A"
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "What each member needs" in page
    assert arm["why"] in page


@pytest.mark.parametrize("kinematics", ["small", "large"])
def test_small_displacements_are_proportional_to_the_velocity_they_begin_with(kinematics: str) -> None:
    def peak(velocity: float) -> float:
        nodes = {"A": (0.0, 0.0, "clamped"), "B": (2.0, 0.0, "free"), "C": (4.0, 0.0, "clamped")}
        motion = '[motion]\nduration = 0.06\nwatch = "B"\ndirection = [0, -1]'
        strong = "fy=1e6 MPa, E=210 GPa, rho=7850 kg/m^3"
        text = frame_text(
            nodes, [("A", "B"), ("B", "C")], motion, section=SLENDER, material=strong, kinematics=kinematics
        )
        struck = f"mass = 500.0\nvelocity = [0.0, {-velocity!r}]\n[nodes.C]"
        model = Model("lobatto", 4, "elastic-plastic", dt=1e-3, scheme=(0.2601, 0.02))
        return follow_model(parse_scene(text.replace("[nodes.C]", struck), "test"), model).peak

    ratio = peak(20.0) / peak(2.0)
    if kinematics == "small":
        assert ratio == pytest.approx(10.0, rel=1e-3)
    else:
        assert ratio < 9.0  # stretched between its ends, the beam is stiffer the further it goes


def test_scenes_without_push_or_motion_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = "[simulation]\nduration = 0.1"
    (tmp_path / "scene.toml").write_text(sudden(0.3, 0.15).split("[motion]")[0] + run)
    assert ductile("calibrate", str(tmp_path / "scene.toml"), "-o", str(tmp_path / "out")) == 2
    assert "add [push] or [motion]" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
