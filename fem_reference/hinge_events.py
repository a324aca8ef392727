"""Where and when plastic hinges form along a path.

A hinge is a section whose moment has reached M_pl,N, that of the wholly plastic section beside its axial force N. With
the area below the neutral axis

    A_t = (A + N / fy) / 2   in tension,   M_pl,N = 2 fy |∫ y dA|  over A_t,

and of several materials likewise with the forces fy dA in place of areas.

Without hardening a fibre section comes to it in the limit only. Near it 1 - M / M_pl,N goes with κ^-2, and the
rotation, ∫ κ dx over the plastic zone, lacks a share in proportion to (1 - M / M_pl,N)^(1/2) of what it will be when
the hinge is there. So that root falls to zero in proportion to the load that is still missing, and the hinge's load is
where the line through the root at `NEAR` and at `FULL` meets zero. With hardening, M passes M_pl,N: that is the load.
An ideal hinge's moment rises in a straight line until it is there: the line through the two points before tells where.

A hinge that grows along its member is one hinge, and so is one at a node where just two member ends meet.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from fem_reference.frame import Frame
from fem_reference.paths import Trace
from scene import Scene

#: Shares of M_pl,N from which the load at which it is reached is found; the second makes a section a hinge.
NEAR, FULL = 0.995, 0.9992
#: Share of M_p at which an ideal hinge has formed.
THERE = 1.0 - 1e-6
#: Share of a path's last rise at which it is as good as level.
_LEVEL = 0.999


@dataclass(frozen=True)
class Hinge:
    """Where a plastic hinge is.

    Attributes
    ----------
    member : str
    position : float
        From the member's start [m].
    node : str
        The node it is at, or empty.
    """

    member: str
    position: float
    node: str


@dataclass(frozen=True)
class HingeEvent(Hinge):
    """A plastic hinge that forms along a path.

    Attributes
    ----------
    load, displacement : float
        The path's load and displacement when it forms.
    error_estimate : float
        Difference of the load from that of the next coarser model, over the largest load; 1 where that has no such
        hinge.
    displacement_error : float, optional
        Difference of the displacement [m]; None where that has no such hinge.
    """

    load: float
    displacement: float
    error_estimate: float = 1.0
    displacement_error: float | None = None


Found = TypeVar("Found", bound=Hinge)


def nearest(hinge: Found, others: Iterable[Found]) -> Found | None:
    """The one of ``others`` at the same node, or else the nearest along the same member; the first of several."""
    same = [h for h in others if h.node == hinge.node and (h.node or h.member == hinge.member)]
    return min(same, key=lambda h: (h.member != hinge.member, abs(h.position - hinge.position)), default=None)


def plastic_moment(
    y: np.ndarray, area: np.ndarray, yield_stress: float | np.ndarray, N: np.ndarray, M: np.ndarray
) -> np.ndarray:
    """|M_pl,N| of fibres at ``y`` with ``area`` beside axial forces ``N``, for moments of the signs of ``M`` [N m]."""
    order = np.argsort(y)
    force = (area * yield_stress)[order]
    below = np.append(0.0, np.cumsum(force))
    first = np.append(0.0, np.cumsum(force * y[order]))
    tension = np.clip(0.5 * (below[-1] + N), 0.0, below[-1])
    lower = np.interp(np.where(M >= 0.0, tension, below[-1] - tension), below, first)
    return np.asarray(np.abs(first[-1] - 2.0 * lower))


def utilisation(frame: Frame, stress: np.ndarray) -> np.ndarray:
    """|M| / M_pl,N at every point of a path and quadrature point, (k, n, 2), from (N, M, Q) there, (k, n, 2, 3)."""
    shares = []
    start = 0
    for mesh in frame.meshes.values():
        count = len(mesh.weights)
        sections, kind = frame.sections, frame.sections.kind[start]
        N, M = stress[:, start : start + count, :, 0], stress[:, start : start + count, :, 1]
        of = sections.material[kind]
        fy = sections.youngs_modulus[of] * sections.breaks[of, 0]
        full = plastic_moment(sections.y[kind], sections.area[kind], fy, N, M)
        shares.append(np.abs(M) / np.maximum(full, 1e-12 * full.max()))
        start += count
    return np.concatenate(shares, axis=1)


def hinge_events(frame: Frame, scene: Scene, trace: Trace) -> tuple[HingeEvent, ...]:
    """Hinges of a path in the order in which they form."""
    share, load = utilisation(frame, np.array(trace.stress)), np.array(trace.load)
    displacement = np.array(trace.displacement)
    found: list[tuple[float, str, int, float, float, float]] = []
    for name, point, station, history in full_sections(frame, share):
        if scene.yielding == "ideal-hinges":
            time, at = _ideal_hinge(history, load, displacement)
        else:
            time = _time_of_hinge(history, load)
            at = [float(np.interp(time, np.arange(len(load)), values)) for values in (load, displacement)]
        found.append((time, name, point, station, at[0], at[1]))
    loads = {(name, point): at for _, name, point, _, *at in found}
    kept = apart(scene, [(time, name, point, station) for time, name, point, station, *_ in found])
    return tuple(HingeEvent(name, station, node, *loads[name, point]) for _, name, point, station, node in kept)


def full_sections(frame: Frame, share: np.ndarray, level: float = FULL) -> Iterator[tuple[str, int, float, np.ndarray]]:
    """Every section whose ``share`` of M_pl,N (k, n, 2) comes to ``level``.

    As its member, quadrature point in order along it, distance from its start [m] and share (k,).
    """
    start = 0
    for name, mesh in frame.meshes.items():
        count = len(mesh.weights)
        order = np.argsort(mesh.stations.ravel())
        history = share[:, start : start + count].reshape(len(share), -1)[:, order]
        stations = mesh.stations.ravel()[order]
        start += count
        for point in np.flatnonzero((history >= level).any(axis=0)):
            yield name, int(point), float(stations[point]), history[:, point]


def apart(
    scene: Scene, found: list[tuple[float, str, int, float]], travelling: bool = False
) -> list[tuple[float, str, int, float, str]]:
    """The sections that became hinges, in order of time, less those that an earlier hinge has grown to.

    Parameters
    ----------
    scene : Scene
    found : list of (float, str, int, float)
        When, in which member, at which quadrature point in order along it, and how far from its start [m].
    travelling : bool
        Whether a hinge that has grown along its member to a node counts there again.

    Returns
    -------
    list of (float, str, int, float, str)
        The same with the node it is at, or empty.
    """
    kept = []
    zones: dict[str, list[tuple[int, float]]] = {name: [] for name in scene.members}
    begun: dict[str, list[tuple[int, float]]] = {name: [] for name in scene.members}
    seen: set[str] = set()
    for time, name, point, station in sorted(found):
        near = 0.5 * scene.members[name].section.depth
        node = _node_at(scene, name, station)
        known = begun[name] if travelling and node else zones[name]
        grown = any(abs(point - j) <= 1 or abs(station - x) <= near for j, x in known)
        zones[name].append((point, station))
        if grown or (node in seen and _ends_at(scene, node) == 2):
            continue
        if node:
            seen.add(node)
        begun[name].append((point, station))
        kept.append((time, name, point, station, node))
    return kept


def first_time(values: np.ndarray, level: float) -> float:
    """Where along a path, in points, ``values`` first come to ``level``."""
    k = int(np.argmax(values >= level))
    return k - 1 + float((level - values[k - 1]) / (values[k] - values[k - 1])) if k else 0.0


def _time_of_hinge(share: np.ndarray, load: np.ndarray) -> float:
    """Where along a path, in points, a section with M / M_pl,N = ``share`` becomes a hinge."""
    if share.max() > 1.0 + 1e-6:
        return first_time(share, 1.0)
    index = np.arange(len(load))
    near, full = first_time(share, NEAR), first_time(share, FULL)
    here, there = np.interp([near, full], index, load)
    root_near, root_full = np.sqrt(1.0 - NEAR), np.sqrt(1.0 - FULL)
    missing = abs(there - here) * root_full / (root_near - root_full)
    # From there on, while the section stays full, the path's own load. A path may turn level before that much is found.
    left = (index > full) & (share < FULL)
    stop = int(np.argmax(left)) if left.any() else len(load)
    found = np.where((index >= full) & (index < stop), np.abs(load - there), 0.0)
    return max(full, first_time(found, min(missing, _LEVEL * found.max())))


def _ideal_hinge(share: np.ndarray, load: np.ndarray, displacement: np.ndarray) -> tuple[float, list[float]]:
    """Where along a path, in points, an ideal hinge with M / M_p = ``share`` forms; its load and displacement."""
    k = int(np.argmax(share >= THERE))
    if k < 2:
        time = first_time(share, THERE)
        return time, [float(np.interp(time, [0, 1], values[:2])) for values in (load, displacement)]
    reach = float((1.0 - share[k - 1]) / (share[k - 1] - share[k - 2]))
    at = [float(values[k - 1] + reach * (values[k - 1] - values[k - 2])) for values in (load, displacement)]
    return k - 1 + (at[1] - displacement[k - 1]) / (displacement[k] - displacement[k - 1]), at


def _node_at(scene: Scene, name: str, station: float) -> str:
    member, length = scene.members[name], scene.axis(name)[2]
    if station <= 1e-9 * length:
        return member.start
    return member.end if station >= (1.0 - 1e-9) * length else ""


def _ends_at(scene: Scene, node: str) -> int:
    return sum((node == member.start) + (node == member.end) for member in scene.members.values())
