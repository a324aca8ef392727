"""Structured meshes of a straight beam, fine where it is held and yields.

From one level to the next every element becomes half as long and half as high, everywhere: only then do errors of all
kinds fall by factors of their own, and may be extrapolated.
"""

from __future__ import annotations

import math

import numpy as np
from skfem import MeshQuad, MeshQuad2

from fem_reference.plane.mesh import PlaneMesh

#: On level 0, as shares of the depth: length of the elements at a held end, its growth with the distance from there,
#: and the largest; height of those at top and bottom, where a clamp has singular corners, growth, and the largest. The
#: front of yielding moves through the depth, so that the curve is as smooth as the elements are low.
_LENGTH, _HEIGHT = (1 / 16, 0.225, 3 / 4), (3 / 32, 0.375, 0.12)


def beam_mesh(
    length: float, depth: float, level: int, ends: tuple[bool, bool] = (True, False), *, half: bool = False
) -> PlaneMesh:
    """A beam from x = 0 to ``length``, |y| ≤ ``depth`` / 2, with edges "left", "right", "bottom" and "top"; SI.

    ``ends`` says which of its ends, left and right, are held; the mesh is fine there. ``half`` asks for the upper half
    alone, whose bottom is the beam's axis.
    """
    below = depth * (_graded(0.5, _HEIGHT, level) - 0.5)
    y = -below[::-1] if half else np.concatenate([below, -below[-2::-1]])
    if all(ends):
        x = depth * _graded(0.5 * length / depth, _LENGTH, level)
        x = np.concatenate([x, length - x[-2::-1]])
    else:
        x = depth * _graded(length / depth, _LENGTH, level)
        x = length - x[::-1] if ends[1] else x
    return tensor_mesh(x, y)


def tensor_mesh(x: np.ndarray, y: np.ndarray) -> PlaneMesh:
    """Rectangles between the ascending coordinates ``x`` and ``y`` [m], with edges "left", "right", "bottom", "top"."""
    made = MeshQuad2.from_mesh(MeshQuad.init_tensor(x, y))
    cells = made.dofs.element_dofs.T[:, [0, 3, 2, 1, 7, 6, 5, 4, 8]]  # counter-clockwise
    mesh = PlaneMesh(made.doflocs.T, cells, {}, np.zeros(len(cells), dtype=int))
    return mesh.with_sides()


def _graded(length: float, sizes: tuple[float, float, float], level: int) -> np.ndarray:
    """Coordinates from 0 to ``length`` in steps of about min(first + growth x, largest) / 2^level."""
    first, growth, largest = sizes
    # How many steps of level 0 there are up to x: ln(1 + growth x / first) / growth, then evenly.
    even = min((largest - first) / growth, length)
    grown = math.log1p(growth * even / first) / growth
    steps = grown + (length - even) / largest
    count = math.ceil(steps) * 2**level if level >= 0 else math.ceil(steps * 2.0**level)
    share = np.linspace(0.0, steps, count + 1)
    x = np.where(share < grown, first * np.expm1(growth * share) / growth, even + (share - grown) * largest)
    x[-1] = length
    return np.asarray(x)
