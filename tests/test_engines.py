"""Joints handed to engines: the files run where their engines are installed, and say how wrong they are."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pymunk
import pytest
from command_line import ductile
from frames import frame_text, propped, two_spans

from calibration.engines.catalogue import ENGINES
from calibration.engines.export import Export, export
from calibration.engines.handover import LAW, JointTerms, hand_over
from calibration.engines.in_bullet import NoTree, push_in_bullet
from calibration.engines.pushing import curve_errors
from calibration.engines.to_pymunk import push_module
from fem_reference import pushover
from scene import Scene, builtin_text, load_scene, parse_scene
from sim import Model

CANTILEVER = load_scene("cantilever")
M_MAX = 29375.0  # N m: b h² fy / 4


def handed(scene: Scene, engine: str, dt: float, joints: int | None = None, iterations: int = 30) -> Export:
    return export(scene, "scene", engine, Model("lobatto", 2, LAW, dt=dt, iterations=iterations), joints, 0.2)


def said_in(notes: tuple[str, ...]) -> float:
    """The path error [%] that a header gives as measured."""
    line = next(note for note in notes if note.startswith("Measured"))
    found = re.search(r"path ([\d.]+) % of the peak", line)
    assert found is not None
    return float(found[1])


@pytest.mark.parametrize("dt", [1 / 60, 1 / 1000])
def test_the_pymunk_file_runs_and_is_as_wrong_as_its_header_says(dt: float) -> None:
    found = handed(CANTILEVER, "pymunk", dt)
    reference = pushover(CANTILEVER, 5e-4)
    push = found.handover.push
    assert push is not None
    errors = curve_errors(reference, push_module(found.text, found.handover, push, reference.displacement))
    assert said_in(found.notes) == pytest.approx(100.0 * errors.path_max, rel=0.01)
    assert re.search(rf"path {said_in(found.notes):g} %", " ".join(found.text.split()))
    if dt == 1 / 1000:
        # Short steps bear real stiffness: what remains is the hinge law's own error.
        assert errors.path_max == pytest.approx(0.079, abs=0.004)
    assert abs(errors.collapse_load) < 0.03


@pytest.mark.parametrize("turn", ["gear", "spring"])
def test_the_pymunk_file_yields_in_a_loop_of_ones_own(turn: str) -> None:
    """A tip load of 0.9 M_p / L is borne; 1.1 M_p / L folds the beam, and it stays folded."""
    handover = hand_over(CANTILEVER, Model("lobatto", 2, LAW, dt=1 / 1000, iterations=20), "c")
    module: dict[str, Any] = {}
    exec(ENGINES["pymunk"].writers[turn](handover, ""), module)
    angles = {}
    for share in (0.9, 1.1):
        space = pymunk.Space()
        bodies, yielding = module["build"](space)
        for step in range(400):
            load = share * M_MAX * min(1.0, step / 200) * (step < 300)
            bodies[-1].apply_force_at_world_point((0.0, -load), bodies[-1].local_to_world((0.5, 0.0)))
            space.step(module["DT"])
            module["after_step"](space, yielding)
        angles[share] = bodies[-1].angle
        assert (yielding[0]["plastic"] > 0.1) == (share > 1.0)
    assert abs(angles[0.9]) < 0.002
    assert angles[1.1] < -0.1


def test_a_joint_of_the_pymunk_file_breaks_when_its_rotation_is_used_up() -> None:
    """Ultimate strain 2 %: far less rotation than half a second of falling takes."""
    scene = parse_scene(builtin_text("cantilever").replace("rho=7850", "eu=2 %, rho=7850"), "brittle")
    found = handed(scene, "pymunk", 1 / 1000, joints=2)
    limit = found.handover.joints[0].break_rotation
    assert 0.0 < limit < 0.1
    module: dict[str, Any] = {}
    exec(found.text, module)
    space = pymunk.Space()
    bodies, yielding = module["build"](space)
    for _ in range(400):
        bodies[-1].apply_force_at_world_point((0.0, -1.5 * M_MAX), bodies[-1].local_to_world((0.5, 0.0)))
        space.step(module["DT"])
        module["after_step"](space, yielding)
    assert not yielding
    assert not space.constraints


def test_mujoco_bears_real_stiffness_at_60_hz_and_closes_loops() -> None:
    pytest.importorskip("mujoco", reason="the extra engines is not installed")
    found = handed(CANTILEVER, "mujoco", 1 / 60)
    assert found.measured is not None
    assert found.measured.path_max == pytest.approx(0.08, abs=0.01)
    looped = handed(propped(0.03), "mujoco", 1 / 60, joints=3)
    assert ".twin." in looped.text
    assert looped.measured is not None
    assert looped.model_errors is not None
    assert looped.measured.path_max == pytest.approx(looped.model_errors.path_max, abs=0.02)
    assert abs(looped.measured.collapse_load) < 0.03


def test_mujoco_bears_rollers() -> None:
    pytest.importorskip("mujoco", reason="the extra engines is not installed")
    found = handed(two_spans(4.0, 3.0, False, 0.05), "mujoco", 1 / 240, joints=3)
    assert 'type="slide"' in found.text
    assert found.measured is not None
    assert found.model_errors is not None
    assert found.measured.path_max == pytest.approx(found.model_errors.path_max, abs=0.02)


def test_box2d_runs() -> None:
    """Rigid until it yields, so its path error is near one; its collapse load is right with short steps."""
    pytest.importorskip("Box2D", reason="the extra engines is not installed")
    found = handed(CANTILEVER, "box2d", 1 / 1000, joints=2)
    assert found.measured is not None
    assert abs(found.measured.collapse_load) < 0.01
    assert 0.5 < found.measured.path_max < 1.0


def test_bullet_runs_trees_and_says_what_it_cannot() -> None:
    pytest.importorskip("pybullet", reason="the extra engines is not installed")
    found = handed(CANTILEVER, "bullet", 1 / 60, joints=2)
    assert found.measured is not None
    assert said_in(found.notes) == pytest.approx(100.0 * found.measured.path_max, rel=0.01)
    loop = hand_over(propped(0.03), Model("lobatto", 2, LAW), "loop")
    assert loop.push is not None
    with pytest.raises(NoTree, match="trees only"):
        push_in_bullet(loop, loop.push, np.array([0.0, 0.01]))


@pytest.mark.parametrize("engine", ENGINES)
def test_every_file_says_what_is_missing_and_what_to_expect(
    engine: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ductile("export", "cantilever", "--engine", engine, "--joints", "3", "-o", str(tmp_path), "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    text = (tmp_path / answer["file"]).read_text(encoding="utf-8")
    assert text == answer["text"]
    head = " ".join(re.sub(r"^(//|#) ", "", text, flags=re.MULTILINE).split())
    assert "Cannot be expressed:" in head
    assert "Error to expect" in head
    assert "the joints themselves, solved as one, path 7.8" in head
    assert answer["model_errors"]["path_max"] == pytest.approx(0.0787, abs=0.002)
    assert max(map(len, text.splitlines())) < 500
    for opening, closing in ("()", "[]", "{}"):
        assert text.count(opening) == text.count(closing)


def joint_row(engine: str, joint: JointTerms) -> tuple[str, list[float]]:
    """Text of an engine's file, and the numbers in the line of one joint, its name left out."""
    handover = hand_over(CANTILEVER, Model("lobatto", 3, LAW), "c")
    text = next(iter(ENGINES[engine].writers.values()))(handover, "")
    start = text.index(joint.name, text.index("JOINTS = [") if engine == "pymunk" else 0) + len(joint.name) + 1
    row = text[start : text.index("\n", text.index("\n", start) + 1 if engine in ("box2d", "bullet") else start)]
    return text, [float(x) for x in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e[-+]?\d+)?", row)]


def test_terms_and_units() -> None:
    """The root joint: k = EI / (w L) with w = 1/6, I of a third of the way's piece, ζ = 0.2."""
    joint = hand_over(CANTILEVER, Model("lobatto", 3, LAW), "c").joints[0]
    k, inertia = 875000.0 / (1 / 6), 19.625 * 0.5**2 / 12
    assert joint.stiffness[2] == pytest.approx(k)
    assert joint.inertia == pytest.approx(inertia)
    hertz, damping = math.sqrt(k / inertia) / math.tau, 0.4 * math.sqrt(k * inertia)
    assert joint.frequency == pytest.approx(hertz)
    for engine, wanted in {
        "box2d": [hertz, 0.2, M_MAX, M_MAX / k],
        "bullet": [k, damping, M_MAX],
        "rapier": [k, damping, M_MAX, M_MAX / k],
        "godot": [k, damping, M_MAX],
        "unity": [k, damping, M_MAX, M_MAX / k],
        # 1 N m = 1e4 kg cm²/s²
        "unreal": [1e4 * k, 1e4 * damping, 1e4 * M_MAX, math.degrees(M_MAX / k)],
        "pymunk": [k, damping, M_MAX],
    }.items():
        _, numbers = joint_row(engine, joint)
        for value in wanted:
            assert any(math.isclose(x, value, rel_tol=1e-6) for x in numbers), (engine, value, numbers)


def test_json_holds_everything(tmp_path: Path) -> None:
    assert ductile("export", "cantilever", "--engine", "json", "-o", str(tmp_path)) == 0
    whole = json.loads((tmp_path / "cantilever_json.json").read_text(encoding="utf-8"))
    scene = load_scene("cantilever")
    members = scene.members.items()
    mass = sum(m.material.density * m.section.area * scene.axis(name)[2] for name, m in members)
    assert sum(body["mass"] for body in whole["bodies"]) == pytest.approx(mass)
    for joint in whole["joints"]:
        assert {joint["a"], joint["b"]} <= set(range(-1, len(whole["bodies"])))
        assert joint["yield_rotation"] == pytest.approx(joint["capacity"][2] / joint["stiffness"][2])


@pytest.mark.parametrize(
    ("tokens", "fault"),
    [
        (["--engine", "havok"], "choose from pymunk"),
        (["--engine", "json", "--joints", "1"], "too few"),
        (["--engine", "json", "--rule", "simpson"], "choose from lobatto"),
        (["--engine", "json", "--dt", "0 s"], "greater than zero"),
        (["--engine", "json", "--damping-ratio", "2"], "not below 100 %"),
        ([], "engine"),
    ],
)
def test_bad_options_are_refused(
    tokens: list[str], fault: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ductile("export", "cantilever", *tokens, "-o", str(tmp_path / "o")) == 2
    error = capsys.readouterr().err
    assert fault in error
    assert error.count("\n") == 1
    assert not (tmp_path / "o").exists()


def test_a_motion_is_exported_with_what_its_joints_err_by(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A heavy body on a beam, loaded at once: hinges alone bend it as far as fibres do, within a tenth."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (1.5, 0.0, "free")}
    motion = '[motion]\nduration = 0.1\nwatch = "B"\ndirection = [0, -1]'
    load = 'node = "B"\nforce = [0.0, -13e3]\nkind = "step"'
    text = frame_text(nodes, [("A", "B")], motion, [load], section="rectangle 50x100 mm")
    (tmp_path / "scene.toml").write_text(text.replace('support = "free"', 'support = "free"\nmass = 500.0'))
    arguments = ("--engine", "godot", "--dt", "1/480 s", "-o", str(tmp_path), "--json")
    assert ductile("export", str(tmp_path / "scene.toml"), *arguments) == 0
    (said,) = [note for note in json.loads(capsys.readouterr().out)["notes"] if note.startswith("Error to expect")]
    (peak,) = re.findall(r"peak ([+-][\d.]+) %", said)
    assert abs(float(peak)) < 10.0
    assert "at rest" in said
