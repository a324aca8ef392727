"""What a run leaves to look at: the replay page, and films."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from calibration.moving_picture import write_gif, write_mp4
from calibration.replay import ReferenceShape, replay_page
from sim.recorded import Recording
from sim.recording import Recorder
from sim.world import World

# Samples a second of simulated time, and their least and largest number in a run.
_RATE, _FEWEST, _MOST = 30.0, 600.0, 3600.0


class Camera:
    """Records a world, step by step.

    Parameters
    ----------
    world : World
        Before its first step.
    """

    def __init__(self, world: World) -> None:
        self._world, self._last = world, world.time
        self._pushed = [(world.time, 0.0)]
        self._recorder = Recorder(world.space, sampling_period(world.dt, world.duration), world.labels)

    def note(self) -> None:
        """Take note of a step."""
        self._recorder.sample(self._world.time - self._last)
        self._last = self._world.time
        if self._world.push is not None:
            self._pushed.append((self._world.time, self._world.push.displacement))

    def recording(self) -> Recording:
        """All up to now."""
        return self._recorder.finish(self._world.scene.title)

    @property
    def pushed(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Times [s], and the pushed node's displacement then [m], if the world has a push."""
        if self._world.push is None:
            return None
        time, displacement = np.array(self._pushed).T
        return time, displacement


def sampling_period(dt: float, duration: float) -> float:
    """Time between two samples [s]: a thirtieth of a second, but less in a short run and more in a long one."""
    return max(dt, min(1.0 / _RATE, duration / _FEWEST), duration / _MOST)


def pictures(recording: Recording, shape: ReferenceShape | None, gif: bool, mp4: bool) -> dict[str, str | bytes]:
    """Files to look at, by name."""
    files: dict[str, str | bytes] = {"replay.html": replay_page(recording, shape)}
    if gif:
        files["run.gif"] = _film(write_gif, recording, "run.gif")
    if mp4:
        files["run.mp4"] = _film(write_mp4, recording, "run.mp4")
    return files


def _film(write: Callable[[Recording, Path], None], recording: Recording, name: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(recording, path)
        return path.read_bytes()
