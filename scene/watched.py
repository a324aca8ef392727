"""What a watched displacement comes to, read between the steps at which it is known."""

from __future__ import annotations

import numpy as np


def extreme(displacement: np.ndarray) -> tuple[float, float]:
    """The value that is largest by size, signed, and where it is, counted in steps.

    Both are those of the parabola through the largest of the values (k,) and its neighbours: of a vibration with ten
    steps a period the largest value alone may be a twentieth too small.
    """
    at = int(np.argmax(np.abs(displacement)))
    if not 0 < at < len(displacement) - 1:
        return float(displacement[at]), float(at)
    before, here, after = map(float, displacement[at - 1 : at + 2])
    curvature = before - 2.0 * here + after
    if curvature == 0.0:
        return here, float(at)
    away = 0.5 * (before - after) / curvature
    return here - 0.25 * (before - after) * away, at + away
