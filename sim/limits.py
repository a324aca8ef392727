"""When a joint breaks."""

import math
from dataclasses import dataclass

from capacity import InputError
from sim.laws.checks import is_number


@dataclass(frozen=True)
class Limits:
    """Plastic deformation, summed without sign, at which a joint breaks.

    Attributes
    ----------
    elongation, slip : float
        [m].
    rotation : float
        [rad].
    compression_counts : bool
        Whether plastic shortening is summed with the elongation.

    Raises
    ------
    InputError
        When one is negative or no number.
    """

    elongation: float = math.inf
    slip: float = math.inf
    rotation: float = math.inf
    compression_counts: bool = False

    def __post_init__(self) -> None:
        for name in ("elongation", "slip", "rotation"):
            if not (is_number(getattr(self, name)) and getattr(self, name) >= 0.0):
                fault = f"{getattr(self, name)} is negative or no number"
                raise InputError(f"limits.{name}", fault, "write a plastic deformation, or leave it out for no limit")


#: Limits of a joint that does not break.
NO_LIMITS = Limits()
