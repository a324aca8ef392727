"""``ductile fit``: load cases together, bounds, a case that the fit does not see, and what it refuses."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cantilevers import cantilever
from frames import frame_text
from test_cli import ductile

from calibration.fit_command import FitAnswer
from calibration.fitting import LoadCase, fit
from sim import Model

SOFT = "fy=235 MPa, E=210 GPa, rho=7850 kg/m^3, Et=2.1 GPa"


def write(folder: Path, name: str, push: str) -> str:
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (1.0, 0.0, "free")}
    text = frame_text(nodes, [("A", "B")], push, section="rectangle 50x100 mm", material=SOFT)
    (folder / name).write_text(text, encoding="utf-8")
    return str(folder / name)


def push(*stops: float) -> str:
    return f'[push]\nnode = "B"\ndirection = [0, -1]\nturning_points = {list(stops)}'


def test_a_hinge_is_fitted_to_pushes_and_cycles_and_checked_on_another(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three elastic–plastic hinges of a beam that hardens: their strength is held by its bound, and comes closer."""
    first = write(tmp_path, "first.toml", push(0.05))
    loop = write(tmp_path, "loop.toml", push(0.02, -0.02))
    unseen = write(tmp_path, "unseen.toml", push(0.03))
    out = tmp_path / "out"
    arguments = ("--check", unseen, "--law", "elastic-plastic", "--joints", "3", "--vary", "stiffness, strength")
    arguments += ("--bounds", "strength=1:1.02", "--weights", "1, 2", "-o", str(out))
    assert ductile("fit", first, loop, *arguments) == 1
    assert capsys.readouterr().out.startswith("Target missed. ")
    found = json.loads((out / "fit.json").read_text(encoding="utf-8"))
    assert found["weights"] == [1.0, 2.0]
    assert found["parameters"]["strength"] == pytest.approx(1.02, abs=1e-4)
    assert found["at_bound"] == ["strength"]
    assert found["bounds"]["strength"] == [1.0, 1.02]
    assert set(found["after"]) == {"first", "loop"}
    assert found["after"]["first"] < found["before"]["first"]
    before, after = found["checks"]["unseen"]
    assert 0.0 < after < 1.0
    assert before > 0.01
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "at its bound" in page
    assert "not seen by the fit" in page


def test_a_reference_that_is_not_known_well_enough_decides_nothing() -> None:
    """Whatever the fit comes to: the model is the reference's own here, and its error next to nothing."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.01)
    points = np.linspace(0.0, 0.01, 12)
    model = Model("lobatto", 3, "elastic-plastic")
    case = LoadCase("own", scene, points, np.ones_like(points), uncertainty=0.003)
    case = replace(case, values=case.residuals(model, {}) + 1.0)
    found = fit([case], model, ("stiffness",))
    vague, good = (FitAnswer(found, (case,), (), target) for target in (0.01, 0.02))
    assert "only known within 0.3 %" in vague.limit
    assert not vague.whole()["target_met"]
    assert good.limit == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("cantilever", "--vary", "length"), '--vary: there is no parameter "length"'),
        (("cantilever", "--bounds", "strength=1.2:0.8"), "--bounds: "),
        (("cantilever", "--bounds", "damping=0:1"), '"damping" is not varied'),
        (("cantilever", "--weights", "1, 2"), "2 weights for 1 scenes"),
        (("cantilever", "--vary", "hinge_length"), 'the rule "lobatto" has none'),
        (("cantilever", "--law", "glue"), '--law: there is no "glue"'),
        ((), "there is nothing to fit to"),
    ],
)
def test_what_cannot_be_fitted_is_refused(
    arguments: tuple[str, ...],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ductile("fit", *arguments) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
