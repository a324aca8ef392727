"""How far a model's motion is from the reference's, by kind."""

from __future__ import annotations

from dataclasses import dataclass

import msgspec
import numpy as np

from fem_reference import HISTORY_SHARE, MotionResult
from scene import Scene
from scene.actions import unit_vector
from scene.watched import extreme
from sim import Course


@dataclass(frozen=True)
class MotionErrors:
    """Errors of a model's motion, as shares of the reference's peak where nothing else is said [-].

    Attributes
    ----------
    peak : float
        Largest displacement by size, signed.
    residual : float
        Displacement at rest, signed.
    history : float
        Largest difference at any time: a little out of step, it is large where the motion is fast.
    peak_time : float
        When the largest displacement is reached, signed, over the duration; looked for no further from when the
        reference has it than a quarter of the first natural period, where several swings are as large.
    plastic_work : float or None
        Signed, over the reference's; None where that dissipates nothing.
    """

    peak: float
    residual: float
    history: float
    peak_time: float
    plastic_work: float | None

    @property
    def worst(self) -> float:
        """What a target holds for: the error of the peak, of what remains, or a tenth of that at any time."""
        return max(abs(self.peak), abs(self.residual), HISTORY_SHARE * self.history)


def watching(scene: Scene, node: str) -> Scene:
    """``scene`` with its motion watched at ``node``."""
    return msgspec.structs.replace(scene, motion=scene.motion and msgspec.structs.replace(scene.motion, watch=node))


def compare_motion(scene: Scene, reference: MotionResult, course: Course, frequency: float) -> MotionErrors:
    """How far ``course`` is from ``reference``, whose node it watches; ``frequency`` is the reference's first [Hz]."""
    assert scene.motion is not None
    along = np.array(unit_vector(scene.motion.direction))
    size, duration = abs(reference.peak), float(scene.motion.duration)
    rest, wanted = (float(along @ at.residual[reference.node]) for at in (course, reference))
    near = np.flatnonzero(
        np.abs(course.time - reference.peak_time) <= (0.25 / frequency if frequency > 0.0 else np.inf)
    )
    swing = int(near[0]) + extreme(np.maximum(np.sign(reference.peak) * course.displacement[near], 0.0))[1]
    history = np.interp(course.time, reference.time, reference.displacement) - course.displacement
    work = float(reference.plastic[-1])
    return MotionErrors(
        peak=abs(course.peak) / size - 1.0,
        residual=(rest - wanted) / size,
        history=float(np.abs(history).max()) / size,
        peak_time=(swing * float(course.time[1]) - reference.peak_time) / duration,
        plastic_work=course.dissipated / work - 1.0 if work > 1e-6 * float(np.abs(reference.external).max()) else None,
    )
