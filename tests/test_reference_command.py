"""`ductile reference`: keys, files, cache, exit statuses."""

import csv
import json
from pathlib import Path
from typing import Any

import meshio
import pytest
from command_line import ductile

from calibration import reference_command
from calibration.result_cache import content_key
from scene import builtin_text, parse_scene


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)


def test_json_and_files(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert ductile("reference", "cantilever", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert {"displacement", "load", "hinges", "error_estimate", "method", "seconds"} <= set(found)
    assert found["load"][-1] == pytest.approx(29375.0, rel=1e-4)  # M_p / L
    assert [hinge["node"] for hinge in found["hinges"]] == ["root"]
    assert found["outcome"].startswith("mechanism")
    folder = tmp_path / "out" / "cantilever"
    tables = {"reference.csv", "hinges.csv", "sections.csv", "reference.svg"}
    series = {"fields.pvd", *(f"fields-{i:02d}.vtu" for i in range(13))}
    assert {file.name for file in folder.iterdir()} == tables | series
    assert found["members"]["beam"]["error_estimate"]["moment"]
    last = meshio.read(folder / "fields-12.vtu")
    assert last.cells_dict["line"].shape[0] == found["elements"]
    assert last.point_data["displacement"][-1, 1] == pytest.approx(-found["displacement"][-1], rel=1e-6)
    assert last.point_data["moment"][0] == pytest.approx(found["members"]["beam"]["moment"][0], rel=1e-6)
    # Of a beam without shear flexibility, too, whose shear strain is nothing.
    at_root = found["members"]["beam"]["end_forces"][0][1]
    assert abs(at_root) == pytest.approx(found["load"][-1], rel=1e-6)
    assert last.point_data["shear_force"] == pytest.approx(at_root, rel=1e-4)
    rows = list(csv.DictReader((folder / "reference.csv").read_text(encoding="utf-8").splitlines()))
    assert [float(row["load"]) for row in rows] == found["load"]


def test_a_motion(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = builtin_text("cantilever")
    push = text.index("[push]")
    struck = text[:push].replace('at = ["1 m"', 'mass = "40 kg"\nvelocity = ["0 m/s", "-8 m/s"]\nat = ["1 m"')
    Path("struck.toml").write_text(struck + '[motion]\nduration = "20 ms"\n', encoding="utf-8")
    assert ductile("reference", "struck.toml", "--target-error", "2 %", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert {"displacement", "load", "hinges", "error_estimate", "method", "seconds", "time", "peak"} <= set(found)
    assert found["node"] == "tip"
    assert found["peak"] < 0.0
    assert found["hinges"][-1]["node"] == "root"
    assert 0.0 < found["hinges"][-1]["time"] < 0.02
    folder = tmp_path / "out" / "struck"
    rows = list(csv.DictReader((folder / "reference.csv").read_text(encoding="utf-8").splitlines()))
    assert [float(row["displacement_m"]) for row in rows] == found["displacement"]
    assert {"residual.csv", "hinges.csv", "reference.svg", "fields.pvd", "fields-25.vtu"} <= {
        file.name for file in folder.iterdir()
    }
    ductile("reference", "struck.toml", "--target-error", "2 %")
    said = capsys.readouterr().out
    assert "Peak of tip" in said
    assert "Hinges, in order" in said
    assert "At rest" in said


def test_results_are_kept_by_content(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    runs: list[Any] = []
    solve = reference_command.push_over
    monkeypatch.setattr(reference_command, "push_over", lambda *args: runs.append(args) or solve(*args))
    ductile("reference", "cantilever", "--json")
    first = json.loads(capsys.readouterr().out)
    ductile("reference", "cantilever", "--json")
    second = json.loads(capsys.readouterr().out)
    assert len(runs) == 1
    assert (first.pop("cached"), second.pop("cached")) == (False, True)
    assert first == second
    Path("other.toml").write_text(builtin_text("cantilever").replace("50x100", "50x101"), encoding="utf-8")
    ductile("reference", "other.toml")
    assert len(runs) == 2
    ductile("reference", "cantilever", "--no-cache")
    assert len(runs) == 3


def test_tables(capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("reference", "cantilever") == 0
    said = capsys.readouterr().out
    assert "Hinges, in order" in said
    assert "root" in said
    assert "29375" in said


def test_a_target_that_is_out_of_reach_gives_status_1() -> None:
    assert ductile("reference", "cantilever", "--target-error", "1e-12", "--no-cache") == 1


def test_bad_input_gives_status_2(capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("reference", "cantilevr") == 2
    assert "did you mean cantilever" in capsys.readouterr().err


def test_short_members_and_long_pushes_are_remarked(capsys: pytest.CaptureFixture[str]) -> None:
    text = 'reference = "beam"\n' + builtin_text("cantilever").replace('"1 m"', '"0.4 m"')
    Path("short.toml").write_text(text, encoding="utf-8")
    ductile("reference", "short.toml", "--json")
    said = json.loads(capsys.readouterr().out)["remarks"]
    assert any("members.beam: L/h = 4" in remark for remark in said)
    assert any("kinematics" in remark for remark in said)


def test_a_short_member_is_answered_in_plane_stress_with_its_fields(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    text = builtin_text("cantilever").replace('"1 m"', '"0.2 m"').replace('"74.6031746031746 mm"', '"0.6 mm"')
    Path("short.toml").write_text(text + '\n[plane]\nroot = "contraction-free"\n', encoding="utf-8")
    assert ductile("reference", "short.toml", "--target-error", "0.5 %", "--json") == 0
    said = json.loads(capsys.readouterr().out)
    assert said["method"].startswith("plane stress continuum")
    assert "fields" not in said
    assert any("followed as a plane stress continuum" in remark for remark in said["remarks"])
    folder = tmp_path / "out" / "short"
    written = {file.name for file in folder.iterdir()}
    assert {"reference.csv", "hinges.csv", "reference.svg", "fields.pvd", "fields-00.vtu", "fields-12.vtu"} <= written
    ductile("reference", "short.toml", "--target-error", "0.5 %", "-o", "again")
    assert {file.name for file in Path("again").iterdir()} == written


def test_another_mesh_is_another_answer(tmp_path: Path) -> None:
    """The cache follows what is in the mesh file, not what it is called."""
    scene = parse_scene(
        """
        title = "mesh"
        [plane]
        mesh = "body.msh"
        thickness = "5 mm"
        supports = { left = "clamped" }
        [push]
        node = "right"
        direction = [1, 0]
        distance = "1 mm"
        """,
        "test",
    )
    (tmp_path / "body.msh").write_text("one", encoding="utf-8")
    first = content_key(scene)
    (tmp_path / "body.msh").write_text("two", encoding="utf-8")
    assert content_key(scene) != first
