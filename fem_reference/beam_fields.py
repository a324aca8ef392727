"""Members along a path as files that ParaView opens: lines with displacements, forces, curvatures, plastic strains."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_reference.member_results import MemberPath, MemberResult
from fem_reference.vtu import series, vtu_text
from scene import Scene

#: States of a series.
_STATES = 13


def push_field_files(
    scene: Scene, members: Mapping[str, MemberResult], displacement: np.ndarray, name: str = "fields"
) -> dict[str, str]:
    """Text of ``name``.pvd and of one VTU file a state, by file name.

    The time of a state in the series is the way of the pushed node so far [m]; ``displacement`` (k,) is its path.
    """
    way = np.append(0.0, np.cumsum(np.abs(np.diff(displacement))))
    chosen = np.unique([int(np.argmin(np.abs(way - share * way[-1]))) for share in np.linspace(0.0, 1.0, _STATES)])
    return _files(scene, members, chosen.tolist(), way[chosen].tolist(), name)


def motion_field_files(
    scene: Scene, members: Mapping[str, MemberResult], time: np.ndarray, name: str = "fields"
) -> dict[str, str]:
    """The same at every ``time`` (k,) [s] for which the paths of ``members`` have a point."""
    return _files(scene, members, list(range(len(time))), time.tolist(), name)


def _files(
    scene: Scene, members: Mapping[str, MemberResult], chosen: list[int], times: list[float], name: str
) -> dict[str, str]:
    places = [_places(scene, member_name, member) for member_name, member in members.items()]
    first = np.cumsum([0, *(len(place) for place in places)])
    cells = np.concatenate([np.arange(len(p) - 1)[:, None] + [0, 1] + i for p, i in zip(places, first, strict=False)])
    points, of = np.concatenate(places), list(members.values())
    return series(name, times, [vtu_text(points, "line", cells, _values(of, k)) for k in chosen])


def _places(scene: Scene, name: str, member: MemberResult) -> np.ndarray:
    """Element ends of a member, undeformed, (j, 2)."""
    c, s, _ = scene.axis(name)
    return np.asarray(np.array(scene.nodes[scene.members[name].start].at) + member.point[:, None] * np.array([c, s]))


def _values(members: list[MemberResult], k: int) -> dict[str, np.ndarray]:
    """What is known at the element ends at point ``k`` of the path; straight lines between quadrature points."""
    values = {"displacement": np.concatenate([member.path.shape[k] for member in members])}
    for key in ("axial_force", "shear_force", "moment", "curvature", "plastic_strain"):
        values[key] = np.concatenate([_at_ends(member, member.path, key, k) for member in members])
    return values


def _at_ends(member: MemberResult, path: MemberPath, key: str, k: int) -> np.ndarray:
    return np.asarray(np.interp(member.point, member.station, getattr(path, key)[k]))
