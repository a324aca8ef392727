"""Where and when plastic hinges form in a motion.

A hinge is a section whose moment has come to M_pl,N, as in `hinge_events`. In a motion there is no load to find it by:
it forms when |M| first is `NEAR` M_pl,N, for vibrations keep many a section from ever coming closer; an ideal hinge
when it first turns. Behind an impact a hinge may travel along its member (Parkes 1955); it is named where it begins,
and again at a node that it comes to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.frame import Frame
from fem_reference.hinge_events import NEAR, THERE, Hinge, apart, first_time, full_sections, nearest, utilisation
from scene import Scene


@dataclass(frozen=True)
class HingeTime(Hinge):
    """A plastic hinge that forms in a motion.

    Attributes
    ----------
    time : float
        When it forms [s].
    time_error : float, optional
        Difference from a model with half the elements, plus that from one with steps twice as long [s]; None where
        one of them has no such hinge.
    position_error : float, optional
        Likewise of the position [m].
    """

    time: float
    time_error: float | None = None
    position_error: float | None = None


def hinge_times(frame: Frame, scene: Scene, time: np.ndarray, stress: np.ndarray) -> tuple[HingeTime, ...]:
    """Hinges of a motion in the order in which they form, from (N, M, Q) (k, n, 2, 3) at the times (k,) [s]."""
    level, steps = THERE if scene.yielding == "ideal-hinges" else NEAR, np.arange(len(time))
    found = [
        (float(np.interp(first_time(share, level), steps, time)), name, point, station)
        for name, point, station, share in full_sections(frame, utilisation(frame, stress), level)
    ]
    return tuple(HingeTime(name, x, node, t) for t, name, _, x, node in apart(scene, found, travelling=True))


def with_time_errors(fine: tuple[HingeTime, ...], others: Sequence[tuple[HingeTime, ...]]) -> tuple[HingeTime, ...]:
    """``fine`` with its differences from the nearest hinges of each of the ``others``, summed."""
    judged = []
    for hinge in fine:
        pairs = [_twin(hinge, other) for other in others]
        twins = [twin for twin in pairs if twin is not None]
        if len(twins) == len(pairs):
            late = sum(abs(twin.time - hinge.time) for twin in twins)
            away = 0.0 if hinge.node else sum(abs(twin.position - hinge.position) for twin in twins)
            judged.append(replace(hinge, time_error=late, position_error=away))
        else:
            judged.append(hinge)
    return tuple(judged)


def _twin(hinge: HingeTime, others: tuple[HingeTime, ...]) -> HingeTime | None:
    """The nearest of ``others``, and of several in one place that which forms at nearly the same time."""
    return nearest(hinge, sorted(others, key=lambda h: abs(h.time - hinge.time)))
