"""The ends of pieces that lie side by side are no obstacle to what rolls or slides from one to the next.

A surface of several pieces has edges inside it. What lies on it has sunk in by a little, and so would run into the end
of the next piece, or be lifted over its corner.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymunk

from sim.kernels import layout as at

# Cosine of the angle between the normals of surfaces that may carry a body together.
_ALIKE = 0.7
# Over the reach of a shape: a point this near to a corner is one, and distances this much alike are the same.
_SAME = 1e-6


def pass_inner_edges(
    shapes: Sequence[tuple[pymunk.Shape, pymunk.Shape]], places: np.ndarray, touches: np.ndarray
) -> None:
    """Leave out contacts with ends of pieces where others carry the same body.

    Parameters
    ----------
    shapes : sequence of (Shape, Shape)
        For each contact that of the structure's and the other one.
    places, touches : (contacts, ...) arrays
        See `sim.kernels.layout`; what is left out is as if it were far away.
    """
    of_bodies: dict[pymunk.Body | None, list[int]] = {}
    for k in np.flatnonzero(touches[:, at.GAP] < at.FAR).tolist():
        of_bodies.setdefault(shapes[k][1].body, []).append(k)
    for rows in of_bodies.values():
        bearing = [k for k in rows if places[k, at.HASH] or touches[k, at.EARLIER] != 0.0]
        faces = [
            k for k in rows if isinstance(shapes[k][1], pymunk.Circle) and not _is_at_corner(shapes[k][0], touches[k])
        ]
        for k in rows:
            if isinstance(shapes[k][1], pymunk.Circle):
                near = touches[k, at.GAP] + _SAME * touches[k, at.REACH]
                inner = k not in faces and any(touches[face, at.GAP] <= near for face in faces)
            else:
                inner = bool(bearing) and k not in bearing and _likeness(touches, k, bearing) < _ALIKE
            if inner:
                touches[k, at.GAP] = at.FAR


def _is_at_corner(shape: pymunk.Shape, touch: np.ndarray) -> bool:
    """Whether a contact is at a corner of the structure's shape."""
    assert shape.body is not None
    if not isinstance(shape, pymunk.Poly):
        return False
    arm = pymunk.Vec2d(*touch[at.ARM_A : at.ARM_A + 2].tolist()).rotated(-shape.body.angle)
    point, near = arm + shape.body.center_of_gravity, shape.radius + _SAME * float(touch[at.REACH])
    return any(abs(corner - point) <= near for corner in shape.get_vertices())


def _likeness(touches: np.ndarray, k: int, others: list[int]) -> float:
    """Greatest cosine of the angle between the normals of one contact and of others."""
    normals = touches[:, at.NORMAL : at.NORMAL + 2]
    return float((normals[others] @ normals[k]).max())
