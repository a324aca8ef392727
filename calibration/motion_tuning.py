"""Tuning the joints to a motion: the cheapest rigid-body model whose peak, and what remains, are the reference's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from calibration.comparable_motion import follow_model
from calibration.errors import Findings
from calibration.frequencies import model_frequency, reference_frequency
from calibration.hinges import in_order, motion_hinges
from calibration.limits import shear_remarks, what_limits
from calibration.member_plans import MemberPlan, motion_plans
from calibration.motion_errors import MotionErrors, compare_motion, watching
from calibration.motion_search import cheapest_step
from calibration.planner import MOTION_RATES, motion_cuts, relative_cost
from calibration.saving import give_less
from calibration.trials import Failure
from capacity import Capacity, InputError
from fem_reference import MotionResult, motion, remarks
from scene import Scene
from sim import Course, Model, SolverError

#: The reference's peak and what remains must be known this many times better than the target.
REFERENCE_MARGIN = 3.0


@dataclass(frozen=True)
class MotionTrial:
    """A model that was tried; ``cost`` is its `calibration.planner.relative_cost`."""

    model: Model
    course: Course
    errors: MotionErrors
    cost: float

    @property
    def error(self) -> float:
        """What a target holds for."""
        return self.errors.worst


@dataclass(frozen=True)
class MotionCalibration:
    """A scene calibrated by its motion; attributes as those of `calibration.tuning.Calibration`."""

    name: str
    scene: Scene
    capacity: dict[str, Capacity]
    reference: MotionResult
    plans: dict[str, MemberPlan]
    trials: tuple[MotionTrial, ...]
    failures: tuple[Failure, ...]
    best: MotionTrial
    findings: Findings
    target_error: float

    @property
    def uncertainty(self) -> float:
        """Estimated error of the reference's peak or of what remains, the larger, over the peak [-]."""
        reference = self.reference
        return max(reference.peak_error, reference.rest_error) / abs(reference.peak)

    @property
    def target_met(self) -> bool:
        """Whether peak and residual are within the target, and the reference is good enough to say so."""
        return self.best.error <= self.target_error and self.reference_good_enough

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
                f"with {self.reference.elements} elements a member and {self.reference.steps} steps, "
                f"and must be {REFERENCE_MARGIN:.0f} times better than the target"
            )
        return what_limits(self.best, self.trials, self.failures)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What to mind about beam theory, kinematics and shear; empty when there is nothing."""
        return (*remarks(self.scene, self.reference.peak), *shear_remarks(self.scene, self.best.course))

    def why(self, member: str) -> str:
        """Why the best model has what it has in a member, in words."""
        return self.plans[member].reason(self.best.model.of(member))


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
    margin = target_error / REFERENCE_MARGIN
    reference = motion(scene, margin, watch=lambda share: watch("reference", share), of="peak")
    plans = motion_plans(reference, target_error)
    bench = Bench(scene, reference)
    found = cheapest_step(motion_cuts(scene, plans), MOTION_RATES, scene.members, target_error, bench.try_out, watch)
    if found is not None:
        give_less(scene, found, plans, target_error, bench.try_out, watch)
    watch("models", 1.0)
    trials, failures = bench.trials, bench.failures
    if not trials:
        raise SolverError(f"none of {len(failures)} models could be stepped; the last said: {failures[-1].reason}")
    met = [trial for trial in trials if trial.error <= target_error]
    best = min(met, key=lambda trial: trial.cost) if met else min(trials, key=lambda trial: trial.error)
    hinges = motion_hinges(scene, reference.hinges, best.course)
    return MotionCalibration(
        name=name or scene.title,
        scene=scene,
        capacity={member: scene.capacity(member) for member in scene.members},
        reference=reference,
        plans=plans,
        trials=tuple(sorted(trials, key=lambda trial: trial.cost)),
        failures=tuple(failures),
        best=best,
        findings=Findings(
            hinges, in_order(hinges) if hinges else None, (bench.frequency, model_frequency(scene, best.model))
        ),
        target_error=target_error,
    )


class Bench:
    """Where models of a scene are tried against its reference.

    Attributes
    ----------
    frequency : float
        First natural frequency of the reference [Hz].
    trials : list of MotionTrial
    failures : list of Failure
    """

    def __init__(self, scene: Scene, reference: MotionResult) -> None:
        self._scene = watching(scene, reference.node)
        self._reference = reference
        self.frequency = reference_frequency(scene)
        self.trials: list[MotionTrial] = []
        self.failures: list[Failure] = []

    def try_out(self, model: Model) -> MotionTrial | None:
        """Have ``model`` move as the reference did; None when it breaks down."""
        try:
            course = follow_model(self._scene, model)
        except SolverError as error:
            self.failures.append(Failure(model, str(error)))
            return None
        cost = relative_cost(model, self._scene.members, course.newton_steps)
        errors = compare_motion(self._scene, self._reference, course, self.frequency)
        self.trials.append(MotionTrial(model, course, errors, cost))
        return self.trials[-1]
