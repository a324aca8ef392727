"""The points of a study: models of one scene, and hard cases for each kind of joint."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from fractions import Fraction
from typing import Any, Literal

from calibration.planner import relative_cost
from sim import LAWS, RULES, Model

#: Ductile joints, or pymunk's own: pivots with gears (rigid until they yield) or with damped rotary springs.
Kind = Literal["ductile", "gear", "spring"]
KINDS: tuple[Kind, ...] = ("ductile", "gear", "spring")
#: Law that stock joints can follow.
STOCK_LAW = "elastic-plastic"
#: Joints that a rule has at least, where it is more than 2.
_FEWEST = {"radau": 6, "graded": 6}


@dataclass(frozen=True)
class Choices:
    """What a study sweeps.

    Attributes
    ----------
    rules, laws : tuple of str
    joints : tuple of int
        Points of the rule in a member.
    fibres : tuple of int
        Fibres a section, where the law has any.
    dt : tuple of float
        [s]
    iterations : tuple of int
    stock : tuple of str
        Stock joints to compare with: ``"gear"``, ``"spring"``; with fewer joints and more iterations, which they need.
    """

    rules: tuple[str, ...] = RULES
    joints: tuple[int, ...] = (2, 3, 4, 5, 7, 10, 20)
    laws: tuple[str, ...] = LAWS
    fibres: tuple[int, ...] = (8, 16)
    dt: tuple[float, ...] = (1 / 60, 1 / 240)
    iterations: tuple[int, ...] = (2, 10)
    stock: tuple[str, ...] = ("gear", "spring")
    stock_joints: tuple[int, ...] = (2, 3, 5)
    stock_iterations: tuple[int, ...] = (10, 50)


@dataclass(frozen=True)
class ModelPoint:
    """A model of the scene to be pushed over."""

    kind: Kind
    model: Model

    @property
    def name(self) -> str:
        """What it is called in figures and tables."""
        m = self.model
        law = f"fibre {m.fibres}" if m.law == "fibre" else m.law
        what = law if self.kind == "ductile" else f"stock {self.kind}"
        return f"{m.rule} {m.joints}, {what}, {step_name(m.dt)}, {m.iterations} it"

    @property
    def cost(self) -> float:
        """How long it takes, in no particular unit."""
        return relative_cost(self.model) + 1.0 / self.model.dt

    def plain(self) -> dict[str, Any]:
        """As a dict for JSON; `Model`'s ``joints`` as points of the rule."""
        values = asdict(self.model)
        values["points"] = values.pop("joints")
        return {"kind": self.kind, **values, "name": self.name}


@dataclass(frozen=True)
class HardPoint:
    """A cantilever chain with a body at its tip, which is let down into its static sag.

    Attributes
    ----------
    kind : str
    dt : float
        [s]
    mass_ratio : float
        Mass of the body at the tip over that of a piece.
    stiffness_factor : float
        Stiffness over that of the scene's own member.
    iterations : int
    """

    kind: Kind
    dt: float
    mass_ratio: float = 1.0
    stiffness_factor: float = 1.0
    iterations: int = 10

    @property
    def name(self) -> str:
        """What it is called in tables."""
        kind = self.kind if self.kind == "ductile" else f"stock {self.kind}"
        return (
            f"hard case, {kind}, {step_name(self.dt)}, mass x{self.mass_ratio:g}, stiffness x{self.stiffness_factor:g}"
        )

    @property
    def cost(self) -> float:
        """How long it takes, in the unit of `ModelPoint.cost`."""
        return 0.3 / self.dt

    def plain(self) -> dict[str, Any]:
        """As a dict for JSON."""
        return {**{field.name: getattr(self, field.name) for field in fields(self)}, "name": self.name}


Point = ModelPoint | HardPoint
MASS_RATIOS = (1e-5, 1e-3, 1e-1, 1.0, 1e1, 1e3, 1e5)
STIFFNESS_FACTORS = (1e-3, 1e-2, 1e-1, 1.0, 1e2, 1e4, 1e6)
HARD_STEPS = (1 / 30, 1 / 60, 1 / 120, 1 / 240, 1 / 1000)


def model_points(choices: Choices) -> list[ModelPoint]:
    """Every combination of the choices that says something new."""
    points = []
    for rule, dt in itertools.product(choices.rules, choices.dt):
        least = _FEWEST.get(rule, 2)
        joints = [number for number in choices.joints if number >= least]
        points += [
            ModelPoint("ductile", Model(rule, number, law, fibres, dt, iterations))
            for number, law, iterations in itertools.product(joints, choices.laws, choices.iterations)
            for fibres in (choices.fibres if law == "fibre" else (Model.fibres,))
        ]
        joints = [number for number in choices.stock_joints if number >= least]
        points += [
            ModelPoint(_kind(stock), Model(rule, number, STOCK_LAW, dt=dt, iterations=iterations))
            for stock, number, iterations in itertools.product(choices.stock, joints, choices.stock_iterations)
        ]
    return list(dict.fromkeys(points))


def hard_points() -> list[HardPoint]:
    """The cells of the two maps: step against mass ratio, and step against stiffness."""
    cells = [HardPoint(kind, dt, mass_ratio=ratio) for kind in KINDS for dt in HARD_STEPS for ratio in MASS_RATIOS]
    cells += [
        HardPoint(kind, dt, stiffness_factor=factor)
        for kind in KINDS
        for dt in HARD_STEPS
        for factor in STIFFNESS_FACTORS
    ]
    return list(dict.fromkeys(cells))


def step_name(dt: float) -> str:
    """A step as a fraction of a second."""
    share = Fraction(dt).limit_denominator(1_000_000)
    return f"1/{share.denominator} s" if share.numerator == 1 else f"{dt:g} s"


def _kind(name: str) -> Kind:
    return next(kind for kind in KINDS if kind == name)


def total_cost(points: Sequence[Point]) -> float:
    """How long ``points`` take together, in the unit of their cost."""
    return sum(point.cost for point in points)
