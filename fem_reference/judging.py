"""How far two models of a push differ, and what its path came to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem_reference.hinge_events import HingeEvent, nearest
from fem_reference.paths import Trace
from scene import Scene

#: A path is level when its last slope is below this share of its first.
_LEVEL = 1e-4


def difference(scene: Scene, fine: Trace, coarse: Trace) -> float:
    """Largest difference of the loads over the largest load, along the part that both have; 1 when one has no more than
    a start.

    Under load or arc-length control points do not lie at the same displacements: then it is the largest distance from a
    point of one curve to the other, with load and displacement as shares of their largest values.
    """
    both = min(len(fine.load), len(coarse.load))
    if both < 2:
        return 1.0
    if scene.push.control == "displacement":
        a, b = np.array(fine.load[:both]), np.array(coarse.load[:both])
        return float(np.abs(a - b).max() / np.abs(a).max())
    size = np.abs([fine.displacement, fine.load]).max(axis=1)
    points, others = (np.column_stack([path.displacement, path.load]) / size for path in (fine, coarse))
    if scene.push.control == "load":
        points = points[:both]
    start, span = others[:-1], np.diff(others, axis=0)
    along = np.einsum("pki,ki->pk", points[:, None] - start, span) / np.maximum(np.sum(span**2, axis=1), 1e-300)
    nearest = start + np.clip(along, 0.0, 1.0)[..., None] * span
    return float(np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1).max())


def energy_error(fine: Trace, coarse: Trace) -> float:
    """Largest difference of any energy from the coarser model's, over the largest external work [-]."""
    both = min(len(fine.load), len(coarse.load))
    pairs = ((fine.external, coarse.external), (fine.elastic, coarse.elastic), (fine.plastic, coarse.plastic))
    worst = max(float(np.abs(np.array(a[:both]) - np.array(b[:both])).max()) for a, b in pairs)
    most = max(map(abs, fine.external))
    return worst / most if most else 0.0


def with_errors(fine: tuple[HingeEvent, ...], coarse: tuple[HingeEvent, ...], scale: float) -> tuple[HingeEvent, ...]:
    """``fine`` with the differences of its loads from the nearest hinges of ``coarse``."""
    judged = []
    for found in fine:
        event, near = found, nearest(found, coarse)
        if near is not None:
            load, moved = abs(near.load - event.load) / scale, abs(near.displacement - event.displacement)
            event = replace(event, error_estimate=load, displacement_error=moved)
        judged.append(event)
    return tuple(judged)


def outcome(scene: Scene, path: Trace) -> str:
    """What a path that ran to its end came to."""
    load, displacement = np.array(path.load), np.array(path.displacement)
    if len(scene.push.stops()) == 1 and not scene.push.unload and len(load) > 2:
        rising = np.diff(load)
        turns = np.flatnonzero((rising[:-1] > 0.0) & (rising[1:] < -_LEVEL * np.abs(rising).max())) + 1
        slopes = rising / np.diff(displacement)
        if scene.push.control == "arc-length" and turns.size:
            back = np.flatnonzero(np.diff(displacement) < 0.0)
            snap = f"; snap-back from a displacement of {displacement[back[0]]:.6g} m" if back.size else ""
            first = turns[0]
            return f"limit point: a load of {load[first]:.6g} at a displacement of {displacement[first]:.6g} m{snap}"
        peak = int(np.argmax(load))
        if peak < len(load) - 1 and slopes[-1] < -_LEVEL * slopes[0]:
            return (
                f"limit point: the load is largest, {load[peak]:.6g}, at a displacement of {displacement[peak]:.6g} m"
            )
        if abs(slopes[-1]) <= _LEVEL * slopes[0]:
            return f"mechanism: the load stays at {load[-1]:.6g}"
    return "reached the end of its programme"
