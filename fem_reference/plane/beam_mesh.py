"""Structured meshes of a straight beam, fine where it is clamped and yields.

A plastic hinge of a material that does not harden is as short as its elements let it be, and a clamp has singular
corners: both errors fall in proportion to the elements there, the others much faster. So from one level to the next
the elements at an end and in its corners become four times smaller, the rest two times.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from skfem import MeshQuad, MeshQuad2

from fem_reference.plane.mesh import PlaneMesh

#: Length of the elements at a held end and height of those at a corner, as shares of the depth, on level 0; largest
#: length where it yields, and elsewhere, and largest height.
_END, _CORNER, _YIELDING, _ELSEWHERE, _HEIGHT = 1 / 32, 1 / 16, 1 / 4, 1 / 2, 1 / 6
#: A tip-loaded beam of rectangular section yields over the last third of its length, more with shear or hardening.
_YIELDING_LENGTH = 0.45
_GROWTH, _CORNER_GROWTH = 1.3, 1.5


def beam_mesh(length: float, depth: float, level: int, ends: tuple[bool, bool] = (True, False)) -> PlaneMesh:
    """A beam from x = 0 to ``length``, |y| ≤ ``depth`` / 2, with edges "left", "right", "bottom" and "top"; SI.

    ``ends`` says which of its ends, left and right, are held; the mesh is fine there.
    """
    end, corner = _END / 4**level, _CORNER / 4**level
    half = _graded(0.5, corner, _CORNER_GROWTH, lambda y: _HEIGHT / 2**level)
    y = depth * np.concatenate([half - 0.5, 0.5 - half[-2::-1]])
    slender = length / depth
    part = slender if not all(ends) else 0.5 * slender

    def largest(x: float) -> float:
        return _YIELDING / 2**level if x < _YIELDING_LENGTH * part else _ELSEWHERE

    x = depth * _graded(part, end, _GROWTH, largest)
    if all(ends):
        x = np.concatenate([x, length - x[-2::-1]])
    elif ends[1]:
        x = length - x[::-1]
    return tensor_mesh(x, y)


def tensor_mesh(x: np.ndarray, y: np.ndarray) -> PlaneMesh:
    """Rectangles between the ascending coordinates ``x`` and ``y`` [m], with edges "left", "right", "bottom", "top"."""
    made = MeshQuad2.from_mesh(MeshQuad.init_tensor(x, y))
    cells = made.dofs.element_dofs.T[:, [0, 3, 2, 1, 7, 6, 5, 4, 8]]  # counter-clockwise
    mesh = PlaneMesh(made.doflocs.T, cells, {}, np.zeros(len(cells), dtype=int))
    return mesh.with_sides()


def _graded(length: float, first: float, growth: float, largest: Callable[[float], float]) -> np.ndarray:
    """Coordinates from 0 to ``length`` in steps that grow from ``first`` by ``growth``, none above ``largest``."""
    places, step = [0.0], first
    while places[-1] < length:
        places.append(places[-1] + step)
        step = min(step * growth, largest(places[-1]))
    return np.array(places) * (length / places[-1])
