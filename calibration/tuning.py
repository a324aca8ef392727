"""Tuning the joints: the cheapest rigid-body model that follows the reference closely enough."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from calibration.errors import Errors, compare
from calibration.planner import candidates
from calibration.small_displacements import push_over_small
from capacity import Capacity
from fem_reference import Pushover, pushover
from scene import Scene
from sim import Model, Push, SolverError, push_over

#: The reference must be this many times better than the target, …
REFERENCE_MARGIN = 5.0
#: … and no worse than this, for its curve is quoted for itself.
REFERENCE_TOLERANCE = 5e-4


@dataclass(frozen=True)
class Trial:
    """A model that was tried, the curve it gave, and how wrong that is."""

    model: Model
    push: Push
    errors: Errors


@dataclass(frozen=True)
class Failure:
    """A model that could not take a step, and what the solver said."""

    model: Model
    reason: str


@dataclass(frozen=True)
class Calibration:
    """A calibrated scene.

    Attributes
    ----------
    name : str
        What the scene is called: a built-in name or a path.
    scene : Scene
    capacity : dict[str, Capacity]
        By member.
    reference : Pushover
    trials : tuple of Trial
        In the order in which they were tried, from cheap to dear.
    failures : tuple of Failure
        Models that were tried and broke down.
    best : Trial
        The first that met the target, or else the one with the least error.
    target_error : float
        Largest `Errors.path_max` wanted [-].
    """

    name: str
    scene: Scene
    capacity: dict[str, Capacity]
    reference: Pushover
    trials: tuple[Trial, ...]
    failures: tuple[Failure, ...]
    best: Trial
    target_error: float

    @property
    def target_met(self) -> bool:
        """Whether the best model's error is within the target and the reference is good enough to say so."""
        return self.best.errors.path_max <= self.target_error and self.reference_good_enough

    @property
    def reference_good_enough(self) -> bool:
        """Whether the reference's own estimated error is below a fifth of the target."""
        return self.reference.error_estimate <= self.target_error / REFERENCE_MARGIN


def calibrate(
    scene: Scene,
    target_error: float = 0.01,
    name: str = "",
    watch: Callable[[str, float], None] = lambda what, share: None,
) -> Calibration:
    """Find the cheapest model of ``scene`` whose path error is at most ``target_error``.

    Parameters
    ----------
    scene : Scene
    target_error : float
        Largest allowed |F_model - F_reference| / max |F_reference| over the path [-].
    name : str
        What to call the scene in reports; its title by default.
    watch : callable
        Told what is being done and the finished share of it, 0 to 1.

    Raises
    ------
    ValueError
        When ``target_error`` is not between 0 and 1.
    fem_reference.NotConverged, sim.SolverError
        When the reference, or every model, finds no equilibrium.
    """
    if not 0.0 < target_error < 1.0:
        raise ValueError(f"a target error of {target_error:g} is not between 0 and 1")
    tolerance = min(target_error / REFERENCE_MARGIN, REFERENCE_TOLERANCE)
    reference = pushover(scene, tolerance, lambda share: watch("reference", share))
    models = candidates()
    small = scene.kinematics == "small"
    push_by = push_over_small if small else push_over
    # The first model in a process also pays for loading the kernels; that is no part of its cost.
    push_by(scene, models[0], reference.displacement)
    trials: list[Trial] = []
    failures: list[Failure] = []
    for i, model in enumerate(models):
        watch(f"model {i + 1}: {model.rule} {model.joints}, {model.law}", i / len(models))
        try:
            push = push_by(scene, model, reference.displacement)
        except SolverError as error:
            failures.append(Failure(model, str(error)))
            continue
        trials.append(Trial(model, push, compare(reference, push)))
        if trials[-1].errors.path_max <= target_error:
            break
    watch("models", 1.0)
    if not trials:
        raise SolverError(f"none of {len(failures)} models could be stepped; the last said: {failures[-1].reason}")
    return Calibration(
        name=name or scene.title,
        scene=scene,
        capacity={member: scene.capacity(member) for member in scene.members},
        reference=reference,
        trials=tuple(trials),
        failures=tuple(failures),
        best=min(trials, key=lambda trial: (trial.errors.path_max > target_error, trial.errors.path_max)),
        target_error=target_error,
    )
