"""What `ductile simulate` leaves to look at, and what it says when it cannot."""

import builtins
import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_cli import ductile
from test_replay_payload import unpacked

from calibration.run_pictures import Camera, sampling_period
from scene import load_scene
from sim.world import World


def described(page: Path) -> dict[str, Any]:
    """What a replay page carries."""
    content = re.search(r'id="payload">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)
    assert content
    packed: dict[str, Any] = json.loads(content[1])
    return packed


def test_a_run_leaves_a_replay_of_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("simulate", "block-under-tension", "-o", str(tmp_path / "o")) == 0
    assert "replay.html" in capsys.readouterr().err
    packed = described(tmp_path / "o" / "replay.html")
    assert packed["title"].startswith("Concrete block")
    assert [joint["label"] for joint in packed["joints"]] == ["hanger"]
    assert packed["time"][-1] == pytest.approx(1.0)
    np.testing.assert_allclose(unpacked(packed)["force"][1:, 0], 60e3, rtol=1e-3)
    assert packed["reference"] is None


def test_a_push_has_the_reference_s_shape_over_it(tmp_path: Path) -> None:
    """In the end the tip is where the scene says, 7.5 % of the length down."""
    assert ductile("simulate", "cantilever", "-o", str(tmp_path / "with")) == 0
    (line,) = described(tmp_path / "with" / "replay.html")["reference"]["lines"]
    scene = load_scene("cantilever")
    x, y = scene.nodes[scene.push.node].at
    assert line[-1][-1] == pytest.approx([x, y - scene.push.way()], abs=1e-6)
    assert ductile("simulate", "cantilever", "--no-reference", "-o", str(tmp_path / "without")) == 0
    assert described(tmp_path / "without" / "replay.html")["reference"] is None


def test_films_are_written_when_asked_for(tmp_path: Path) -> None:
    pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed")
    options = ["--duration", "0.05 s", "--gif", "--mp4", "-o", str(tmp_path / "o")]
    assert ductile("simulate", "block-under-tension", *options) == 0
    names = {path.name for path in (tmp_path / "o").iterdir()}
    assert names == {"simulation.json", "replay.html", "run.gif", "run.mp4"}
    assert (tmp_path / "o" / "run.gif").read_bytes().startswith(b"GIF89a")
    assert b"ftyp" in (tmp_path / "o" / "run.mp4").read_bytes()[:16]


@pytest.mark.parametrize(
    ("option", "package", "cure"), [("--mp4", "imageio_ffmpeg", "video"), ("--live", "pygame", "live")]
)
def test_what_an_extra_lacks_is_said_before_the_run(
    option: str,
    package: str,
    cure: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    load = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.split(".")[0] == package:
            raise ImportError(name)
        return load(name, *rest)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(builtins, "__import__", without)
    assert ductile("simulate", "block-under-tension", option) == 2
    assert f"pip install 'ductile-joints[{cure}]'" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_live_runs_the_scene_in_a_window(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Closed as soon as the run is over."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame = pytest.importorskip("pygame", reason="pygame is not installed")
    finished = World.finished.fget
    assert finished

    def close_when_finished(world: World) -> bool:
        over = bool(finished(world))
        if over:
            pygame.event.post(pygame.event.Event(pygame.QUIT))
        return over

    monkeypatch.setattr(World, "finished", property(close_when_finished))
    options = ["--duration", "0.1 s", "--live", "--json", "-o", str(tmp_path / "o")]
    assert ductile("simulate", "block-under-tension", *options) == 0
    assert json.loads(capsys.readouterr().out)["steps"] == 6


def test_a_run_has_samples_enough_and_not_too_many() -> None:
    assert sampling_period(1 / 240, 60.0) == pytest.approx(1 / 30)
    assert sampling_period(1e-4, 0.02) == pytest.approx(1e-4)
    assert sampling_period(1e-5, 0.6) == pytest.approx(1e-3)
    assert sampling_period(1 / 60, 3600.0) == pytest.approx(1.0)


def test_steps_in_parts_are_recorded_at_their_times() -> None:
    """The hammer of the impact test is taken in parts of a step; its way is the recorded one nevertheless."""
    world = World(load_scene("charpy"), duration=0.002)
    camera = Camera(world)
    times, way = [0.0], [world.bodies["hammer"].position.y]
    while not world.finished:
        world.step()
        camera.note()
        times.append(world.time)
        way.append(world.bodies["hammer"].position.y)
    recording = camera.recording()
    assert 15 < len(recording.time) < len(times)
    hammer = int(np.argmax(np.abs(recording.velocity[0, :, 1])))
    np.testing.assert_allclose(recording.pose[:, hammer, 1], np.interp(recording.time, times, way), atol=1e-12)
