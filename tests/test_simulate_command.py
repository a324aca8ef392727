"""`ductile simulate`: keys, files, messages."""

import csv
import json
import re
from pathlib import Path

import pytest
from test_cli import ductile

from calibration.simulate_command import run
from scene import builtin_names, builtin_text, load_scene, parse_scene
from sim import MemberModel
from sim.scene_model import model_of
from sim.world import World


def test_the_answer_has_measures_joints_and_speed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("simulate", "block-under-tension", "--json", "--csv", "-o", str(tmp_path / "o")) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["measures"]["impulse in the end"] == pytest.approx(1000.0)
    assert answer["units"]["impulse in the end"] == "N s"
    assert answer["measures"]["block hits the ground"] is None
    assert (answer["steps"], answer["dt"]) == (60, pytest.approx(1 / 60))
    assert answer["joints"]["broken"] == []
    assert answer["unconverged"] == 0
    assert answer["energy"]["plastic"] == answer["joints"]["plastic_work"] == 0.0
    assert json.loads((tmp_path / "o" / "simulation.json").read_text()) == answer
    with (tmp_path / "o" / "joints.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 60
    assert {row["joint"] for row in rows} == {"hanger"}
    assert float(rows[-1]["N_N"]) == pytest.approx(60e3, rel=1e-6)
    assert float(rows[-1]["time_s"]) == pytest.approx(1.0)


def test_a_run_tells_how_far_and_how_fast_it_is() -> None:
    """What the progress bar shows: simulated time, the real-time factor, and the share done."""
    told: list[tuple[str, float]] = []
    world = World(load_scene("own-weight-beam"))
    run(world, lambda: None, lambda what, share: told.append((what, share)))
    shares = [share for _, share in told]
    assert shares == sorted(shares)
    assert 0.0 < shares[0] < 0.2
    assert 0.9 < shares[-1] <= 1.0
    assert all(re.fullmatch(r"\d+\.\d\d s simulated, [\d.e+]+ × real time", what) for what, _ in told)


def test_options_replace_what_the_scene_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--dt", "1/240 s", "--iterations", "3", "--duration", "0.1 s", "--json", "-o", str(tmp_path / "o")]
    assert ductile("simulate", "block-under-tension", *options) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["steps"], answer["iterations"]) == (24, 3)
    assert answer["simulated_seconds"] == pytest.approx(0.1)


def test_a_person_gets_a_table_with_units(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("simulate", "post-impact", "-o", str(tmp_path / "o")) == 0
    said = capsys.readouterr().out
    assert said.startswith("Steel post struck by a ball")
    assert "foot at 0.0" in said
    assert "m/s" in said
    assert "× real time" in said


@pytest.mark.parametrize(("law", "hardened"), [("", True), ('law = "fibre"', True), ('law = "elastic-plastic"', False)])
def test_hardening_is_followed_or_said_to_be_left_out(
    law: str, hardened: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With E_t = 5 GPa the tip takes a third more than M_p / L = 29.4 kN."""
    text = builtin_text("cantilever").replace('rho=7850 kg/m^3"', 'rho=7850 kg/m^3, Et=5 GPa"')
    file = tmp_path / "hard.toml"
    file.write_text(f"{text}\n[simulation]\n{law}\n", encoding="utf-8")
    options = ["--json", "--no-reference", "-o", str(tmp_path / "o")]
    assert ductile("simulate", str(file), *options) == 0
    out, error = capsys.readouterr()
    assert json.loads(out)["push"]["load"] == pytest.approx(39.5e3 if hardened else 29.4e3, rel=0.01)
    assert ("leaves hardening out" in error) is not hardened


def test_what_is_pushed_has_the_joints_that_follow_a_curve() -> None:
    pushed = builtin_text("cantilever")
    moved = parse_scene(pushed[: pushed.index("[push]")] + '[motion]\nduration = "0.1 s"\nvelocity = [0, -1]', "moved")
    few = parse_scene(f"{pushed}\n[simulation]\njoints = 5\n", "few")
    assert set(model_of(load_scene("cantilever")).members.values()) == {MemberModel("graded", 9, "fibre", 16)}
    assert set(model_of(moved).members.values()) == {MemberModel("lobatto", 9, "fibre", 16)}
    assert set(model_of(few).members.values()) == {MemberModel("lobatto", 5, "fibre", 16)}
    assert set(model_of(load_scene("loaded-cantilever")).members.values()) == {
        MemberModel("equal", 5, "elastic-plastic", 8)
    }


def test_schema_names_every_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("scenes", "--schema") == 0
    schema = json.loads(capsys.readouterr().out)
    tables = schema["$defs"]["Scene"]["properties"]
    assert {"nodes", "members", "push", "simulation", "bodies", "joints", "vehicles", "grounds", "measures"} <= set(
        tables
    )
    assert schema["$defs"]["Node"]["required"] == ["at"]


def test_scenes_are_listed_in_one_line_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("scenes") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == builtin_names()
    assert all(len(line) <= 120 for line in lines)


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        (["nosuch"], "no scene"),
        (["cantilever", "--dt", "5 kg"], "--dt"),
        (["cantilever", "--dt", "0 s"], "greater than zero"),
        (["cantilever", "--iterations", "0"], "--iterations"),
        (["cantilever", "--iterations", "2.5"], "--iterations"),
        (["cantilever", "--duration", "2 s"], "a push ends at its last stop"),
    ],
)
def test_bad_input_ends_with_2_and_leaves_nothing(
    options: list[str], fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ductile("simulate", *options) == 2
    out, error = capsys.readouterr()
    assert (out, error.count("\n")) == ("", 1)
    assert fault in error
    assert not list(tmp_path.iterdir())
