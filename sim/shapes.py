"""What the pieces of a scene look like to the rest of a space, and which of them may touch.

A piece is as deep as its section. Where a hinge turns, the pieces on both sides of it overlap, and so do the ends of
members that meet in a node; that is the joint's business and no contact. Pieces that lie further apart along the
structure than their depth do collide, and so do neighbours whose joint has broken, once they have come apart.
"""

from __future__ import annotations

import heapq
import itertools

import pymunk

from sim.joint import DuctileJoint

#: Friction of a piece, steel on steel.
FRICTION = 0.5
# Pieces of one assembly have a collision type of their own, by which Chipmunk finds the function below.
_types = itertools.count(0xD0C7)


def add_box(body: pymunk.Body, corners: list[tuple[float, float]]) -> pymunk.Shape:
    """Give ``body`` a box with ``corners`` in its own coordinates; mass and moment stay."""
    shape = pymunk.Poly(body, corners)
    shape.friction = FRICTION
    assert body.space is not None
    body.space.add(shape)
    return shape


def keep_neighbours_apart(space: pymunk.Space, bodies: list[pymunk.Body], depth: float) -> None:
    """Let shapes of ``bodies`` pass through each other where less than ``depth`` [m] of structure lies between."""
    kind = next(_types)
    for body in bodies:
        for shape in body.shapes:
            shape.collision_type = kind
    space.on_collision(kind, kind, begin=_pass_neighbours, data=depth)


def _pass_neighbours(arbiter: pymunk.Arbiter, space: pymunk.Space, depth: float) -> None:  # noqa: ARG001
    """Chipmunk asks once, when two shapes begin to touch; the answer holds until they have come apart."""
    first, second = (shape.body for shape in arbiter.shapes)
    if first is not None and second is not None and _way_between(first, second, depth) < depth:
        arbiter.process_collision = False


def _way_between(first: pymunk.Body, second: pymunk.Body, longest: float) -> float:
    """Length of the structure between two bodies, from joint to joint [m]; anything beyond ``longest`` is as good."""
    if any(isinstance(joint, DuctileJoint) and not joint.broken for joint in first.constraints & second.constraints):
        return 0.0
    tie = itertools.count()  # bodies cannot be compared
    queue: list[tuple[float, int, pymunk.Body, tuple[float, float] | None]] = [(0.0, next(tie), first, None)]
    done: set[pymunk.Body] = set()
    while queue:
        way, _, body, entered = heapq.heappop(queue)
        if body is second or way >= longest:
            return way
        if body in done:
            continue
        done.add(body)
        for joint in body.constraints:
            if isinstance(joint, DuctileJoint) and joint.b.body_type == joint.a.body_type == pymunk.Body.DYNAMIC:
                other = joint.b if joint.a is body else joint.a
                here = joint.point_on(body)
                more = 0.0 if entered is None else pymunk.Vec2d(*here).get_distance(entered)
                if not joint.broken:
                    heapq.heappush(queue, (way + more, next(tie), other, joint.point_on(other)))
    return longest
