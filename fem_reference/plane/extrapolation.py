"""What curves on finer and finer meshes tend to, and how far it may be off.

Every element is divided into four from one mesh to the next. Plastic hinges of a material that does not harden and the
singular corners of a clamp leave an error in proportion to the size of the elements, so that what the last refinement
brought is what is missing, and the limit is (Richardson)

    u = 2 u_fine - u_coarse.

What is left of it is taken to fall with the square of the size, as it is seen to: a third of what the third mesh
changed the extrapolation by. Where steps from mesh to mesh fall less than to a half, the sum of the geometric series is
taken that they begin. `SAFETY` on all of that is the factor of Roache's grid convergence index.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.plane.path import Trace

SAFETY = 1.25
#: Largest ratio of successive steps that still counts as convergence; beyond it, the sum of the series is cut off.
_SLOWEST = 0.95

#: One quantity of a path, point by point.
Along = Callable[[Trace], Sequence[float]]


@dataclass(frozen=True)
class Convergence:
    """Paths of one body through the same programme on two meshes or more, from coarse to fine.

    Attributes
    ----------
    paths : tuple of Trace
    extrapolated : bool
        Whether answers are extrapolated: where that has the smaller estimated error of the load.
    """

    paths: tuple[Trace, ...]
    extrapolated: bool

    @staticmethod
    def of(paths: Sequence[Trace]) -> Convergence:
        """The last three of ``paths``; those that were stopped, or led by load, are not to be extrapolated."""
        last = tuple(paths[-3:])
        alike = len(last) == 3 and len({len(path.load) for path in last}) == 1 and not any(p.stopped for p in last)
        plain, extrapolated = _errors([np.array(path.load) for path in last]) if alike else (0.0, 1.0)
        return Convergence(last, extrapolated < plain)

    def answer(self, along: Along) -> np.ndarray:
        """A quantity on the finest mesh, or extrapolated."""
        fine = np.array(along(self.paths[-1]))
        return 2.0 * fine - np.array(along(self.paths[-2])) if self.extrapolated else fine

    def error(self, along: Along, scale: float = 0.0) -> float:
        """Estimated largest error of that, over ``scale`` or the largest value; 1 where there is nothing to compare."""
        both = min(len(path.load) for path in self.paths)
        values = [np.array(along(path)[:both]) for path in self.paths]
        if both < 2:
            return 1.0
        plain, extrapolated = _errors(values, scale)
        return extrapolated if self.extrapolated else plain


def _errors(values: Sequence[np.ndarray], scale: float = 0.0) -> tuple[float, float]:
    """Estimated errors of the last of ``values``, and of what they tend to, over ``scale`` or the largest value."""
    *before, coarse, fine = values
    whole = scale or float(np.abs(fine).max())
    step = float(np.abs(fine - coarse).max()) / whole
    if not before:
        return SAFETY * step, np.inf
    last = float(np.abs(coarse - before[-1]).max()) / whole
    ratio = min(max(step / last, 0.5), _SLOWEST) if last else 0.5
    missing = step * ratio / (1.0 - ratio)
    changed = float(np.abs(2.0 * fine - 3.0 * coarse + before[-1]).max()) / whole
    return SAFETY * missing, SAFETY * max(changed / 3.0, missing - step)
