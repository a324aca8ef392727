"""Models that were tried."""

from __future__ import annotations

from dataclasses import dataclass

from calibration.errors import Errors
from calibration.fitting import Fit
from sim import Model, Push


@dataclass(frozen=True)
class Trial:
    """A model that was tried.

    Attributes
    ----------
    model : Model
    push : Push
        The curve that it gave.
    errors : Errors
        How wrong that is.
    cost : float
        Its `calibration.planner.relative_cost`.
    fit : Fit or None
        What was fitted to the reference beforehand, where that is a continuum.
    """

    model: Model
    push: Push
    errors: Errors
    cost: float
    fit: Fit | None = None

    @property
    def error(self) -> float:
        """What a target holds for: the path error."""
        return self.errors.path_max


@dataclass(frozen=True)
class Failure:
    """A model that could not take a step, and what the solver said."""

    model: Model
    reason: str
