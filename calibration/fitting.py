"""Fitting what is left after the choice of a model: least squares over load cases, inside bounds.

A deep beam is softer and stronger than beam theory says, and yields over a wider range of loads; a tested one has a
yield stress and a damping of its own. `calibration.parameters` says what can be fitted, and what it stands for.

Residuals are differences of load over the largest load, or of displacement over the peak for a motion, at the points of
the references. A parameter is named as not determined when the Jacobian, in units of the parameters' ranges, has a
singular value below `WEAK` of the largest whose direction is mostly that parameter's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import msgspec
import numpy as np
from scipy.optimize import least_squares

from calibration.comparable_motion import follow_model
from calibration.comparable_push import push_model
from calibration.parameters import BOUNDS, Name, check_parameters, fitted
from fem_reference import PushAnswer, default_tolerance, motion, push_over
from scene import Scene
from scene.quantities import Force, ForcePerLength, Length, Moment, Speed
from sim import IMPLICIT_EULER, Model

#: Share of the largest singular value of the Jacobian below which a direction counts as not determined.
WEAK = 1e-3
#: Share of its range within which a parameter counts as at its bound.
_AT_BOUND = 1e-3
_DIFFERENCE = 1e-2
_MOST_EVALUATIONS = 30


@dataclass(frozen=True)
class LoadCase:
    """A scene and what its reference says: loads at displacements, or displacements in time.

    Attributes
    ----------
    name : str
    scene : Scene
    points : (k,) float
        Displacements of the pushed node [m], or times [s].
    values : (k,) float
        Loads [N], or displacements of the watched node [m].
    weight : float
        Of this case among others.
    uncertainty : float
        Estimated error of the values, over the largest of them [-].
    """

    name: str
    scene: Scene
    points: np.ndarray
    values: np.ndarray
    weight: float = 1.0
    uncertainty: float = 0.0

    @classmethod
    def of_push(cls, name: str, scene: Scene, reference: PushAnswer, weight: float = 1.0) -> LoadCase:
        """A push that its reference has followed."""
        return cls(name, scene, reference.displacement, reference.load, weight, reference.error_estimate)

    @classmethod
    def solve(cls, name: str, scene: Scene, weight: float = 1.0, tolerance: float | None = None) -> LoadCase:
        """``scene``, followed by the reference that it asks for: a push, cycles or a motion.

        ``tolerance`` is the uncertainty that is aimed at; that of `fem_reference.default_tolerance` when left out.
        """
        if scene.motion is None:
            return cls.of_push(name, scene, push_over(scene, tolerance), weight)
        course = motion(scene, default_tolerance(scene) if tolerance is None else tolerance)
        return cls(name, scene, course.time, course.displacement, weight, course.error_estimate)

    @classmethod
    def unseen(cls, scene: Scene, tolerance: float | None = None) -> LoadCase:
        """What a fit to ``scene`` has not seen: pushed half as far and back, or set going half as hard."""
        struct = msgspec.structs.replace
        if scene.pushed is not None:
            half = 0.5 * max(map(abs, scene.push.stops()))
            push = struct(scene.push, distance=Length(0.0), turning_points=(Length(half), Length(-half)), unload=False)
            return cls.solve("half as far and back", struct(scene, pushed=push), tolerance=tolerance)
        motion = scene.motion
        assert motion is not None
        halved = struct(
            scene,
            motion=struct(motion, velocity=_half(motion.velocity, Speed)),
            nodes={name: struct(node, velocity=_half(node.velocity, Speed)) for name, node in scene.nodes.items()},
            loads=tuple(
                struct(
                    load,
                    force=_half(load.force, Force),
                    moment=Moment(0.5 * load.moment),
                    per_length=_half(load.per_length, ForcePerLength),
                )
                if load.kind == "step"
                else load
                for load in scene.loads
            ),
        )
        return cls.solve("set going half as hard", halved, tolerance=tolerance)

    def residuals(self, model: Model, parameters: Mapping[Name, float]) -> np.ndarray:
        """Model less reference over the largest value of the reference, (k,) [-]."""
        scene, model = fitted(self.scene, model, parameters)
        if scene.motion is None:
            # A push asks for states of rest, whatever scheme is meant for motions.
            push = push_model(scene, replace(model, scheme=IMPLICIT_EULER), self.points)
            found = push.load_at_distances
        else:
            course = follow_model(scene, model)
            found = np.interp(self.points, course.time, course.displacement)
        return np.asarray((found - self.values) / np.abs(self.values).max())


def _half(pair: tuple[float, float], kind: Callable[[float], Any]) -> tuple[Any, Any]:
    return kind(0.5 * pair[0]), kind(0.5 * pair[1])


@dataclass(frozen=True)
class Fit:
    """Fitted parameters.

    Attributes
    ----------
    model : Model
        What they were fitted for.
    parameters : dict[str, float]
    bounds : dict[str, (float, float)]
    at_bound : tuple of str
        Parameters that a bound holds.
    undetermined : tuple of str
        Parameters that the data do not determine.
    before, after : dict[str, float]
        Largest residual of each load case without and with the fit [-].
    checks : dict[str, (float, float)]
        The same of load cases that the fit did not see.
    """

    model: Model
    parameters: dict[Name, float]
    bounds: dict[Name, tuple[float, float]]
    at_bound: tuple[Name, ...]
    undetermined: tuple[Name, ...]
    before: dict[str, float]
    after: dict[str, float]
    checks: dict[str, tuple[float, float]]

    @property
    def worst(self) -> float:
        """Largest residual of all load cases that were fitted [-]."""
        return max(self.after.values())


def fit(
    cases: Sequence[LoadCase],
    model: Model,
    names: Sequence[Name] = ("stiffness", "strength", "spread"),
    checks: Sequence[LoadCase] = (),
    bounds: Mapping[Name, tuple[float, float, float]] = BOUNDS,
) -> Fit:
    """Fit parameters of ``model`` to all ``cases`` at once.

    Parameters
    ----------
    cases : sequence of LoadCase
        Static, cyclic and dynamic together.
    model : Model
    names : sequence of str
        Parameters to fit; keys of `calibration.parameters.BOUNDS`.
    checks : sequence of LoadCase
        Not seen by the fit.
    bounds : mapping
        Start, lower and upper bound by parameter.

    Raises
    ------
    ValueError
        When there is nothing to fit or to fit to.
    InputError
        When a hinge length is asked for with another rule than "radau".
    SolverError
        When a step cannot be taken.
    """
    if not cases or not names:
        raise ValueError("a fit needs a load case and a parameter")
    check_parameters(names, model)
    start, low, high = (np.array([bounds[name][i] for name in names]) for i in range(3))
    span = high - low
    weights = np.concatenate([np.full(len(case.points), (case.weight / len(case.points)) ** 0.5) for case in cases])

    def residuals(x: np.ndarray) -> np.ndarray:
        values = dict(zip(names, (low + span * x).tolist(), strict=True))
        return np.asarray(weights * np.concatenate([case.residuals(model, values) for case in cases]))

    found = least_squares(
        residuals,
        (start - low) / span,
        bounds=(0.0, 1.0),
        diff_step=_DIFFERENCE,
        max_nfev=_MOST_EVALUATIONS,
    )
    values: dict[Name, float] = dict(zip(names, (low + span * found.x).tolist(), strict=True))
    close = np.minimum(found.x, 1.0 - found.x) <= _AT_BOUND

    return checked(
        Fit(
            model=model,
            parameters=values,
            bounds={name: bounds[name][1:] for name in names},
            at_bound=tuple(name for name, held in zip(names, close.tolist(), strict=True) if held),
            undetermined=_undetermined(found.jac, names),
            before={case.name: _largest(case, model, {}) for case in cases},
            after={case.name: _largest(case, model, values) for case in cases},
            checks={},
        ),
        checks,
    )


def checked(found: Fit, cases: Sequence[LoadCase]) -> Fit:
    """``found``, checked on load ``cases`` that it was not made from."""
    model = found.model
    errors = {case.name: (_largest(case, model, {}), _largest(case, model, found.parameters)) for case in cases}
    return replace(found, checks={**found.checks, **errors})


def _largest(case: LoadCase, model: Model, parameters: Mapping[Name, float]) -> float:
    return float(np.abs(case.residuals(model, parameters)).max())


def _undetermined(jacobian: np.ndarray, names: Sequence[Name]) -> tuple[Name, ...]:
    _, sizes, directions = np.linalg.svd(jacobian, full_matrices=False)
    weak = [direction for size, direction in zip(sizes, directions, strict=True) if size < WEAK * sizes[0]]
    return tuple(name for i, name in enumerate(names) if any(abs(direction[i]) > 0.5 for direction in weak))
