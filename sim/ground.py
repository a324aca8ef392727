"""The ground: solid blocks under lines.

A line alone is passed by what moves further in a step than it reaches: a corner that is found beyond the line is pushed
out on the far side. So each stretch of a ground line is the upper edge of a block, and whatever is in the block is
pushed out upwards.

Walked from its first point to its last, a line has the ground on its right: below a line that is drawn from left to
right, behind a wall that goes up at the right end of it. A line drawn from right to left is walked from its end.
"""

from __future__ import annotations

import itertools
import math

import pymunk
import shapely

from scene import Ground, Scene

Vector = tuple[float, float]

# A block that would come out elsewhere is halved so many times at most, and no more than this counts as coming out [m].
_MOST_HALVINGS = 40
_TOUCH = 1e-9
# Further than any block reaches [m].
_BEYOND = 1e3
# Cosine of the sharpest bend upwards that blocks follow, 120°.
_SHARP = -0.5
# Sine of a bend that is none.
_STRAIGHT = 1e-9


def add_grounds(scene: Scene, space: pymunk.Space) -> None:
    """The grounds of ``scene``, on the space's static body."""
    for ground in scene.grounds:
        for corners in blocks(ground):
            block = pymunk.Poly(space.static_body, corners)
            block.friction, block.elasticity = ground.friction, ground.restitution
            space.add(block)


def blocks(ground: Ground) -> list[list[Vector]]:
    """Corners of the convex block under each straight stretch of a ground line [m].

    Blocks of neighbouring stretches share the edge between them, but where the line bends up sharply; none comes out of
    the ground at another stretch, so a wall is no thicker than it is drawn.
    """
    points = [(float(x), float(y)) for x, y in ground.points]
    if points[-1][0] < points[0][0]:
        points.reverse()
    stretches = list(itertools.pairwise(_bends(points)))
    directions = [_direction(a, b) for a, b in stretches]
    closed = points[0] == points[-1]
    # The ground goes on straight at both ends, for blocks not to come out of it there.
    ends = [] if closed else [(points[0], directions[0], -_BEYOND), (points[-1], directions[-1], _BEYOND)]
    beyond = [((x, y), (x + way * u, y + way * v)) for (x, y), (u, v), way in ends]
    found = []
    for i, (a, b) in enumerate(stretches):
        own = directions[i]
        before = directions[i - 1] if i > 0 or closed else own
        after = directions[(i + 1) % len(directions)] if i + 1 < len(directions) or closed else own
        edges = _edge_below(own, before, own), _edge_below(own, own, after)
        others = shapely.MultiLineString(stretches[:i] + stretches[i + 1 :] + beyond)
        thickness = float(ground.thickness)
        for _ in range(_MOST_HALVINGS):
            corners = _block(a, b, edges, thickness)
            if shapely.intersection(shapely.Polygon(corners), others).length <= _TOUCH:
                break
            thickness *= 0.5
        found.append(corners)
    return found


def _bends(points: list[Vector]) -> list[Vector]:
    """``points`` without those in a straight part of the line: a corner that slides over a seam may catch there."""
    kept = points[:1]
    for point, following in itertools.pairwise(points[1:]):
        (ax, ay), (bx, by) = _direction(kept[-1], point), _direction(point, following)
        if abs(ax * by - ay * bx) > _STRAIGHT:
            kept.append(point)
    return [*kept, points[-1]]


def _direction(a: Vector, b: Vector) -> Vector:
    length = math.dist(a, b)
    return (b[0] - a[0]) / length, (b[1] - a[1]) / length


def _edge_below(own: Vector, before: Vector, after: Vector) -> Vector:
    """From a point of the line along the edge of a block, to 1 m below the block's own stretch.

    It is as far below both stretches, n₁ and n₂ their normals: (n₁ + n₂) / (1 + n₁·n₂). Where the line bends up so
    sharply that this would reach far, blocks end at right angles; the gap between them is below the point itself.
    """
    bend = before[0] * after[1] - before[1] * after[0]
    along = before[0] * after[0] + before[1] * after[1]
    if bend >= 0.0 and along < _SHARP:
        return own[1], -own[0]
    return (before[1] + after[1]) / (1.0 + along), -(before[0] + after[0]) / (1.0 + along)


def _block(a: Vector, b: Vector, edges: tuple[Vector, Vector], thickness: float) -> list[Vector]:
    """Corners under a stretch from ``a`` to ``b``, down to ``thickness`` or to where the two edges meet."""
    (ax, ay), (bx, by) = edges
    dx, dy = _direction(a, b)
    closing = (ax - bx) * dx + (ay - by) * dy
    depth = min(thickness, math.dist(a, b) / closing) if closing > 0.0 else thickness
    left, right = (a[0] + depth * ax, a[1] + depth * ay), (b[0] + depth * bx, b[1] + depth * by)
    return [a, b, right, left]
