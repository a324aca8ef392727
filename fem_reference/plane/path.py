"""Equilibrium paths of a plane body: dead loads, then a programme of displacements or loads of the pushed edge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from fem_reference.paths import NotConverged
from fem_reference.plane.continuum import State
from fem_reference.plane.equilibrium import Body, Control

_UNLOADING_STEPS = 8


@dataclass
class Trace:
    """A path point by point; k points, the first under dead loads alone.

    Attributes
    ----------
    displacement, load : list of float
        Of the pushed edge along the push [m, N].
    external, elastic, plastic : list of float
        Work of all loads, energy that unloading would give back, plastic work [J].
    imbalance : float
        Largest resultant of the out-of-balance forces, over the largest load or reaction [-].
    residuals : list of list of float
        Largest out-of-balance force by iteration of each step, over the largest force [-].
    snapshots : list of (float, State)
        Displacement and state at the points that were asked for.
    stopped : str
        Why the path ends before its programme does; empty when it does not.
    """

    displacement: list[float] = field(default_factory=list)
    load: list[float] = field(default_factory=list)
    external: list[float] = field(default_factory=list)
    elastic: list[float] = field(default_factory=list)
    plastic: list[float] = field(default_factory=list)
    imbalance: float = 0.0
    residuals: list[list[float]] = field(default_factory=list)
    snapshots: list[tuple[float, State]] = field(default_factory=list)
    stopped: str = ""


def trace(
    body: Body,
    legs: Sequence[np.ndarray],
    control: Control = "displacement",
    unload: bool = False,
    snapshots: int = 0,
    watch: Callable[[float], None] = lambda share: None,
) -> Trace:
    """The path of ``body`` through ``legs``.

    Parameters
    ----------
    body : Body
        Left at the end of its path.
    legs : sequence of (k,) float
        Displacements from where the edge is under dead loads [m], or loads [N], leg by leg.
    control : str
        Which of the two.
    unload : bool
        Whether to go back to zero load at the end.
    snapshots : int
        At how many points, evenly chosen, the whole state is kept; always at the last.
    watch : callable
        Told the finished share of the path, 0 to 1.

    Raises
    ------
    NotConverged
        When the dead loads find no equilibrium. Later on, the path so far is returned.
    """
    body.carry_dead_loads()
    points = Trace()
    start = body.position
    total = sum(len(leg) for leg in legs) + (_UNLOADING_STEPS if unload else 0)
    kept = set(np.linspace(0, total, snapshots).round().astype(int).tolist())

    def record() -> None:
        points.displacement.append(body.position - start)
        points.load.append(body.load)
        points.external.append(body.external)
        points.elastic.append(body.continuum.elastic_energy(body.state))
        points.plastic.append(body.plastic)
        points.imbalance = body.imbalance
        if len(points.load) - 1 in kept:
            points.snapshots.append((points.displacement[-1], body.state))
        watch((len(points.load) - 1) / total if total else 1.0)

    record()
    try:
        for leg in legs:
            body.turn()
            for goal in leg:
                moved = body.move_to(start + goal) if control == "displacement" else body.load_to(float(goal))
                points.residuals += moved
                record()
        if unload:
            body.turn()
            for load in body.load * np.linspace(1.0, 0.0, _UNLOADING_STEPS + 1)[1:]:
                points.residuals += body.load_to(float(load))
                record()
    except NotConverged as error:
        points.stopped = str(error)
        if (body.position - start, body.load) != (points.displacement[-1], points.load[-1]):
            record()  # how far it came on the way to the next point
        if snapshots and len(points.load) - 1 not in kept:
            points.snapshots.append((points.displacement[-1], body.state))
    return points
