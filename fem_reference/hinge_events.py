"""Where and when plastic hinges form along a path.

A hinge is a section whose moment has reached M_pl,N, that of the wholly plastic section beside its axial force N. With
the area below the neutral axis

    A_t = (A + N / fy) / 2   in tension,   M_pl,N = 2 fy |∫ y dA|  over A_t.

Without hardening a fibre section comes to it in the limit only. Near it 1 - M / M_pl,N goes with κ^-2, and the
rotation, ∫ κ dx over the plastic zone, lacks a share in proportion to (1 - M / M_pl,N)^(1/2) of what it will be when
the hinge is there. So that root falls to zero in proportion to the load that is still missing, and the hinge's load is
where the line through the root at `NEAR` and at `FULL` meets zero. With hardening, M passes M_pl,N: that is the load.
An ideal hinge's moment rises in a straight line until it is there: the line through the two points before tells where.

A hinge that grows along its member is one hinge, and so is one at a node where just two member ends meet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.frame import Frame
from fem_reference.paths import Trace
from scene import Scene

#: Shares of M_pl,N from which the load at which it is reached is found; the second makes a section a hinge.
NEAR, FULL = 0.995, 0.9992
#: Share of M_p at which an ideal hinge has formed.
_THERE = 1.0 - 1e-6
#: Share of a path's last rise at which it is as good as level.
_LEVEL = 0.999


@dataclass(frozen=True)
class HingeEvent:
    """A plastic hinge that forms.

    Attributes
    ----------
    member : str
    position : float
        From the member's start [m].
    node : str
        The node it is at, or empty.
    load, displacement : float
        The path's load and displacement when it forms.
    error_estimate : float
        Difference of the load from that of the next coarser model, over the largest load; 1 where that has no such
        hinge.
    displacement_error : float, optional
        Difference of the displacement [m]; None where that has no such hinge.
    """

    member: str
    position: float
    node: str
    load: float
    displacement: float
    error_estimate: float = 1.0
    displacement_error: float | None = None


def plastic_moment(y: np.ndarray, area: np.ndarray, yield_stress: float, N: np.ndarray, M: np.ndarray) -> np.ndarray:
    """|M_pl,N| of fibres at ``y`` with ``area`` beside axial forces ``N``, for moments of the signs of ``M`` [N m]."""
    order = np.argsort(y)
    below = np.append(0.0, np.cumsum(area[order]))
    first = np.append(0.0, np.cumsum((area * y)[order]))
    whole = below[-1]
    tension = np.clip(0.5 * (whole + N / yield_stress), 0.0, whole)
    return np.asarray(
        2.0 * yield_stress * np.abs(np.interp(np.where(M >= 0.0, tension, whole - tension), below, first))
    )


def utilisation(frame: Frame, trace: Trace) -> np.ndarray:
    """|M| / M_pl,N at every point of the path and quadrature point, (k, n, 2)."""
    stress = np.array(trace.stress)
    shares = []
    start = 0
    for mesh in frame.meshes.values():
        count = len(mesh.weights)
        sections, kind = frame.sections, frame.sections.kind[start]
        N, M = stress[:, start : start + count, :, 0], stress[:, start : start + count, :, 1]
        fy = float(sections.youngs_modulus[kind] * sections.breaks[kind, 0])
        full = plastic_moment(sections.y[kind], sections.area[kind], fy, N, M)
        shares.append(np.abs(M) / np.maximum(full, 1e-12 * full.max()))
        start += count
    return np.concatenate(shares, axis=1)


def hinge_events(frame: Frame, scene: Scene, trace: Trace) -> tuple[HingeEvent, ...]:
    """Hinges of a path in the order in which they form."""
    share, load, displacement = utilisation(frame, trace), np.array(trace.load), np.array(trace.displacement)
    found: list[tuple[float, str, int, float, float, float]] = []
    start = 0
    for name, mesh in frame.meshes.items():
        count = len(mesh.weights)
        order = np.argsort(mesh.stations.ravel())
        history = share[:, start : start + count].reshape(len(share), -1)[:, order]
        stations = mesh.stations.ravel()[order]
        start += count
        for i in np.flatnonzero((history >= FULL).any(axis=0)):
            if scene.yielding == "ideal-hinges":
                time, at = _ideal_hinge(history[:, i], load, displacement)
            else:
                time = _time_of_hinge(history[:, i], load)
                at = [float(np.interp(time, np.arange(len(load)), values)) for values in (load, displacement)]
            found.append((time, name, int(i), float(stations[i]), at[0], at[1]))
    events: list[HingeEvent] = []
    zones: dict[str, list[tuple[int, float]]] = {name: [] for name in frame.meshes}
    seen: set[str] = set()
    for _, name, point, station, *at in sorted(found):
        near = 0.5 * scene.members[name].section.depth
        grown = any(abs(point - j) <= 1 or abs(station - x) <= near for j, x in zones[name])
        zones[name].append((point, station))
        node = _node_at(scene, name, station)
        if grown or (node in seen and _ends_at(scene, node) == 2):
            continue
        if node:
            seen.add(node)
        events.append(HingeEvent(name, station, node, *at))
    return tuple(events)


def _first_time(values: np.ndarray, level: float) -> float:
    """Where along a path, in points, ``values`` first come to ``level``."""
    k = int(np.argmax(values >= level))
    return k - 1 + float((level - values[k - 1]) / (values[k] - values[k - 1])) if k else 0.0


def _time_of_hinge(share: np.ndarray, load: np.ndarray) -> float:
    """Where along a path, in points, a section with M / M_pl,N = ``share`` becomes a hinge."""
    if share.max() > 1.0 + 1e-6:
        return _first_time(share, 1.0)
    index = np.arange(len(load))
    near, full = _first_time(share, NEAR), _first_time(share, FULL)
    here, there = np.interp([near, full], index, load)
    root_near, root_full = np.sqrt(1.0 - NEAR), np.sqrt(1.0 - FULL)
    missing = abs(there - here) * root_full / (root_near - root_full)
    # From there on, while the section stays full, the path's own load. A path may turn level before that much is found.
    left = (index > full) & (share < FULL)
    stop = int(np.argmax(left)) if left.any() else len(load)
    found = np.where((index >= full) & (index < stop), np.abs(load - there), 0.0)
    return max(full, _first_time(found, min(missing, _LEVEL * found.max())))


def _ideal_hinge(share: np.ndarray, load: np.ndarray, displacement: np.ndarray) -> tuple[float, list[float]]:
    """Where along a path, in points, an ideal hinge with M / M_p = ``share`` forms; its load and displacement."""
    k = int(np.argmax(share >= _THERE))
    if k < 2:
        time = _first_time(share, _THERE)
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
