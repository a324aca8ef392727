"""Tuning the joints to a motion: the cheapest rigid-body model whose peak, and what remains, are the reference's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import msgspec
import numpy as np

from calibration.frequencies import model_frequency, reference_frequency
from calibration.planner import motion_candidates, relative_cost
from calibration.trials import Failure
from capacity import Capacity, InputError
from fem_reference import MotionResult, motion, remarks
from scene import Scene
from scene.actions import unit_vector
from sim import Course, Model, SolverError, follow

#: The reference's peak and what remains must be known this many times better than the target.
REFERENCE_MARGIN = 3.0
#: What differs at any time counts as much less: it is nearly all a matter of being a little early or late, and yet a
#: model that swings otherwise has no right to the same peak.
HISTORY_SHARE = 0.1
#: How often the reference is asked for half its error as long as it is not known well enough.
_MOST_REFINEMENTS = 3


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


@dataclass(frozen=True)
class MotionTrial:
    """A model that was tried; ``cost`` is its `calibration.planner.relative_cost`."""

    model: Model
    course: Course
    errors: MotionErrors
    cost: float

    @property
    def seconds_per_simulated_second(self) -> float:
        """Time that a second of simulation takes."""
        return self.course.seconds / (self.course.steps * self.model.dt)


@dataclass(frozen=True)
class MotionCalibration:
    """A scene calibrated by its motion; attributes as those of `calibration.tuning.Calibration`.

    Attributes
    ----------
    frequency : (float, float)
        First natural frequency of the reference and of the best model [Hz]; 0 for a structure that is free to move.
    """

    name: str
    scene: Scene
    capacity: dict[str, Capacity]
    reference: MotionResult
    trials: tuple[MotionTrial, ...]
    failures: tuple[Failure, ...]
    best: MotionTrial
    frequency: tuple[float, float]
    target_error: float

    @property
    def uncertainty(self) -> float:
        """Estimated error of the reference's peak or of what remains, the larger, over the peak [-]."""
        return _uncertainty(self.reference)

    @property
    def target_met(self) -> bool:
        """Whether peak and residual are within the target, and the reference is good enough to say so."""
        return self.best.errors.worst <= self.target_error and self.reference_good_enough

    @property
    def reference_good_enough(self) -> bool:
        """Whether the reference is known within a third of the target."""
        return self.uncertainty <= self.target_error / REFERENCE_MARGIN

    @property
    def limit(self) -> str:
        """What keeps the error from falling below the target, in words; empty when it is met."""
        if self.target_met:
            return ""
        if not self.reference_good_enough:
            return (
                f"the reference's own peak and rest are only known within {100.0 * self.uncertainty:.2g} %, "
                f"and must be {REFERENCE_MARGIN:.0f} times better than the target"
            )
        return "neither more joints and fibres nor shorter steps than those tried bring peak and rest nearer"

    @property
    def frequency_error(self) -> float | None:
        """Signed, over the reference's; None for a structure that is free to move."""
        reference, model = self.frequency
        return model / reference - 1.0 if reference > 0.0 else None

    @property
    def remarks(self) -> tuple[str, ...]:
        """What to mind about beam theory and kinematics; empty when there is nothing."""
        return remarks(self.scene)


def calibrate_motion(
    scene: Scene,
    target_error: float = 0.01,
    name: str = "",
    watch: Callable[[str, float], None] = lambda what, share: None,
) -> MotionCalibration:
    """Find the cheapest model of ``scene`` whose peak and residual displacement are within ``target_error``.

    Parameters
    ----------
    scene : Scene
    target_error : float
        Largest allowed error of the watched node's peak, and of where it comes to rest, over the peak [-].
    name, watch
        As of `calibration.calibrate`.

    Raises
    ------
    ValueError
        When ``target_error`` is not between 0 and 1.
    InputError
        When the scene has no motion or no members.
    fem_reference.NotConverged, sim.SolverError
        When the reference, or every model, breaks down.
    """
    if not 0.0 < target_error < 1.0:
        raise ValueError(f"a target error of {target_error:g} is not between 0 and 1")
    if scene.motion is None:
        raise InputError("motion", "the scene has none", 'add [motion] with duration = "0.2 s"')
    reference = _reference(scene, target_error, lambda share: watch("reference", share))
    watched = msgspec.structs.replace(scene, motion=msgspec.structs.replace(scene.motion, watch=reference.node))
    yields = float(reference.plastic.max()) > target_error * float(np.abs(reference.external).max())
    models = motion_candidates(watched, yields=yields)
    frequency = reference_frequency(scene)
    trials: list[MotionTrial] = []
    failures: list[Failure] = []
    for i, model in enumerate(models):
        watch(f"model {i + 1}: {model.rule} {model.joints}, {model.law}, 1/{1.0 / model.dt:.0f} s", i / len(models))
        try:
            course = follow(watched, model)
        except SolverError as error:
            failures.append(Failure(model, str(error)))
            continue
        cost = relative_cost(model, scene.members, course.newton_steps)
        trials.append(MotionTrial(model, course, _compare(watched, reference, course, frequency), cost))
        if trials[-1].errors.worst <= target_error:
            break
    if not trials:
        raise SolverError(f"none of {len(failures)} models could be stepped; the last said: {failures[-1].reason}")
    met = [trial for trial in trials if trial.errors.worst <= target_error]
    best = min(met, key=lambda trial: trial.cost) if met else min(trials, key=lambda trial: trial.errors.worst)
    return MotionCalibration(
        name=name or scene.title,
        scene=scene,
        capacity={member: scene.capacity(member) for member in scene.members},
        reference=reference,
        trials=tuple(sorted(trials, key=lambda trial: trial.cost)),
        failures=tuple(failures),
        best=best,
        frequency=(frequency, model_frequency(scene, best.model)),
        target_error=target_error,
    )


def _reference(scene: Scene, target_error: float, watch: Callable[[float], None]) -> MotionResult:
    """The reference, asked again for a smaller error until its peak and rest are known well enough."""
    tolerance = target_error
    result = motion(scene, tolerance, watch=watch)
    for _ in range(_MOST_REFINEMENTS):
        if _uncertainty(result) <= target_error / REFERENCE_MARGIN or result.error_estimate > tolerance:
            break
        tolerance = 0.5 * min(tolerance, result.error_estimate)
        result = motion(scene, tolerance, watch=watch)
    return result


def _uncertainty(reference: MotionResult) -> float:
    return max(reference.peak_error, reference.residual_error) / abs(reference.peak)


def _compare(scene: Scene, reference: MotionResult, course: Course, frequency: float) -> MotionErrors:
    assert scene.motion is not None
    along = np.array(unit_vector(scene.motion.direction))
    size = abs(reference.peak)
    rest, wanted = (float(along @ at.residual[reference.node]) for at in (course, reference))
    near = np.abs(course.time - reference.peak_time) <= (0.25 / frequency if frequency > 0.0 else np.inf)
    swing = float(course.time[near][int(np.argmax(np.sign(reference.peak) * course.displacement[near]))])
    history = np.interp(reference.time, course.time, course.displacement) - reference.displacement
    work = float(reference.plastic[-1])
    return MotionErrors(
        peak=float(np.abs(course.displacement).max()) / size - 1.0,
        residual=(rest - wanted) / size,
        history=float(np.abs(history).max()) / size,
        peak_time=(swing - reference.peak_time) / float(scene.motion.duration),
        plastic_work=course.dissipated / work - 1.0 if work > 1e-6 * float(np.abs(reference.external).max()) else None,
    )
