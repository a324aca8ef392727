"""Copies of shapes that are in no space, to ask Chipmunk where they are nearest.

Nothing that it keeps of the shapes themselves, or of their contacts, is touched.
"""

import math

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from sim.chipmunk import BODY_WORDS, COSINE, ORIGIN, body_address, words


def copy_of(shape: pymunk.Shape) -> object:
    """One with the same outline and body; freed when nobody holds it."""
    body = shape.body
    assert body is not None
    if isinstance(shape, pymunk.Circle):
        own = lib.cpCircleShapeNew(body._body, shape.radius, shape.offset)
    elif isinstance(shape, pymunk.Segment):
        own = lib.cpSegmentShapeNew(body._body, shape.a, shape.b, shape.radius)
    else:
        assert isinstance(shape, pymunk.Poly)
        corners = shape.get_vertices()
        own = lib.cpPolyShapeNewRaw(body._body, len(corners), corners, shape.radius)
    return ffi.gc(own, lib.cpShapeFree)


def grow(shape: pymunk.Shape, own: object, margin: float) -> None:
    """Round a copy by ``margin`` [m] more than its shape."""
    assert isinstance(shape, pymunk.Circle | pymunk.Segment | pymunk.Poly)
    kinds = {pymunk.Circle: lib.cpCircleShapeSetRadius, pymunk.Segment: lib.cpSegmentShapeSetRadius}
    kinds.get(type(shape), lib.cpPolyShapeSetRadius)(own, shape.radius + margin)


def bring_up_to_date(own: object) -> pymunk.BB:
    """Put a copy to where its body is; returns its box."""
    box = lib.cpShapeCacheBB(own)
    return pymunk.BB(box.l, box.b, box.r, box.t)


def nearest_points(one: object, other: object) -> tuple[tuple[float, float], list[tuple[float, float, float, float]]]:
    """Where two copies touch: the normal from the first to the second, and at most two pairs of points.

    Of each the point on the first and that on the second; Chipmunk's own distance has the wrong sign for some kinds.
    """
    found = lib.cpShapesCollide(one, other)
    points = [found.points[i] for i in range(found.count)]
    return (found.normal.x, found.normal.y), [(p.pointA.x, p.pointA.y, p.pointB.x, p.pointB.y) for p in points]


def shift(own: object, body: pymunk.Body, x: float, y: float) -> None:
    """Put a copy to where its body is, moved by ``x`` and ``y``."""
    *turn, right, up = words(body_address(body), BODY_WORDS)[COSINE : ORIGIN + 2].tolist()
    lib.cpShapeUpdate(own, (*turn, right + x, up + y))


def place(own: object, angle: float, origin: pymunk.Vec2d) -> None:
    """Put a copy to where its body would be with that angle [rad], and its own origin there [m]."""
    c, s = math.cos(angle), math.sin(angle)
    lib.cpShapeUpdate(own, (c, s, -s, c, *origin))
