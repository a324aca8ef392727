"""Where the finite-element reference has a scene's members in the course of its push or motion, for a replay."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rich.console import Console

from calibration.replay_payload import ReferenceShape
from calibration.result_cache import content_key, keep, recall
from capacity import InputError
from fem_reference import NotConverged, motion, pushover
from scene import Scene

# Of the load, or of the peak displacement [-]; a shape to look at needs no more, and is soon there.
_TOLERANCE = 0.01
# Moments of a push, about an even way apart.
_MOMENTS = 41


@dataclass(frozen=True)
class ReferencePath:
    """Members in the course of a push or motion.

    Attributes
    ----------
    course : (k,) float
        Way of the pushed node so far [m], or time [s].
    lines : tuple of (k, n, 2) float
        Points along each member [m].
    """

    course: np.ndarray
    lines: tuple[np.ndarray, ...]


def reference_path(scene: Scene, watch: Callable[[float], None] = lambda share: None) -> ReferencePath:
    """Follow ``scene``'s push or motion with fibre beams, or find again what was kept on disk.

    Raises
    ------
    InputError
        When the scene has neither, or the reference does not follow it.
    NotConverged
        When the reference finds no equilibrium.
    """
    key = content_key(scene, "path", _TOLERANCE, _MOMENTS)
    kept = recall(key)
    if kept is None:
        found = _followed(scene, watch)
        kept = {"course": found.course.tolist(), "lines": [line.tolist() for line in found.lines]}
        keep(key, kept)
    return ReferencePath(np.array(kept["course"]), tuple(np.array(line) for line in kept["lines"]))


def _followed(scene: Scene, watch: Callable[[float], None]) -> ReferencePath:
    if scene.motion is not None:
        moved = motion(scene, _TOLERANCE, watch=watch)
        members, course, chosen = moved.members, moved.member_time, np.arange(len(moved.member_time))
    else:
        pushed = pushover(scene, _TOLERANCE, watch)
        members, course = pushed.members, way(pushed.displacement)
        evenly = np.linspace(0.0, course[-1], _MOMENTS)
        chosen = np.unique(np.searchsorted(course, evenly).clip(max=len(course) - 1))
    lines = []
    for name, member in members.items():
        start = np.array(scene.nodes[scene.members[name].start].at, dtype=float)
        c, s, _ = scene.axis(name)
        lines.append(start + member.point[:, None] * np.array([c, s]) + member.path.shape[chosen])
    return ReferencePath(course[chosen], tuple(lines))


def way(displacement: np.ndarray) -> np.ndarray:
    """How far a node has gone by each point of its path, there and back, from displacements along a push (k,) [m]."""
    return np.append(0.0, np.cumsum(np.abs(np.diff(displacement))))


def shape_for_replay(
    scene: Scene, push: tuple[np.ndarray, np.ndarray] | None, messages: Console, watch: Callable[[float], None]
) -> ReferenceShape | None:
    """The reference's shape in the time of a run; None where it cannot follow, which is said to ``messages``.

    Parameters
    ----------
    scene : Scene
    push : ((t,) float, (t,) float), optional
        Times of the run [s], and the pushed node's displacement then [m]; the reference is shown as far on its way.
    messages : rich.console.Console
    watch : callable
        Told the finished share.
    """
    if not scene.members or scene.bodies or scene.joints or scene.vehicles:
        return None
    try:
        path = reference_path(scene, watch)
    except (InputError, NotConverged) as error:
        messages.print(f"The replay is without the reference's shape: {error}", soft_wrap=True, markup=False)
        return None
    time = path.course if push is None else np.interp(path.course, way(push[1]), push[0])
    return ReferenceShape(path.lines, time, "reference (fibre beams)")
