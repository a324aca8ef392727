"""Where the finite-element reference has a scene's members in the course of its push or motion, for a replay.

Beams are shown by their axes, a plane stress continuum by its outline.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rich.console import Console

from calibration.replay_payload import ReferenceShape
from calibration.result_cache import content_key, keep, recall
from capacity import InputError
from fem_reference import Fields, NotConverged, PlanePush, motion, push_over, wants_plane_stress
from scene import Scene

# Of the load, or of the peak displacement [-]; a shape to look at needs no more, and is soon there.
_TOLERANCE = 0.01
# Moments of a push, about an even way apart.
_MOMENTS = 41
# Points along each side of an outline, no more.
_SIDE = 41


@dataclass(frozen=True)
class ReferencePath:
    """Members in the course of a push or motion.

    Attributes
    ----------
    course : (k,) float
        Way of the pushed node so far [m], or time [s].
    lines : tuple of (k, n, 2) float
        Points along each member, or around it [m].
    """

    course: np.ndarray
    lines: tuple[np.ndarray, ...]


def reference_path(scene: Scene, watch: Callable[[float], None] = lambda share: None) -> ReferencePath:
    """Follow ``scene``'s push or motion with the model that it asks for, or find again what was kept on disk.

    Raises
    ------
    InputError
        When the scene has neither, or the reference does not follow it.
    NotConverged
        When the reference finds no equilibrium.
    """
    key = content_key(scene, "shape", _TOLERANCE, _MOMENTS)
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
        pushed = push_over(scene, _TOLERANCE, watch)
        if isinstance(pushed, PlanePush):
            return _outlined(scene, pushed.fields)
        members, course = pushed.members, way(pushed.displacement)
        evenly = np.linspace(0.0, course[-1], _MOMENTS)
        chosen = np.unique(np.searchsorted(course, evenly).clip(max=len(course) - 1))
    lines = []
    for name, member in members.items():
        start = np.array(scene.nodes[scene.members[name].start].at, dtype=float)
        c, s, _ = scene.axis(name)
        lines.append(start + member.point[:, None] * np.array([c, s]) + member.path.shape[chosen])
    return ReferencePath(course[chosen], tuple(lines))


def _outlined(scene: Scene, fields: Fields) -> ReferencePath:
    """The outline of the one member of ``scene``, counter-clockwise, where its states were kept."""
    ((name, member),) = scene.members.items()
    c, s, _ = scene.axis(name)
    mesh = fields.continuum.mesh
    outline = np.concatenate(
        [
            _along(mesh.points, mesh.edges[side], axis)[::direction]
            for side, axis, direction in (("bottom", 0, 1), ("right", 1, 1), ("top", 0, -1), ("left", 1, -1))
        ]
    )
    start = np.array(scene.nodes[member.start].at, dtype=float)
    shapes = [mesh.points + fields.continuum.nodal_displacement(state.displacement) for state in fields.states]
    line = np.array([start + shape[outline] @ np.array([[c, s], [-s, c]]) for shape in shapes])
    return ReferencePath(way(np.array(fields.displacement)), (line,))


def _along(points: np.ndarray, sides: np.ndarray, axis: int) -> np.ndarray:
    """Nodes of one edge of a mesh in the order of a coordinate, the first, the last and some between."""
    nodes = np.unique(sides)
    nodes = nodes[np.argsort(points[nodes, axis])]
    chosen: np.ndarray = nodes[np.unique(np.linspace(0, len(nodes) - 1, _SIDE).round().astype(int))]
    return chosen


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
    return ReferenceShape(path.lines, time, f"reference ({_model(scene)})")


def _model(scene: Scene) -> str:
    if scene.pushed is not None and wants_plane_stress(scene):
        return "plane stress"
    return "ideal hinges" if scene.yielding == "ideal-hinges" else "fibre beams"
