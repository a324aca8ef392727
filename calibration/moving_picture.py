"""Recordings as pictures: a still of one moment, or a film as GIF or MP4."""

from __future__ import annotations

import math
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib
import numpy as np
import shapely
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from PIL import Image

from capacity.errors import InputError
from sim.recorded import Outline, Recording

_INK, _STILL, _PIECE, _LOOSE, _BROKEN = "#22303c", "#c3ccd4", "#8fa9c0", "#c9b89a", "#c0262d"
_UTILISATION = LinearSegmentedColormap.from_list("utilisation", [(0.0, "#dfe9f2"), (0.7, "#f0b429"), (1.0, "#d2222d")])
_DOTS_AN_INCH = 100
_WIDTH, _LEAST_HEIGHT, _MOST_HEIGHT = 8.0, 3.0, 6.0
_SEGMENTS_A_QUARTER = 8
_MARGIN = 0.06
# Everything may be so many times as large as the structure to be shown.
_FAR = 4.0
# What is near the structure, beside it and above or below, over its size.
_NEAR = np.array([1.0, 0.4])
# Share of positions on either side that may lie outside the picture.
_STRAYED = 0.02
_FRAMES_A_SECOND = 20
_COLOURS = 64
# A film lasts about so long at least, and at most [s].
_SHORTEST, _LONGEST = 4.0, 30.0
_SPEEDS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)


class Picture:
    """A figure that shows a recording at one moment after the other, bodies to scale.

    Parameters
    ----------
    recording : Recording
    """

    def __init__(self, recording: Recording) -> None:
        self.recording = recording
        self._outlines = [[_polygon(outline) for outline in body.outlines] for body in recording.bodies]
        low, high = self._extent()
        size = np.maximum(high - low, 1e-6)
        height = float(np.clip(_WIDTH * size[1] / size[0], _LEAST_HEIGHT, _MOST_HEIGHT))
        self.figure = Figure(figsize=(_WIDTH, height), dpi=_DOTS_AN_INCH)
        self._axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set_axis_off()
        # The whole figure is used, at the same scale along both axes.
        span = max(size[0], size[1] * _WIDTH / height)
        middle = 0.5 * (low + high)
        self._axes.set_xlim(middle[0] - 0.5 * span, middle[0] + 0.5 * span)
        self._axes.set_ylim(middle[1] - 0.5 * span * height / _WIDTH, middle[1] + 0.5 * span * height / _WIDTH)
        self._bodies = PolyCollection([], edgecolors=_INK, linewidths=0.6)
        self._axes.add_collection(self._bodies)
        self._joints = self._axes.scatter([], [], s=16, c=[], cmap=_UTILISATION, vmin=0.0, vmax=1.0, zorder=3)
        self._joints.set(edgecolor=_INK, linewidth=0.6)
        self._broken = self._axes.scatter([], [], s=36, marker="x", c=_BROKEN, linewidths=1.8, zorder=4)
        self._caption = self._axes.text(
            0.012, 0.975, "", transform=self._axes.transAxes, va="top", color=_INK, fontsize=10
        )

    def show(self, k: int, note: str = "") -> None:
        """Show the sample ``k``, with ``note`` after its time."""
        recording = self.recording
        polygons, colours = [], []
        for body, outlines, pose in zip(recording.bodies, self._outlines, recording.pose[k], strict=True):
            if math.isfinite(pose[0]):
                colour = _STILL if body.kind == "static" else _PIECE if body.in_structure else _LOOSE
                polygons += [_placed(outline, pose) for outline in outlines]
                colours += [colour] * len(outlines)
        self._bodies.set(verts=polygons, facecolors=colours)
        places = self._joint_places(k)
        broken = recording.broken[k]
        self._joints.set_offsets(places[~broken])
        self._joints.set_array(recording.utilisation[k].max(axis=1, initial=0.0)[~broken])
        self._broken.set_offsets(places[broken])
        digits = 2 if recording.time[-1] >= 1.0 else 4
        self._caption.set_text(f"{recording.time[k]:.{digits}f} s{note}")

    def _joint_places(self, k: int) -> np.ndarray:
        places = [
            _placed(joint.anchors[:1], self.recording.pose[k, joint.bodies[0]])[0] for joint in self.recording.joints
        ]
        return np.array(places).reshape(-1, 2)

    def _extent(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest x, y to show, with a margin.

        Everything that moves or is joined, where it is most of the time; but when that is much larger than the
        structure, the structure and what is near it.
        """
        everything, structure = self._whereabouts(False), self._whereabouts(True)
        low, high = _span(everything)
        if structure.size:
            near = _span(structure)
            size = float((near[1] - near[0]).max())
            if 0.0 < _FAR * size < float((high - low).max()):
                low, high = near[0] - size * _NEAR, near[1] + size * _NEAR
        margin = _MARGIN * (high - low).max()
        return low - margin, high + margin

    def _whereabouts(self, structure_only: bool) -> np.ndarray:
        """Joints, and corners of squares around the bodies that move, at each time, (t, n, 2)."""
        joints = np.array([self._joint_places(k) for k in range(len(self.recording.time))])
        squares = [
            pose[:, None, :2] + side * max(np.hypot(*outline.T).max() for outline in outlines)
            for body, outlines, pose in zip(
                self.recording.bodies, self._outlines, np.moveaxis(self.recording.pose, 1, 0), strict=True
            )
            if body.kind != "static" and outlines and (body.in_structure or not structure_only)
            for side in (-1.0, 1.0)
        ]
        return np.concatenate([joints, *squares], axis=1)


def _span(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest x, y of points (t, n, 2) at the start, and most of the time later."""
    if not np.isfinite(points).any():
        return np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    low, high = np.nanquantile(points, [_STRAYED, 1.0 - _STRAYED], axis=(0, 1))
    start = points[0][np.isfinite(points[0]).all(axis=1)]
    return start.min(axis=0, initial=math.inf).clip(max=low), start.max(axis=0, initial=-math.inf).clip(min=high)


def write_still(recording: Recording, k: int, path: Path) -> None:
    """Write a picture of the sample ``k`` to ``path``, as PNG or SVG by its ending."""
    picture = Picture(recording)
    picture.show(k)
    picture.figure.savefig(path, dpi=_DOTS_AN_INCH)


def write_gif(recording: Recording, path: Path) -> None:
    """Write a film of a recording to ``path`` as GIF."""
    picture = Picture(recording)
    canvas = FigureCanvasAgg(picture.figure)
    frames = []
    for _ in _played(picture):
        canvas.draw()
        # Colours are chosen here, quickly; Pillow by itself takes several times as long as the drawing.
        image = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])
        frames.append(image.quantize(_COLOURS, method=Image.Quantize.FASTOCTREE))
    with _staged(Path(path)) as staging:
        frames[0].save(
            staging, save_all=True, append_images=frames[1:], duration=round(1000 / _FRAMES_A_SECOND), loop=0
        )


def write_mp4(recording: Recording, path: Path) -> None:
    """Write a film of a recording to ``path`` as MP4 (H.264).

    Raises
    ------
    InputError
        When there is no ffmpeg.
    """
    picture, writer = Picture(recording), FFMpegWriter(fps=_FRAMES_A_SECOND, codec="h264")
    with (
        matplotlib.rc_context({"animation.ffmpeg_path": ffmpeg()}),
        _staged(Path(path)) as staging,
        writer.saving(picture.figure, str(staging), _DOTS_AN_INCH),
    ):
        for _ in _played(picture):
            writer.grab_frame()


def ffmpeg() -> str:
    """Path of the ffmpeg to use: the one on the search path, or that of the package imageio-ffmpeg.

    Raises
    ------
    InputError
        When there is none.
    """
    found = shutil.which("ffmpeg")
    if found is not None:
        return found
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise InputError(
            "--mp4", "there is no ffmpeg to write it with", "pip install 'ductile-joints[video]', or write a --gif"
        ) from error
    return str(imageio_ffmpeg.get_ffmpeg_exe())


def film_speed(duration: float) -> float:
    """Simulated seconds a second of film: 1, but slower for what is soon over and faster for what takes long."""
    duration *= 1.0 + 1e-9  # a sum of steps may end a rounding early
    if duration >= _LONGEST:
        return next((speed for speed in _SPEEDS if duration / speed <= _LONGEST), _SPEEDS[-1])
    return next((speed for speed in reversed(_SPEEDS) if speed <= 1.0 and duration / speed >= _SHORTEST), _SPEEDS[0])


def _played(picture: Picture) -> Iterator[None]:
    """Show a recording in ``picture``, one frame of a film after the other."""
    time = picture.recording.time
    speed = film_speed(float(time[-1]))
    note = "" if speed == 1.0 else f"   {speed:g} ×"
    frames = max(1, round(time[-1] / speed * _FRAMES_A_SECOND))
    for k in np.searchsorted(time, np.linspace(0.0, time[-1], frames + 1) - 1e-9):
        picture.show(int(k), note)
        yield


@contextmanager
def _staged(path: Path) -> Iterator[Path]:
    """A file beside ``path`` that becomes it when all has gone well."""
    staging = path.with_name(f".{path.stem}-unfinished{path.suffix}")
    try:
        yield staging
        staging.replace(path)
    finally:
        staging.unlink(missing_ok=True)


def _polygon(outline: Outline) -> np.ndarray:
    """Corners of a shape, with its round parts drawn in short lines."""
    kinds = {"polygon": shapely.Polygon, "segment": shapely.LineString, "circle": shapely.Point}
    shape = kinds[outline.kind](outline.points if outline.kind != "circle" else outline.points[0])
    if outline.radius > 0.0:
        shape = shape.buffer(outline.radius, quad_segs=_SEGMENTS_A_QUARTER)
    corners: np.ndarray = np.array(shape.exterior.coords if hasattr(shape, "exterior") else shape.coords)
    return corners


def _placed(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Points of a body at a pose, in the world."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    placed: np.ndarray = points @ np.array([[c, s], [-s, c]]) + pose[:2]
    return placed
