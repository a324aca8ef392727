"""Fitting what is left after the choice of a model: least squares over load cases, inside bounds.

A deep beam is softer and stronger than beam theory says, and yields over a wider range of loads; a tested one has a
yield stress and a damping of its own. The parameters multiply or replace what the scene says of all its members:

    stiffness     of E (and so of EA, GA_s, EI)
    strength      of the yield stress
    spread        s: half of every fibre yields at (1 - s) fy, the other half at (1 + s) fy
    hardening     E_t / E beyond yield, in place of the material's
    hinge_length  of the rule "radau", as a multiple of the section's depth
    damping       viscous damping as a share of stiffness [s], as of `sim.Model`

Residuals are differences of load over the largest load, or of displacement over the peak for a motion, at the points of
the references. A parameter is named as not determined when the Jacobian, in units of the parameters' ranges, has a
singular value below `WEAK` of the largest whose direction is mostly that parameter's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import msgspec
import numpy as np
from scipy.optimize import least_squares

from calibration.comparable_motion import follow_model
from calibration.comparable_push import push_model
from capacity import InputError, Material, StressStrain
from fem_reference import PushAnswer, motion, push_over
from scene import Scene
from scene.quantities import Force, ForcePerLength, Length, Moment, Speed
from sim import IMPLICIT_EULER, Model

Name = Literal["stiffness", "strength", "spread", "hardening", "hinge_length", "damping"]
#: Start and bounds of each parameter.
BOUNDS: dict[Name, tuple[float, float, float]] = {
    "stiffness": (1.0, 0.5, 1.5),
    "strength": (1.0, 0.5, 2.0),
    "spread": (0.1, 0.0, 0.6),
    "hardening": (0.01, 0.0, 0.1),
    "hinge_length": (1.0, 0.25, 4.0),
    "damping": (1e-3, 0.0, 0.02),
}
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
    """

    name: str
    scene: Scene
    points: np.ndarray
    values: np.ndarray
    weight: float = 1.0

    @classmethod
    def of_push(cls, name: str, scene: Scene, reference: PushAnswer, weight: float = 1.0) -> LoadCase:
        """A push that its reference has followed."""
        return cls(name, scene, reference.displacement, reference.load, weight)

    @classmethod
    def solve(cls, name: str, scene: Scene, weight: float = 1.0) -> LoadCase:
        """``scene``, followed by the reference that it asks for: a push, cycles or a motion."""
        if scene.motion is None:
            return cls.of_push(name, scene, push_over(scene), weight)
        course = motion(scene)
        return cls(name, scene, course.time, course.displacement, weight)

    @classmethod
    def unseen(cls, scene: Scene) -> LoadCase:
        """What a fit to ``scene`` has not seen: pushed half as far and back, or set going half as hard."""
        struct = msgspec.structs.replace
        if scene.pushed is not None:
            half = 0.5 * max(map(abs, scene.push.stops()))
            push = struct(scene.push, distance=Length(0.0), turning_points=(Length(half), Length(-half)), unload=False)
            return cls.solve("half as far and back", struct(scene, pushed=push))
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
        return cls.solve("set going half as hard", halved)

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
        Parameters to fit; keys of `BOUNDS`.
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

    def largest(case: LoadCase, parameters: Mapping[Name, float]) -> float:
        return float(np.abs(case.residuals(model, parameters)).max())

    return Fit(
        model=model,
        parameters=values,
        bounds={name: bounds[name][1:] for name in names},
        at_bound=tuple(name for name, held in zip(names, close.tolist(), strict=True) if held),
        undetermined=_undetermined(found.jac, names),
        before={case.name: largest(case, {}) for case in cases},
        after={case.name: largest(case, values) for case in cases},
        checks={case.name: (largest(case, {}), largest(case, values)) for case in checks},
    )


def check_parameters(names: Sequence[Name], model: Model) -> None:
    """Raise InputError for a parameter that ``model`` does not have."""
    if "hinge_length" in names and model.rule != "radau":
        raise InputError("hinge_length", f'the rule "{model.rule}" has none', 'take the rule "radau"')


def fitted(scene: Scene, model: Model, parameters: Mapping[Name, float]) -> tuple[Scene, Model]:
    """``scene`` and ``model`` with ``parameters`` in place."""
    members = {
        name: msgspec.structs.replace(member, material=_fitted_material(member.material, parameters))
        for name, member in scene.members.items()
    }
    if "damping" in parameters:
        model = replace(model, damping=parameters["damping"])
    if "hinge_length" in parameters:
        depth = max(float(member.section.depth) for member in scene.members.values())
        model = replace(model, hinge_length=parameters["hinge_length"] * depth)
    return msgspec.structs.replace(scene, members=members), model


def _fitted_material(material: Material, parameters: Mapping[Name, float]) -> Material:
    E = material.youngs_modulus * parameters.get("stiffness", 1.0)
    fy = material.yield_stress * parameters.get("strength", 1.0)
    slope = material.tangent_modulus / material.youngs_modulus
    hardening = E * parameters.get("hardening", slope)
    spread = parameters.get("spread", 0.0)
    curve = material.curve
    if spread > 0.0:
        middle = 0.5 * (E + hardening)
        first = (1.0 - spread) * fy / E
        breaks = np.array([first, first + 2.0 * spread * fy / E])
        curve = StressStrain(breaks, np.array([E, middle, hardening]), material.ultimate_strain)
        fy *= 1.0 - spread
    elif curve is not None:
        scale = E / material.youngs_modulus
        curve = StressStrain(curve.breaks * (fy / material.yield_stress / scale), curve.slopes * scale)
    name = f"{material.name} fitted"
    return Material(name, E, fy, material.density, material.poissons_ratio, hardening, material.ultimate_strain, curve)


def _undetermined(jacobian: np.ndarray, names: Sequence[Name]) -> tuple[Name, ...]:
    _, sizes, directions = np.linalg.svd(jacobian, full_matrices=False)
    weak = [direction for size, direction in zip(sizes, directions, strict=True) if size < WEAK * sizes[0]]
    return tuple(name for i, name in enumerate(names) if any(abs(direction[i]) > 0.5 for direction in weak))
