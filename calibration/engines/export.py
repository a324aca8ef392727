"""Handing a scene over to an engine: the file, and at its head what it cannot do and by how much it errs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.metadata import version

from calibration.comparable_motion import follow_model
from calibration.comparable_push import push_model
from calibration.engines.catalogue import ENGINES, Engine, NoTree
from calibration.engines.handover import LAW, Handover, hand_over
from calibration.engines.pushing import CurveErrors, Unstable, curve_errors
from calibration.engines.text import comment
from calibration.engines.to_pymunk import module_text, push_module
from calibration.errors import compare
from calibration.frequencies import reference_frequency
from calibration.motion_errors import compare_motion, watching
from calibration.planner import MOTION_SCHEME
from calibration.tuning import REFERENCE_TOLERANCE
from fem_reference import PushAnswer, motion, push_over
from scene import Scene
from sim import Model, SolverError

#: Points of the rule in a member that are tried where the engine can be run, …
TRIED = (2, 3, 5)
#: … and what is taken where it cannot: enough for hinges at both ends and the middle.
_UNTRIED = 3

#: An error this many times the least is about the same.
_ABOUT = 1.1


@dataclass(frozen=True)
class Attempt:
    """One way to hand over: which writer, which model, and what came of it; no errors when it ran away."""

    writer: str
    model: Model
    errors: CurveErrors | None

    @property
    def path(self) -> float:
        """Path error; infinite when it ran away."""
        return float("inf") if self.errors is None else self.errors.path_max


@dataclass(frozen=True)
class Export:
    """What is handed over.

    Attributes
    ----------
    engine : str
    text : str
        The file.
    handover : Handover
    model_errors : CurveErrors, optional
        Of the same joints solved as one structure; None when the scene has no push.
    measured : CurveErrors, optional
        In the engine; None when it was not run.
    attempts : tuple of Attempt
    notes : tuple of str
        What stands at the file's head.
    """

    engine: str
    text: str
    handover: Handover
    model_errors: CurveErrors | None
    measured: CurveErrors | None
    attempts: tuple[Attempt, ...]
    notes: tuple[str, ...]


def export(scene: Scene, name: str, engine: str, model: Model, joints: int | None, damping_ratio: float) -> Export:
    """Write ``scene`` for ``engine``, and run it there if it is installed.

    Parameters
    ----------
    scene : Scene
    name : str
        What to call it.
    engine : str
        A key of `ENGINES`.
    model : Model
        Rule, step and iterations; its joints are replaced.
    joints : int, optional
        Points of the rule in each member; by default the best of `TRIED`.
    damping_ratio : float
        Of each joint's rotation [-].
    """
    target = ENGINES[engine]
    reference = None if scene.pushed is None else push_over(scene, REFERENCE_TOLERANCE)
    numbers = (joints,) if joints is not None else TRIED if target.installed and reference is not None else (_UNTRIED,)
    models = [replace(model, law=LAW, joints=number) for number in numbers]
    attempts: list[Attempt] = []
    if reference is not None and target.installed:
        attempts = _attempts(scene, target, models, reference, damping_ratio)
    best = _cheapest_of_the_best(attempts) or Attempt(next(iter(target.writers)), models[0], None)
    handover = hand_over(scene, best.model, name, damping_ratio)
    model_errors = None if reference is None else _solved_as_one(scene, best.model, reference)
    notes = (
        f"{name}: {len(handover.bodies)} rigid bodies, {len(handover.joints)} joints, elastic-perfectly plastic; "
        f"{best.model.rule} rule with {best.model.joints} points a member. For {target.title}. "
        f"Step {best.model.dt:.6g} s, {best.model.iterations} iterations. ductile-joints {version('ductile-joints')}.",
        f"Cannot be expressed: {target.cannot.strip()}",
        *_left_out(scene, handover, engine),
        *_expected(scene, target, best, attempts, handover, reference, model_errors),
    )
    text = target.writers[best.writer](handover, comment(notes, target.comment))
    return Export(engine, text, handover, model_errors, best.errors, tuple(attempts), notes)


def _cheapest_of_the_best(attempts: list[Attempt]) -> Attempt | None:
    """The first, which has the fewest bodies, that is about as close as the closest."""
    least = min((attempt.path for attempt in attempts), default=0.0)
    return next((attempt for attempt in attempts if attempt.path <= _ABOUT * least), None)


def _attempts(
    scene: Scene, target: Engine, models: list[Model], reference: PushAnswer, damping_ratio: float
) -> list[Attempt]:
    assert target.run is not None
    attempts = []
    for model in models:
        handover = hand_over(scene, model, "scene", damping_ratio)
        assert handover.push is not None  # or there were no reference
        for name, write in target.writers.items():
            try:
                pushed = target.run(write(handover, ""), handover, handover.push, reference.displacement)
            except Unstable:
                attempts.append(Attempt(name, model, None))
            except NoTree:
                return []
            else:
                attempts.append(Attempt(name, model, curve_errors(reference, pushed)))
    return attempts


def _solved_as_one(scene: Scene, model: Model, reference: PushAnswer) -> CurveErrors:
    """Errors of the same joints in this project's own solver."""
    errors = compare(reference, push_model(scene, replace(model, iterations=2), reference.displacement))
    return CurveErrors(errors.path_max, errors.collapse_load)


def _said(errors: CurveErrors) -> str:
    return f"path {100 * errors.path_max:.3g} % of the peak load, largest load {100 * errors.collapse_load:+.2f} %"


def _expected_of_motion(scene: Scene, model: Model) -> str:
    """What a scene without a push can say: how the same joints, solved as one, move beside the reference."""
    if scene.motion is None:
        return "Error to expect: not measured, for the scene has neither a push nor a motion."
    reference = motion(scene, of="peak")
    as_one = replace(model, iterations=2, scheme=MOTION_SCHEME)
    head = (
        f"Error to expect, against the reference ({reference.method}, peak within "
        f"{100 * reference.peak_error / abs(reference.peak):.2g} %): the joints themselves, solved as one,"
    )
    try:
        course = follow_model(watching(scene, reference.node), as_one)
    except SolverError as error:
        return f"{head} cannot be stepped: {error}."
    errors = compare_motion(scene, reference, course, reference_frequency(scene))
    return (
        f"{head} peak {100 * errors.peak:+.3g} %, at rest {100 * errors.residual:+.3g} % of the peak. "
        "Engines are run with pushes only."
    )


def _expected(
    scene: Scene,
    target: Engine,
    best: Attempt,
    attempts: list[Attempt],
    handover: Handover,
    reference: PushAnswer | None,
    model_errors: CurveErrors | None,
) -> list[str]:
    if reference is None or model_errors is None:
        return [_expected_of_motion(scene, best.model)]
    lines = [
        f"Error to expect, against the reference ({reference.method}, within {100 * reference.error_estimate:.2g} %): "
        f"the joints themselves, solved as one, {_said(model_errors)}."
    ]
    where = (
        f"{target.run_as or 'the engine'} ({target.needs} {version(_DISTRIBUTIONS[target.needs])})"
        if target.installed
        else ""
    )
    if best.errors is not None:
        tried = "; ".join(f"{_label(a)} {100 * a.path:.3g} %" for a in attempts)
        lines.append(f"Measured in {where}: {_said(best.errors)}. Tried, path errors: {tried}.")
    elif attempts:
        lines.append(f"Measured in {where}: everything that was tried ran away. Take a shorter step.")
    elif target.installed:
        lines.append(f"Not measured: {target.run_as} cannot hold loops, slides or loose parts.")
    elif target.run is not None:
        lines.append(f"Not measured: {target.needs} is not installed here.")
    elif target.suffix != ".json":
        assert handover.push is not None  # or there were no reference
        gears = module_text(handover, "gear", "")
        stock = curve_errors(reference, push_module(gears, handover, handover.push, reference.displacement))
        lines.append(
            "Not measured in the engine itself. The same joints as gears of stock pymunk, one by one "
            f"too: {_said(stock)}."
        )
    return lines


def _label(attempt: Attempt) -> str:
    return f"{attempt.writer} {attempt.model.joints}".strip()


def _left_out(scene: Scene, handover: Handover, engine: str) -> list[str]:
    """What is left out of this scene's supports and actions."""
    lines = []
    sliding = [joint.name for joint in handover.joints if joint.slide is not None]
    if sliding and engine not in ("pymunk", "mujoco", "json"):
        lines.append(f"Pinned here though they slide: {', '.join(sliding)}.")
    springs = [name for name, node in scene.nodes.items() if node.spring is not None]
    if springs and engine != "json":
        lines.append(f"Rigid in translation here though elastic: {', '.join(springs)}.")
    settled = [name for name, node in scene.nodes.items() if node.settlement != (0.0, 0.0)]
    if settled:
        lines.append(f"Settlements are left out: {', '.join(settled)}.")
    if scene.loads or scene.motion is not None:
        lines.append("Loads and velocities are left out.")
    return lines


#: Distributions that the modules come from.
_DISTRIBUTIONS = {"pymunk": "pymunk", "Box2D": "box2d", "pybullet": "pybullet", "mujoco": "mujoco"}
