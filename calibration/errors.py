"""How far a model lies from the reference, by kind."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from calibration.hinges import HingePair, in_order, push_hinges
from fem_reference import PushAnswer
from scene import Scene
from sim import Push

#: The load at which a curve's slope from the origin has fallen by this share counts as first yield.
_BENT = 0.02


@dataclass(frozen=True)
class Errors:
    """Errors of a model's curve, as shares of the reference's value [-]; None where the scene has no such thing.

    Attributes
    ----------
    path_max : float
        Largest |F_model - F_reference| over the path, over the largest |F_reference|.
    stiffness : float
        Initial stiffness, signed.
    first_yield : float or None
        Load at which the slope from the origin to the curve has fallen by 2 %, signed.
    collapse_load : float
        Largest load, signed.
    residual : float or None
        Displacement left after unloading, signed, over the largest displacement.
    loop_energy : float or None
        Work of the load around the loops of a path that turns, ∮ F du, signed.
    """

    path_max: float
    stiffness: float
    first_yield: float | None
    collapse_load: float
    residual: float | None
    loop_energy: float | None


def compare(reference: PushAnswer, push: Push) -> Errors:
    """Errors of ``push`` at the points of ``reference``, whose displacements were its distances."""
    load = push.load_at_distances
    largest = float(np.abs(reference.load).max())
    early = _early(reference.load)
    stiffness = _slope(reference.displacement[early], reference.load[early])
    turns = np.flatnonzero(np.diff(np.sign(np.diff(reference.displacement)))) + 1
    unloaded = len(turns) > 0 and abs(reference.load[-1]) <= 1e-6 * largest
    work, wanted = (float(np.trapezoid(values, reference.displacement)) for values in (load, reference.load))
    first = slice(0, int(turns[0]) + 1 if len(turns) else None)
    bends = [_first_yield(reference.displacement[first], values[first]) for values in (load, reference.load)]
    return Errors(
        path_max=float(np.abs(load - reference.load).max()) / largest,
        stiffness=_slope(reference.displacement[early], load[early]) / stiffness - 1.0,
        first_yield=None if None in bends else bends[0] / bends[1] - 1.0,  # type: ignore[operator]
        collapse_load=float(np.abs(load).max()) / largest - 1.0,
        # The model stands where the reference has come to rest: what load it still bears, elastic unloading takes out.
        residual=-float(load[-1]) / stiffness / float(np.abs(reference.displacement).max()) if unloaded else None,
        loop_energy=work / wanted - 1.0 if len(turns) > 0 else None,
    )


@dataclass(frozen=True)
class Findings:
    """What is worked out for the model that was chosen alone.

    Attributes
    ----------
    hinges : tuple of HingePair
        In the reference's order.
    hinges_in_order : bool or None
        Whether the model has them all in that order; None where the reference has none.
    frequency : (float, float)
        First natural frequency of the reference and of the model [Hz].
    """

    hinges: tuple[HingePair, ...]
    hinges_in_order: bool | None
    frequency: tuple[float, float]

    @property
    def frequency_error(self) -> float | None:
        """Signed, over the reference's; None for a structure that is free to move."""
        reference, model = self.frequency
        return model / reference - 1.0 if reference > 0.0 else None


def find(scene: Scene, reference: PushAnswer, push: Push, frequency: tuple[float, float]) -> Findings:
    """Hinges and frequency of a model, whose push is ``push``."""
    pairs = push_hinges(scene, reference.hinges, push)
    return Findings(pairs, in_order(pairs) if pairs else None, frequency)


def _first_yield(displacement: np.ndarray, load: np.ndarray) -> float | None:
    """Load at which load / displacement has fallen by `_BENT`; None when it has not."""
    early = _early(load)
    level = (1.0 - _BENT) * _slope(displacement[early], load[early])
    secant = np.divide(load, displacement, out=np.full_like(load, np.inf), where=displacement != 0.0)
    for i, (before, here) in enumerate(itertools.pairwise(secant)):
        if i > 0 and abs(load[i]) > 0.3 * np.abs(load).max() and here <= level < before:
            share = (before - level) / (before - here)
            return float(load[i] + share * (load[i + 1] - load[i]))
    return None


def _early(load: np.ndarray) -> slice:
    """The points before the load first passes 30 % of its largest, two at least."""
    return slice(0, max(2, int(np.argmax(np.abs(load) > 0.3 * np.abs(load).max()))))


def _slope(x: np.ndarray, y: np.ndarray) -> float:
    """Least-squares slope of a line through the origin."""
    return float(x @ y) / float(x @ x)
