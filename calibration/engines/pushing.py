"""Pushing a scene over in somebody else's engine, the way the reference was pushed."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from calibration.engines.handover import Handover, PieceLoad, PushPoint
from fem_reference import PushAnswer

#: How long a push takes in simulated seconds, …
DURATION = 4.0
#: … how many steps at most a pusher waits for a pattern of loads to follow, until it bears less than a share of it, …
_WAIT, _BORNE = 12, 0.003
#: … and how long a scene may settle under its dead loads before.
SETTLING = 2.0
# Share of the time in which the pusher gathers speed.
_EASE = 0.1
#: Faster than this many times the pushed way in a second, a body has left the ground of facts.
_RUNAWAY = 1e6
#: Share of the pusher's force by which the pattern is corrected in each step.
_GAIN = 0.3


class Unstable(RuntimeError):
    """The engine's answer has run away."""


class Rig(Protocol):
    """An engine with the scene in it."""

    def place(self, body: int) -> tuple[float, float, float]:
        """Position of a body's centre and its angle [m, m, rad]."""

    def act(self, body: int, force: tuple[float, float], moment: float) -> None:
        """Have a force at the centre of a body and a moment act in the next step."""

    def hold(self) -> None:
        """Attach the pusher to the pushed point where it is now; it moves along the push only."""

    def step(self, travel: float) -> float:
        """Step once with the pusher at ``travel`` after it [m]; returns its force along the push [N].

        Before `hold`, nothing is pushed and the force is 0.
        """


@dataclass(frozen=True)
class Pushed:
    """What came of it.

    Attributes
    ----------
    displacement, load : (k,) float
        [m], and [N] or load factor.
    progress : (k,) float
        How far along the reference's points the pusher was.
    seconds : float
        Processor time that the steps took.
    simulated_seconds : float
    steps : int
    """

    displacement: np.ndarray
    load: np.ndarray
    progress: np.ndarray
    seconds: float
    simulated_seconds: float
    steps: int


def push_rig(rig: Rig, handover: Handover, push: PushPoint, distances: np.ndarray) -> Pushed:
    """Push the scene in ``rig`` to ``distances`` [m] one after the other.

    A pattern of proportional loads follows the pusher: its factor is changed in each step until the pusher, which
    prescribes the way, bears nothing.

    Raises
    ------
    Unstable
        When a body moves faster than makes any sense.
    """
    dt = handover.model.dt
    if handover.gravity != 0.0 or handover.dead_loads:
        settling = max(1, round(SETTLING / dt))
        for k in range(settling):
            _apply(rig, handover.dead_loads, min(1.0, 2.0 * (k + 1) / settling))
            rig.step(0.0)
    rig.hold()
    origin = _along(rig, push)
    steps = round(DURATION / dt)
    time_share = np.linspace(0.0, 1.0, steps + 1)
    eased = np.where(time_share < _EASE, time_share**2 / (2.0 * _EASE), time_share - 0.5 * _EASE)
    progress = eased / eased[-1] * (len(distances) - 1.0)
    travel = np.interp(progress, np.arange(len(distances)), distances)
    far = _RUNAWAY * float(np.abs(distances).max())
    size = math.hypot(*(part for load in handover.pattern for part in (*load.force, load.moment)))
    factor, taken, seconds = 0.0, 0, 0.0
    displacement, load = np.zeros(steps + 1), np.zeros(steps + 1)
    for k in range(1, steps + 1):
        for _ in range(_WAIT if handover.pattern else 1):
            _apply(rig, handover.dead_loads, 1.0)
            _apply(rig, handover.pattern, factor)
            started = time.thread_time()
            force = rig.step(float(travel[k]))
            seconds += time.thread_time() - started
            taken += 1
            if not handover.pattern or abs(force) <= _BORNE * abs(factor) * size:
                break
            factor += _GAIN * force / size
        displacement[k] = _along(rig, push) - origin
        load[k] = factor if handover.pattern else force
        if not (math.isfinite(displacement[k]) and abs(displacement[k]) < far):
            raise Unstable(f"the pushed node was at {displacement[k]:.3g} m after {k} steps")
    return Pushed(displacement, load, progress, seconds, taken * dt, taken)


def _apply(rig: Rig, loads: Sequence[PieceLoad], share: float) -> None:
    for load in loads:
        angle = rig.place(load.body)[2]
        c, s = math.cos(angle), math.sin(angle)
        (fx, fy), (px, py) = load.force, load.point
        moment = load.moment + (c * px - s * py) * fy - (s * px + c * py) * fx
        rig.act(load.body, (share * fx, share * fy), share * moment)


def _along(rig: Rig, push: PushPoint) -> float:
    """Where the pushed point is along the push [m]."""
    x, y, angle = rig.place(push.body)
    c, s = math.cos(angle), math.sin(angle)
    (px, py), (dx, dy) = push.point, push.direction
    return (x + c * px - s * py) * dx + (y + s * px + c * py) * dy


@dataclass(frozen=True)
class CurveErrors:
    """Errors of a curve as shares of the reference's largest load [-]; see `calibration.errors`."""

    path_max: float
    collapse_load: float


def curve_errors(reference: PushAnswer, pushed: Pushed) -> CurveErrors:
    """Errors at the reference's points, whose displacements were the pusher's."""
    points = np.arange(len(reference.load))
    turns = np.count_nonzero(np.diff(np.sign(np.diff(reference.displacement))))
    at = pushed.progress
    if turns == 0:  # where the node was, not where it was wanted
        at = np.interp(pushed.displacement, reference.displacement, points)
        order = np.argsort(at, kind="stable")
        load = np.interp(points, at[order], pushed.load[order])
    else:
        load = np.interp(points, at, pushed.load)
    largest = float(np.abs(reference.load).max())
    return CurveErrors(
        path_max=float(np.abs(load - reference.load).max()) / largest,
        collapse_load=float(np.abs(load).max()) / largest - 1.0,
    )
