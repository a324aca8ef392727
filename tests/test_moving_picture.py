"""Films and stills of a recording: their length, what they show, and what is said when they cannot be written."""

import builtins
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pymunk
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image
from replay_runs import falling_ball

from calibration.moving_picture import Picture, film_speed, write_gif, write_mp4, write_still
from capacity import InputError
from sim.recorded import Recording
from sim.recording import Recorder


@pytest.fixture(scope="module")
def recording() -> Recording:
    return falling_ball(seconds=0.8)


def test_a_film_lasts_neither_too_short_nor_too_long() -> None:
    for duration in np.geomspace(0.005, 1000.0, 60):
        speed = film_speed(float(duration))
        assert 3.999 <= duration / speed <= 30.0
        assert speed >= 1.0 or duration / (2.5 * speed) < 4.0
    assert film_speed(10.0) == 1.0


def test_a_gif_has_a_frame_each_twentieth_of_a_second(recording: Recording, tmp_path: Path) -> None:
    """0.8 s at a fifth of real time: 4 s, so 80 frames and the first."""
    path = tmp_path / "run.gif"
    write_gif(recording, path)
    with Image.open(path) as film:
        durations, frames = [], []
        for k in range(film.n_frames):
            film.seek(k)
            durations.append(film.info["duration"])
            frames.append(np.asarray(film.convert("RGB")))
    assert sum(durations) == pytest.approx(81 * 50)
    assert np.abs(frames[0].astype(int) - frames[-1]).max() > 100
    assert list(tmp_path.iterdir()) == [path]


def test_an_mp4_is_a_film_of_the_same_length(recording: Recording, tmp_path: Path) -> None:
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed")
    path = tmp_path / "run.mp4"
    write_mp4(recording, path)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert frames == 81
    assert seconds == pytest.approx(81 / 20)
    assert list(tmp_path.iterdir()) == [path]


def test_without_ffmpeg_it_says_what_to_install(
    recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    load = builtins.__import__

    def without_ffmpeg(name: str, *rest: Any) -> Any:
        if name == "imageio_ffmpeg":
            raise ImportError(name)
        return load(name, *rest)

    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(builtins, "__import__", without_ffmpeg)
    with pytest.raises(InputError, match=r"--mp4: .*pip install 'ductile-joints\[video\]'"):
        write_mp4(recording, tmp_path / "run.mp4")
    assert list(tmp_path.iterdir()) == []


def test_a_film_that_fails_leaves_nothing_behind(
    recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: "/bin/false")
    with pytest.raises((OSError, subprocess.CalledProcessError)):
        write_mp4(recording, tmp_path / "run.mp4")
    assert list(tmp_path.iterdir()) == []


def test_bodies_are_drawn_to_scale_and_where_they_are() -> None:
    """A plate of 2 m × 1 m turned by a quarter: as high as wide pixels were, about its centre."""
    space = pymunk.Space()
    plate = pymunk.Body(1.0, 1.0)
    plate.position, plate.angle = (3.0, 2.0), np.pi / 2
    ball = pymunk.Body(1.0, 1.0)
    ball.position = (6.0, 2.0)
    space.add(plate, pymunk.Poly.create_box(plate, (2.0, 1.0)), ball, pymunk.Circle(ball, 0.5))
    picture = Picture(Recorder(space).finish())
    picture.show(0)
    canvas = FigureCanvasAgg(picture.figure)
    canvas.draw()
    image = np.asarray(canvas.buffer_rgba())[..., :3].astype(int)
    filled = np.abs(image - 255).sum(axis=2) > 30
    filled[:40] = False  # the caption
    columns = np.flatnonzero(filled.any(axis=0))
    gap = int(np.diff(columns).argmax())
    left, right = columns[: gap + 1], columns[gap + 1 :]
    scale = np.ptp(left) / 1.0
    assert np.ptp(np.flatnonzero(filled[:, left].any(axis=1))) == pytest.approx(2.0 * scale, abs=3)
    assert np.ptp(right) == pytest.approx(1.0 * scale, abs=3)
    assert right.mean() - left.mean() == pytest.approx(3.0 * scale, abs=3)


def test_a_still_shows_a_broken_joint(recording: Recording, tmp_path: Path) -> None:
    path = tmp_path / "still.png"
    write_still(recording, len(recording.time) - 1, path)
    image = np.asarray(Image.open(path).convert("RGB")).astype(int)
    assert np.any(np.abs(image - [0xC0, 0x26, 0x2D]).sum(axis=2) < 12)
