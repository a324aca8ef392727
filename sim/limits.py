"""When a joint breaks."""

import math
from dataclasses import dataclass


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
    """

    elongation: float = math.inf
    slip: float = math.inf
    rotation: float = math.inf
    compression_counts: bool = False


#: Limits of a joint that does not break.
NO_LIMITS = Limits()
