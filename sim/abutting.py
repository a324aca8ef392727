"""Which bodies touch where they are joined, though not by a joint of their own: they do not collide.

Bricks of a wall meet at their corners, each joined to a third brick that lies beside both. Such contacts would stop
bricks at once where the joints between them give way gradually, and there are as many of them as joints. Two bodies are
meant that are joined to one third, and that touch as the joints' anchors put them, free of force. They do not collide
until one of the two joints has broken.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import pymunk

from sim.joint import DuctileJoint
from sim.shape_copies import copy_of, grow, nearest_points, place

# Over the smaller body's reach: what is no further apart touches.
_NEAR = 1e-3


def abutting_pairs(joints: Sequence[DuctileJoint], bodies: Sequence[pymunk.Body]) -> np.ndarray:
    """Pairs of dynamic bodies of a structure that touch so, as the kernels look them up.

    Returns
    -------
    pairs : (n,) int64
        The lesser index among ``bodies`` times how many there are, and the greater one; in rising order.
    """
    index = {body: i for i, body in enumerate(bodies) if body.body_type == pymunk.Body.DYNAMIC and body.shapes}
    joined: dict[pymunk.Body, list[DuctileJoint]] = {}
    for joint in joints:
        for body in (joint.a, joint.b):
            joined.setdefault(body, []).append(joint)
    outlines: dict[pymunk.Body, _Outline] = {}
    directly = {frozenset((joint.a, joint.b)) for joint in joints}
    found: dict[tuple[int, int], bool] = {}
    for middle, around in joined.items():
        if middle.body_type != pymunk.Body.DYNAMIC:
            continue
        for one, other in itertools.combinations(around, 2):
            a, b = (joint.b if joint.a is middle else joint.a for joint in (one, other))
            if a not in index or b not in index or frozenset((a, b)) in directly:
                continue
            key = min(index[a], index[b]), max(index[a], index[b])
            if not found.get(key, False):
                for body in (a, b):
                    if body not in outlines:
                        outlines[body] = _Outline(body)
                found[key] = _touch(outlines[a], outlines[b], _pose(one, middle), _pose(other, middle))
    return np.array(sorted(i * len(bodies) + j for (i, j), abut in found.items() if abut), dtype=np.int64)


class _Outline:
    """Copies of a body's shapes, and how far they reach from its centre of gravity [m]."""

    def __init__(self, body: pymunk.Body) -> None:
        self.centre = body.center_of_gravity
        self.shapes = [(shape, copy_of(shape)) for shape in body.shapes if not shape.sensor]
        self.reach = max((_reach(shape, self.centre) for shape, _ in self.shapes), default=0.0)
        self.grown = 0.0

    def grow(self, margin: float) -> None:
        if margin != self.grown:
            self.grown = margin
            for shape, own in self.shapes:
                grow(shape, own, margin)


def _reach(shape: pymunk.Shape, centre: pymunk.Vec2d) -> float:
    """From a body's centre of gravity to the furthest point of a shape [m]."""
    if isinstance(shape, pymunk.Circle):
        corners = [shape.offset]
    elif isinstance(shape, pymunk.Segment):
        corners = [shape.a, shape.b]
    else:
        assert isinstance(shape, pymunk.Poly)
        corners = shape.get_vertices()
    return max((corner - centre).length for corner in corners) + shape.radius


def _pose(joint: DuctileJoint, middle: pymunk.Body) -> tuple[float, pymunk.Vec2d]:
    """How the body on the other side lies to ``middle`` while the joint is free of force: its angle and its centre."""
    ax, ay, bx, by, rest_a, rest_b = joint.geometry[:6].tolist()
    here, there = pymunk.Vec2d(ax, ay), pymunk.Vec2d(bx, by)
    turned = rest_a - rest_b
    if joint.b is middle:
        here, there, turned = there, here, -turned
    return turned, here - there.rotated(turned)


def _touch(a: _Outline, b: _Outline, pose_a: tuple[float, pymunk.Vec2d], pose_b: tuple[float, pymunk.Vec2d]) -> bool:
    margin = _NEAR * min(a.reach, b.reach)
    if (pose_a[1] - pose_b[1]).length > a.reach + b.reach + margin or not (a.shapes and b.shapes):
        return False
    for outline, (angle, centre) in ((a, pose_a), (b, pose_b)):
        outline.grow(0.5 * margin)
        for _, own in outline.shapes:
            place(own, angle, centre - outline.centre.rotated(angle))
    return any(nearest_points(one, other)[1] for _, one in a.shapes for _, other in b.shapes)
