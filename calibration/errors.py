"""How far a model's load–displacement curve lies from the reference."""

from dataclasses import dataclass

import numpy as np

from fem_reference import Pushover
from sim import Push


@dataclass(frozen=True)
class Errors:
    """Errors of a model's curve, as shares of the reference's value [-].

    Attributes
    ----------
    path_max : float
        Largest |F_model - F_reference| over the path, over the largest |F_reference|.
    stiffness : float
        Initial stiffness, signed.
    collapse_load : float
        Largest load, signed.
    """

    path_max: float
    stiffness: float
    collapse_load: float


def compare(reference: Pushover, push: Push) -> Errors:
    """Errors of ``push`` at the points of ``reference``, whose displacements were the pusher's distances."""
    points = np.arange(len(reference.load))
    load = push.load_at_distances
    largest = float(np.abs(reference.load).max())
    early = points < np.argmax(np.abs(reference.load) > 0.3 * largest)
    return Errors(
        path_max=float(np.abs(load - reference.load).max()) / largest,
        stiffness=_slope(reference.displacement[early], load[early])
        / _slope(reference.displacement[early], reference.load[early])
        - 1.0,
        collapse_load=float(load.max()) / float(reference.load.max()) - 1.0,
    )


def _slope(x: np.ndarray, y: np.ndarray) -> float:
    """Least-squares slope of a line through the origin."""
    return float(x @ y) / float(x @ x)
