"""Models that were tried."""

from __future__ import annotations

from dataclasses import dataclass

from calibration.errors import Errors
from sim import Model, Push


@dataclass(frozen=True)
class Trial:
    """A model that was tried, the curve it gave, how wrong that is, and its `calibration.planner.relative_cost`."""

    model: Model
    push: Push
    errors: Errors
    cost: float


@dataclass(frozen=True)
class Failure:
    """A model that could not take a step, and what the solver said."""

    model: Model
    reason: str
