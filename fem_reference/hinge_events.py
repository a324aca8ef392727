"""Where and when plastic hinges form along a path.

A fibre section yields gradually. It counts as a hinge when its moment first reaches `FULL` of M_pl,N, the moment of the
wholly plastic section beside the axial force N it bears at that time: with the area below the neutral axis

    A_t = (A + N / fy) / 2   in tension,   M_pl,N = 2 fy |∫ y dA|  over A_t.

A hinge that grows along its member is one hinge, and so is one at a node where just two member ends meet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.frame import Frame
from fem_reference.paths import Trace
from scene import Scene

#: Share of M_pl,N at which a section counts as a hinge.
FULL = 0.9995


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
    """

    member: str
    position: float
    node: str
    load: float
    displacement: float
    error_estimate: float = 1.0


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


def utilisation(frame: Frame, scene: Scene, trace: Trace) -> np.ndarray:
    """|M| / M_pl,N at every point of the path and quadrature point, (k, n, 2)."""
    stress = np.array(trace.stress)
    shares = []
    start = 0
    for name, mesh in frame.meshes.items():
        count = len(mesh.weights)
        sections = frame.sections
        N, M = stress[:, start : start + count, :, 0], stress[:, start : start + count, :, 1]
        full = plastic_moment(
            sections.y[start, 0], sections.area[start, 0], scene.members[name].material.yield_stress, N, M
        )
        shares.append(np.abs(M) / np.maximum(full, 1e-12 * full.max()))
        start += count
    return np.concatenate(shares, axis=1)


def hinge_events(frame: Frame, scene: Scene, trace: Trace) -> tuple[HingeEvent, ...]:
    """Hinges of a path in the order in which they form."""
    share = utilisation(frame, scene, trace)
    found: list[tuple[float, str, int, float]] = []
    start = 0
    for name, mesh in frame.meshes.items():
        count = len(mesh.weights)
        order = np.argsort(mesh.stations.ravel())
        history = share[:, start : start + count].reshape(len(share), -1)[:, order]
        stations = mesh.stations.ravel()[order]
        start += count
        for i in np.flatnonzero((history >= FULL).any(axis=0)):
            k = int(np.argmax(history[:, i] >= FULL))
            before = history[max(k - 1, 0), i]
            part = 1.0 if k == 0 else (FULL - before) / (history[k, i] - before)
            found.append((max(k - 1, 0) + part * (k > 0), name, int(i), float(stations[i])))
    events: list[HingeEvent] = []
    zones: dict[str, list[tuple[int, float]]] = {name: [] for name in frame.meshes}
    seen: set[str] = set()
    index = np.arange(len(trace.load))
    for time, name, point, station in sorted(found):
        near = 0.5 * scene.members[name].section.depth
        grown = any(abs(point - j) <= 1 or abs(station - x) <= near for j, x in zones[name])
        zones[name].append((point, station))
        node = _node_at(scene, name, station)
        if grown or (node in seen and _ends_at(scene, node) == 2):
            continue
        if node:
            seen.add(node)
        load, displacement = (float(np.interp(time, index, values)) for values in (trace.load, trace.displacement))
        events.append(HingeEvent(name, station, node, load, displacement))
    return tuple(events)


def _node_at(scene: Scene, name: str, station: float) -> str:
    member, length = scene.members[name], scene.axis(name)[2]
    if station <= 1e-9 * length:
        return member.start
    return member.end if station >= (1.0 - 1e-9) * length else ""


def _ends_at(scene: Scene, node: str) -> int:
    return sum((node == member.start) + (node == member.end) for member in scene.members.values())
