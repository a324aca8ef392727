"""What a push asks of a frame: dead loads first, then the push under its kind of control, then perhaps back to zero."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from fem_reference.arc_length import follow_arc
from fem_reference.frame import Frame
from fem_reference.paths import NotConverged, State, Trace
from scene import Push

_UNLOADING_STEPS = 20
#: Steps beyond a load that is not borne, each this share of the displacement there; a load that has fallen by more than
#: that share of itself has passed a limit point.
_PROBES, _PROBE, _FALLEN = 10, 0.01, 1e-6
# By so much of itself the displacement goes on where the load finds no way; a load is met to about that share.
_NUDGE = 1e-4


def trace(
    frame: Frame,
    control: np.ndarray,
    push: Push,
    legs: Sequence[np.ndarray],
    watch: Callable[[float], None] = lambda share: None,
) -> Trace:
    """The path of ``frame`` through ``legs``.

    Parameters
    ----------
    frame : Frame
    control : (size,) float
        Vector c: the displacement under control is c · d.
    push : Push
        Says what leads, and whether to go back to λ = 0 at the end.
    legs : sequence of (k,) float
        Displacements under control at which points are wanted, leg by leg, from where it is under dead loads [m];
        loads, under load control. Arc-length control goes to the last of them in steps of its own.
    watch : callable
        Told the finished share of the path, 0 to 1.

    Raises
    ------
    NotConverged
        When the dead loads find no equilibrium. Later on, the path so far is returned.
    """
    state = State(frame, control)
    state.carry_dead_loads()
    points = Trace()
    start = state.position
    state.record(points, start)
    try:
        if push.control == "arc-length":
            follow_arc(state, points, float(legs[-1][-1]), watch)
        else:
            _follow_legs(state, points, start, push, legs, watch)
        if push.unload:
            state.slope = None
            for load in state.load * np.linspace(1.0, 0.0, _UNLOADING_STEPS + 1)[1:]:
                state.load_to(float(load))
                state.record(points, start)
    except NotConverged as error:
        points.stopped = str(error)
        if push.control == "load":
            points.stopped = f"{_what_ends(state)}: {error}"
    return points


def _follow_legs(
    state: State,
    points: Trace,
    start: float,
    push: Push,
    legs: Sequence[np.ndarray],
    watch: Callable[[float], None],
) -> None:
    total = sum(len(leg) for leg in legs)
    for leg in legs:
        state.slope = None
        for target in leg:
            if push.control == "load":
                _raise_load(state, float(target))
            else:
                state.move_to(start + float(target))
            state.record(points, start)
            watch((len(points.load) - 1) / total)


def _raise_load(state: State, target: float) -> None:
    """Step to a load, past kinks of the path at which no step of the load finds equilibrium, by the displacement."""
    while True:
        try:
            state.load_to(target)
            return
        except NotConverged:
            load, state.slope = state.load, None
            state.move_to(state.position + _NUDGE * state.position)
            if abs(state.load) >= abs(target):
                return
            if abs(state.load) <= abs(load) * (1.0 + _FALLEN):
                raise


def _what_ends(state: State) -> str:
    """Whether a load that can grow no more falls or stays when the displacement goes on: limit point or mechanism."""
    load, step = state.load, _PROBE * abs(state.position)
    state.slope = None
    try:
        for _ in range(_PROBES):
            state.move_to(state.position + step)
    except NotConverged:
        return "limit point or mechanism"
    return "limit point" if state.load < load * (1.0 - _FALLEN) else "mechanism"
