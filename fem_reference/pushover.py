"""The reference answer to a pushover: a curve and how wrong it may be."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem_reference.frame import build_frame
from fem_reference.paths import push
from scene import Scene

#: Points on the path at which the load is quoted.
POINTS = 200
_COARSEST = (10, 24)
_MOST_REFINEMENTS = 5


@dataclass(frozen=True)
class Pushover:
    """A load–displacement curve with its estimated error.

    Attributes
    ----------
    method : str
        What was solved, in words.
    displacement : (k,) float
        Displacement of the pushed node along the push [m], from 0.
    load : (k,) float
        Force on it along the push [N].
    error_estimate : float
        Largest difference from the curve of the next coarser model, over the largest load [-]. The errors of both
        models fall at least linearly with refinement, so the finer one is nearer to the truth than that. Never less
        than by how far the whole frame is out of balance.
    elements : int
        Elements a member.
    fibres : int
        Fibres a section.
    seconds : float
        Time that all refinements took.
    """

    method: str
    displacement: np.ndarray
    load: np.ndarray
    error_estimate: float
    elements: int
    fibres: int
    seconds: float


def pushover(scene: Scene, tolerance: float = 5e-4, watch: Callable[[float], None] = lambda share: None) -> Pushover:
    """Push ``scene`` with finer and finer models until the estimated error is at most ``tolerance``.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Largest error of the load, as a share of the largest load [-].
    watch : callable
        Told the finished share of the current model's path.

    Returns
    -------
    Pushover
        From the finest model; its ``error_estimate`` says whether ``tolerance`` was met within five refinements.

    Raises
    ------
    NotConverged
        When no equilibrium is found.
    """
    started = time.perf_counter()
    elements, fibres = _COARSEST
    uniform = np.linspace(0.0, scene.push.distance, POINTS + 1)
    distances = _resolved(uniform, np.append(0.0, _loads(scene, elements, fibres, uniform[1:], watch)[0]))[1:]
    coarse, _ = _loads(scene, elements, fibres, distances, watch)
    for _ in range(_MOST_REFINEMENTS):
        elements, fibres = 2 * elements, 2 * fibres
        fine, imbalance = _loads(scene, elements, fibres, distances, watch)
        error = max(float(np.abs(fine - coarse).max() / np.abs(fine).max()), imbalance)
        if error <= tolerance:
            break
        coarse = fine
    theories = " and ".join(sorted({m.theory.replace("-", "–").title() for m in scene.members.values()}))
    return Pushover(
        method=f"displacement-based fibre beam elements ({theories}, cubic Hermite), small displacements",
        displacement=np.append(0.0, distances),
        load=np.append(0.0, fine),
        error_estimate=error,
        elements=elements,
        fibres=fibres,
        seconds=time.perf_counter() - started,
    )


def _resolved(distance: np.ndarray, load: np.ndarray) -> np.ndarray:
    """As many distances again, closer where the curve bends, so that straight lines between them follow it.

    The error of a chord is h² |F''| / 8, so steps go with |F''|^(-1/2); half of the points are spread evenly.
    """
    bend = np.abs(np.gradient(np.gradient(load, distance), distance))
    density = np.sqrt(np.convolve(bend, np.full(5, 0.2), mode="same"))
    density = density / np.trapezoid(density, distance) + 1.0 / distance[-1]
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(distance)
    share = np.append(0.0, np.cumsum(steps))
    resolved: np.ndarray = np.interp(np.linspace(0.0, share[-1], len(distance)), share, distance)
    return resolved


def _loads(
    scene: Scene, elements: int, fibres: int, distances: np.ndarray, watch: Callable[[float], None]
) -> tuple[np.ndarray, float]:
    frame = build_frame(scene, elements, fibres)
    pattern = np.zeros(frame.size)
    pattern[frame.node_dofs[scene.push.node][:2]] = scene.push_direction()
    return push(frame, pattern, distances, watch)
