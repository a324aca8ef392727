"""Tuning the joints: the cheapest rigid-body model that follows the reference closely enough."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import msgspec

from calibration.comparable_push import push_model
from calibration.errors import Findings, compare, find
from calibration.fitting import Fit, LoadCase, checked, fit
from calibration.frequencies import model_frequency, reference_frequency
from calibration.limits import branch_remarks, shear_remarks, what_limits
from calibration.member_plans import MemberPlan, member_plans
from calibration.parameters import BOUNDS, DEEP_BEAM, fitted
from calibration.planner import candidates, candidates_to_fit, relative_cost
from calibration.saving import give_less
from calibration.trials import Failure, Trial
from capacity import Capacity, InputError
from fem_reference import (
    NotConverged,
    PlanePush,
    PushAnswer,
    Pushover,
    branches_at,
    default_tolerance,
    push_over,
    remarks,
    wants_plane_stress,
)
from scene import Scene
from scene.quantities import Length
from sim import Model, Pace, SolverError

#: The reference must be this many times better than the target, …
REFERENCE_MARGIN = 5.0
#: … and no worse than this, for its curve is quoted for itself.
REFERENCE_TOLERANCE = 5e-4
#: Points of a path below which there is nothing to compare.
_FEWEST_POINTS = 10
#: Share of the target error that inertia may take up in a push.
_INERTIA_SHARE = 1.0 / 6.0


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
    reference : PushAnswer
    plans : dict[str, MemberPlan]
        What each member needs.
    trials : tuple of Trial
        From cheap to dear.
    failures : tuple of Failure
        Models that were tried and broke down.
    best : Trial
        The cheapest that met the target, or else the one with the least error.
    findings : Findings
        Of the best.
    fit : Fit or None
        Parameters fitted to a continuum, checked on a load case that the fit did not see; None where beam theory holds.
    target_error : float
        Largest `Errors.path_max` wanted [-].
    branches_at : float or None
        Displacement at which a second path branches off, where the comparison ends [m].
    """

    name: str
    scene: Scene
    capacity: dict[str, Capacity]
    reference: PushAnswer
    plans: dict[str, MemberPlan]
    trials: tuple[Trial, ...]
    failures: tuple[Failure, ...]
    best: Trial
    findings: Findings
    fit: Fit | None
    target_error: float
    branches_at: float | None = None

    @property
    def target_met(self) -> bool:
        """Whether the best model's error is within the target and the reference is good enough to say so."""
        return self.best.error <= self.target_error and self.reference_good_enough

    @property
    def reference_good_enough(self) -> bool:
        """Whether the reference's own estimated error is below a fifth of the target."""
        return self.reference.error_estimate <= self.target_error / REFERENCE_MARGIN

    @property
    def limit(self) -> str:
        """What keeps the error from falling below the target, in words; empty when it is met."""
        if self.target_met:
            return ""
        if not self.reference_good_enough:
            return (
                f"the reference itself is only known within {100.0 * self.reference.error_estimate:.2g} %, "
                f"and must be {REFERENCE_MARGIN:.0f} times better than the target"
            )
        return what_limits(self.best, self.trials, self.failures)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What to mind about beam theory, kinematics, stability and shear; empty when there is nothing."""
        of_beams = shear_remarks(self.scene, self.best.push) if isinstance(self.reference, Pushover) else ()
        return (*remarks(self.scene), *branch_remarks(self.branches_at), *of_beams)

    @property
    def fitted_scene(self) -> Scene:
        """The scene with what was fitted in place: what joints are made from."""
        return self.scene if self.fit is None else fitted(self.scene, self.best.model, self.fit.parameters)[0]

    def why(self, member: str) -> str:
        """Why the best model has what it has in a member, in words."""
        return self.plans[member].reason(self.best.model.of(member))


def calibrate(
    scene: Scene,
    target_error: float = 0.01,
    name: str = "",
    watch: Callable[[str, float], None] = lambda what, share: None,
) -> Calibration:
    """Find the cheapest model of ``scene`` whose path error is at most ``target_error``.

    Models are tried from cheap to dear until one meets the target; then each member that yields is tried with less.

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
    InputError
        When the scene has no push, or is a mesh.
    fem_reference.NotConverged, sim.SolverError
        When the reference, or every model, finds no equilibrium.
    """
    if not 0.0 < target_error < 1.0:
        raise ValueError(f"a target error of {target_error:g} is not between 0 and 1")
    if scene.meshed is not None:
        raise InputError(
            "plane.mesh", "joints stand for lengths of members, which a mesh has none of", "describe members"
        )
    tolerance = min(target_error / REFERENCE_MARGIN, default_tolerance(scene))
    branches = None if wants_plane_stress(scene) else branches_at(scene)
    followed = scene if branches is None else _pushed_to(scene, branches)
    reference = push_over(followed, tolerance, lambda share: watch("reference", share))
    if len(reference.load) < _FEWEST_POINTS:
        raise NotConverged(f"the reference ends before there is anything to compare: {reference.outcome}")
    if not reference.load.any():
        fault = f'the loads do not move node "{scene.push.node}" that way'
        raise InputError("push.direction", fault, "push it in the direction in which they do")
    plans = member_plans(scene, reference, target_error)
    bench = Bench(scene, reference, target_error)
    models = candidates_to_fit(scene) if bench.fits else candidates(scene, plans)
    for i, model in enumerate(models):
        watch(f"model {i + 1}: {model.rule} {model.joints}, {model.law}", i / len(models))
        trial = bench.try_out(model)
        if trial is not None and trial.error <= target_error:
            give_less(scene, trial, plans, target_error, bench.try_out, watch)
            break
    watch("models", 1.0)
    trials, failures = bench.trials, bench.failures
    if not trials:
        raise SolverError(f"none of {len(failures)} models could be stepped; the last said: {failures[-1].reason}")
    met = [trial for trial in trials if trial.error <= target_error]
    best = min(met, key=lambda trial: trial.cost) if met else min(trials, key=lambda trial: trial.error)
    frequency = (0.0 if bench.fits else reference_frequency(scene), model_frequency(scene, best.model))
    if bench.fits:
        watch("reference of a load case that the fit did not see", 0.0)
        assert best.fit is not None
        trials[trials.index(best)] = best = replace(best, fit=checked(best.fit, [LoadCase.unseen(scene)]))
    return Calibration(
        name=name or scene.title,
        scene=scene,
        capacity={member: scene.capacity(member) for member in scene.members},
        reference=reference,
        plans=plans,
        trials=tuple(sorted(trials, key=lambda trial: trial.cost)),
        failures=tuple(failures),
        best=best,
        findings=find(scene, reference, best.push, frequency),
        fit=best.fit,
        target_error=target_error,
        branches_at=branches,
    )


def _pushed_to(scene: Scene, distance: float) -> Scene:
    if distance == 0.0:
        raise NotConverged(
            "the structure is not stable under its own weight and dead loads; support it, or make it stiffer"
        )
    return msgspec.structs.replace(scene, pushed=msgspec.structs.replace(scene.push, distance=Length(distance)))


class Bench:
    """Where models of a scene are tried against its reference.

    Attributes
    ----------
    trials : list of Trial
    failures : list of Failure
    """

    def __init__(self, scene: Scene, reference: PushAnswer, target_error: float) -> None:
        self.scene, self.reference = scene, reference
        self._pace = Pace(most_inertia=_INERTIA_SHARE * target_error)
        self.trials: list[Trial] = []
        self.failures: list[Failure] = []
        self._known: dict[tuple[object, ...], Trial | None] = {}
        # The first model in a process also pays for loading the kernels; that is no part of its cost.
        push_model(scene, Model("lobatto", 2, "elastic-plastic"), reference.displacement[:2])

    @property
    def fits(self) -> bool:
        """Whether a model's parameters are fitted: to a continuum, which beam theory does not describe."""
        return isinstance(self.reference, PlanePush)

    def fit(self, model: Model) -> Fit:
        """Parameters of ``model`` fitted to the reference, beginning with those of the model before."""
        last = self.trials[-1].fit if self.trials else None
        start = {} if last is None else last.parameters
        if last is not None and (last.at_bound or last.undetermined):
            start = {}  # nothing to go on from
        bounds = {name: (start.get(name, first), low, high) for name, (first, low, high) in BOUNDS.items()}
        return fit([LoadCase.of_push("push", self.scene, self.reference)], model, DEEP_BEAM, bounds=bounds)

    def try_out(self, model: Model) -> Trial | None:
        """Push ``model`` as the reference was pushed; None when it breaks down. What was tried is not tried again."""
        key = (model.dt, model.iterations, *(model.of(name) for name in self.scene.members))
        if key not in self._known:
            self._known[key] = self._push(model)
        return self._known[key]

    def _push(self, model: Model) -> Trial | None:
        try:
            found = self.fit(model) if self.fits else None
            scene = self.scene if found is None else fitted(self.scene, model, found.parameters)[0]
            push = push_model(scene, model, self.reference.displacement, self._pace)
        except SolverError as error:
            self.failures.append(Failure(model, str(error)))
            return None
        self._pace = replace(self._pace, duration=push.duration)
        cost = relative_cost(model, self.scene.members, push.newton_steps)
        trial = Trial(model, push, compare(self.reference, push), cost, found)
        self.trials.append(trial)
        return trial
