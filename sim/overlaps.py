"""Whether what a scene puts beside each other overlaps from the start; contacts would fling it apart."""

from __future__ import annotations

from collections.abc import Mapping

import pymunk
import shapely
from shapely.geometry.base import BaseGeometry

from capacity import InputError
from sim.first_touch import moved, pass_each_other, rounding

# Share of the smaller of two shapes that may lie in the other. A wheel may stand a little in the ground and rises; a
# member that its supports hold would be bent up by it.
_LOOSE, _MEMBER = 0.1, 0.01


def check_apart(space: pymunk.Space, loose: Mapping[pymunk.Body, str], pieces: Mapping[pymunk.Body, str]) -> None:
    """Check that bodies stand clear of each other, of members and of the ground, and members of the ground.

    Parameters
    ----------
    space : pymunk.Space
        As it is before its first step.
    loose, pieces : mapping
        Places in the scene file of loose bodies and of pieces of members.

    Raises
    ------
    InputError
        Names the first that does not.
    """
    names = {space.static_body: "the ground", **loose, **pieces}
    for body, place in [*loose.items(), *pieces.items()]:
        for shape in body.shapes:
            for other in space.bb_query(shape.bb, shape.filter):
                if other.body is None or other.body is body or (body in pieces and other.body is not space.static_body):
                    continue
                if body.body_type == other.body.body_type == pymunk.Body.STATIC or pass_each_other(body, other.body):
                    continue
                if _share(shape, other) > (_MEMBER if body in pieces else _LOOSE):
                    fault = f"it overlaps with {names.get(other.body, 'another body')} at the start"
                    raise InputError(place, fault, _cure(other.body is space.static_body))


def _cure(with_ground: bool) -> str:
    if with_ground:
        return "raise it, or move the points of the ground, which is solid below their line"
    return "move one of them, or give both the same group if they shall pass through each other"


def _share(one: pymunk.Shape, other: pymunk.Shape) -> float:
    """Of the smaller shape, how much lies in the other."""
    first, second = _solid(one), _solid(other)
    share: float = shapely.intersection(first, second).area / min(first.area, second.area)
    return share


def _solid(shape: pymunk.Shape) -> BaseGeometry:
    radius = rounding(shape)
    outline = moved(shape, 0.0)
    return outline.buffer(radius) if radius > 0.0 else outline
