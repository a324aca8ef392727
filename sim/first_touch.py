"""Where a fast body first touches another within a step, so that it can end its move there.

Chipmunk finds contacts where shapes overlap after they were moved, so a body that moves far in a step is deep in what
it hits, or beyond it. Its next move is known, though: it goes on with its present velocity. The time of the first touch
in that move is found by conservative advancement: as long as the distance to the nearest shape is d, no touch comes
before d over the greatest speed of approach (B. Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems,
thesis, Berkeley 1996, section 2.3).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import pymunk
import shapely
from shapely.geometry.base import BaseGeometry

from sim.chipmunk import constraints_on, next_move, overlap

_MOST_ADVANCES = 60


@dataclass(frozen=True)
class Touch:
    """A body that would touch another ``time`` [s] into a step.

    Attributes
    ----------
    body : pymunk.Body
    other : pymunk.Body
        What it touches.
    time : float
        [s]
    closing : (float, float)
        By how much its velocity brings it on into what it touches, which may be on its way, too [m/s].
    turning : float
        By how much its spin does [rad/s]; that is not all of it where its velocity leads away.
    """

    body: pymunk.Body
    other: pymunk.Body
    time: float
    closing: tuple[float, float]
    turning: float


def first_touches(space: pymunk.Space, bodies: Iterable[pymunk.Body], dt: float) -> list[Touch]:
    """Those of ``bodies`` that come to touch something within their next move of ``dt`` [s], and when.

    What overlaps already does not count, but for corners that come down on the ground, or on what else is not dynamic;
    nor does the motion of what is not among ``bodies`` and comes from outside of their way. Of two that touch each
    other, the first alone is told, who is to give way to the other.
    """
    touches: list[Touch] = []
    for body in bodies:
        ways = [_Way(own) for own in body.shapes]
        waiting = {touch.body for touch in touches if touch.other is body}
        found = [
            touch
            for way in ways
            for other in space.bb_query(way.box(dt), way.shape.filter)
            if other.body is not None and other.body not in {body, *waiting} and not pass_each_other(body, other.body)
            for touch in (_first_touch(way, _Way(other), dt, space.collision_slop),)
            if touch is not None
        ]
        if found:
            touches.append(min(found, key=lambda touch: touch.time))
    return touches


def stop_at_first_touch(space: pymunk.Space, dt: float) -> list[Touch]:
    """Have fast bodies end the next step's move where they first touch something; to be called before `Space.step`.

    Chipmunk finds what overlaps after a move, and not what was passed within it. Fast is what moves by more than half
    of its width; it is looked at while no constraint holds it.

    Parameters
    ----------
    space : pymunk.Space
    dt : float
        Length of the next step [s].

    Returns
    -------
    list of Touch
        Bodies that are stopped, and when.
    """
    fast = [
        body
        for body in space.bodies
        if body.body_type == pymunk.Body.DYNAMIC and not body.is_sleeping and not constraints_on(body)
        if any(abs(next_move(body)[0]) * dt > 0.5 * _width(shape) for shape in body.shapes)
    ]
    touches = first_touches(space, fast, dt)
    for touch in touches:
        hold_back(touch, dt)
    return touches


def _width(shape: pymunk.Shape) -> float:
    """The smaller side of a shape's box [m]."""
    box = shape.cache_bb()
    return min(box.right - box.left, box.top - box.bottom)


def hold_back(touch: Touch, dt: float) -> None:
    """Put a body back, so that the move of ``dt`` [s] ends where it touches.

    From then on it goes with what it touches: a body that is put back by all of its way, behind another that moves on,
    would have lost it by the end of the step, and strike it a second time.
    """
    left = dt - touch.time
    body = touch.body
    body.position -= pymunk.Vec2d(*touch.closing) * left
    body.angle -= touch.turning * left


def pass_each_other(a: pymunk.Body, b: pymunk.Body) -> bool:
    """Whether a joint keeps the two from colliding."""
    return any(not joint.collide_bodies and b in (joint.a, joint.b) for joint in constraints_on(a))


class _Way:
    """The way of a convex shape in the next move of its body."""

    def __init__(self, shape: pymunk.Shape) -> None:
        body = shape.body
        assert body is not None
        self.shape, self.radius = shape, rounding(shape)
        self.velocity, self.spin = next_move(body)
        self._centre = body.local_to_world(body.center_of_gravity)
        self._arms = [body.local_to_world(point) - self._centre for point in _corners(shape)]
        # Brings what Chipmunk keeps of the shape in the world up to date, too.
        self._box = shape.cache_bb()

    @property
    def fastest_turn(self) -> float:
        """Greatest speed with which turning moves a point of the shape [m/s]."""
        return abs(self.spin) * (max(map(abs, self._arms)) + self.radius) if self.spin != 0.0 else 0.0

    def box(self, dt: float) -> pymunk.BB:
        """Around all places of the shape in a move of ``dt``."""
        bb, turn, (dx, dy) = self._box, self.fastest_turn * dt, self.velocity * dt
        left, bottom = min(bb.left, bb.left + dx) - turn, min(bb.bottom, bb.bottom + dy) - turn
        return pymunk.BB(left, bottom, max(bb.right, bb.right + dx) + turn, max(bb.top, bb.top + dy) + turn)

    def corners(self, time: float) -> list[pymunk.Vec2d]:
        """Where the corners, or the centre of a circle, will be in ``time``."""
        centre, angle = self._centre + self.velocity * time, self.spin * time
        return [centre + (arm.rotated(angle) if angle != 0.0 else arm) for arm in self._arms]

    def distance(self, point: pymunk.Vec2d, time: float) -> float:
        """Distance of a point, where it is in ``time``, from the surface then."""
        centre, angle = self._centre + self.velocity * time, self.spin * time
        # Chipmunk knows the shape where it is now, so the point is brought there.
        arm = point - centre
        return self.shape.point_query(self._centre + (arm.rotated(-angle) if angle != 0.0 else arm)).distance


def _corners(shape: pymunk.Shape) -> list[pymunk.Vec2d]:
    """What a shape is the convex hull of, without its rounding, in coordinates of its body."""
    if isinstance(shape, pymunk.Circle):
        return [shape.offset]
    if isinstance(shape, pymunk.Poly):
        return shape.get_vertices()
    assert isinstance(shape, pymunk.Segment)
    return [shape.a, shape.b]


class _Pair:
    """Corners of two shapes that may come to touch the other one: all of them while the shapes are apart.

    A bar that stands on the ground on one end comes down on the other. Of shapes that ``meets`` says do overlap, those
    corners count that are not in the other one, and will be within ``dt`` [s], but for ``slop`` [m].
    """

    def __init__(self, own: _Way, other: _Way, meets: bool, dt: float, slop: float) -> None:
        self.own, self.other = own, other

        def coming(way: _Way, onto: _Way) -> list[int]:
            corners = enumerate(zip(way.corners(0.0), way.corners(dt), strict=True))
            deep = way.radius - slop
            return [
                i for i, (now, then) in corners if not meets or onto.distance(now, 0.0) > deep > onto.distance(then, dt)
            ]

        self._own = coming(own, other)
        self._others = [] if isinstance(own.shape, pymunk.Circle) else coming(other, own)

    def gap(self, time: float) -> float:
        """Distance of the shapes in ``time``: that of a corner of one from the other."""
        own, other = self.own, self.other
        mine, theirs = own.corners(time), other.corners(time)
        gaps = [other.distance(mine[i], time) - own.radius for i in self._own]
        gaps += [own.distance(theirs[i], time) - other.radius for i in self._others]
        return min(gaps, default=math.inf)

    def line(self, time: float) -> tuple[pymunk.Vec2d, pymunk.Vec2d]:
        """Points of the two shapes, without their rounding, that are nearest in ``time``."""
        own, other = self.own, self.other
        mine, theirs = own.corners(time), other.corners(time)
        lines = [
            shapely.shortest_line(shapely.MultiPoint([mine[i] for i in self._own]), moved(other.shape, time)),
            shapely.shortest_line(moved(own.shape, time), shapely.MultiPoint([theirs[i] for i in self._others])),
        ]
        nearest = min((line for line in lines if line is not None), key=shapely.length)
        here, there = shapely.get_coordinates(nearest)
        return pymunk.Vec2d(*here), pymunk.Vec2d(*there)


def _first_touch(own: _Way, other: _Way, dt: float, slop: float) -> Touch | None:
    """When the two shapes first touch, in a move of ``dt``; a little later, so that Chipmunk sees it."""
    a, b = own.shape.body, other.shape.body
    assert a is not None
    assert b is not None
    approach = abs(own.velocity - other.velocity) + own.fastest_turn + other.fastest_turn
    if approach == 0.0:
        return None
    meets = overlap(own.shape, other.shape)
    if meets and b.body_type == pymunk.Body.DYNAMIC:
        return None
    pair, time = _Pair(own, other, meets, dt, slop), 0.0
    for _ in range(_MOST_ADVANCES):
        distance = pair.gap(time)
        if distance <= 0.01 * slop:
            if distance <= 0.0 and time == 0.0 and not meets:
                return None
            return Touch(a, b, min(time + 0.5 * slop / approach, dt), *_closing(pair, time))
        time += distance / approach
        if time >= dt:
            return None
    return Touch(a, b, min(time, dt), *_closing(pair, time))


def _closing(pair: _Pair, time: float) -> tuple[tuple[float, float], float]:
    """Velocity and spin of the first shape's body towards the other's surface where they touch, in ``time``."""
    a, b = pair.own.shape.body, pair.other.shape.body
    assert a is not None
    assert b is not None
    here, there = pair.line(time)
    (velocity_a, spin_a), (velocity_b, spin_b) = next_move(a), next_move(b)
    arm = there - (b.local_to_world(b.center_of_gravity) + velocity_b * time)
    velocity = velocity_a - velocity_b - spin_b * arm.perpendicular()
    normal = (there - here).normalized()
    if normal == (0.0, 0.0):
        return (velocity.x, velocity.y), spin_a
    approach = velocity.dot(normal)
    closing = max(0.0, approach) * normal
    arm = here - (a.local_to_world(a.center_of_gravity) + velocity_a * time)
    by_turning = spin_a * arm.perpendicular().dot(normal)
    # Where its centre is drawing back, turning goes on by as much as makes up for that.
    share = max(0.0, 1.0 + approach / by_turning) if approach < 0.0 < by_turning else 1.0
    return (closing.x, closing.y), share * spin_a


def rounding(shape: pymunk.Shape) -> float:
    """Radius of a circle or of a shape's corners [m]."""
    assert isinstance(shape, pymunk.Circle | pymunk.Poly | pymunk.Segment)
    return shape.radius


def moved(shape: pymunk.Shape, time: float) -> BaseGeometry:
    """The shape, without its rounding, where its body will be in ``time``."""
    body = shape.body
    assert body is not None
    velocity, spin = next_move(body)
    centre = body.local_to_world(body.center_of_gravity) + velocity * time
    angle = body.angle + spin * time
    c, s = math.cos(angle), math.sin(angle)

    def world(point: pymunk.Vec2d) -> tuple[float, float]:
        x, y = point - body.center_of_gravity
        return centre.x + c * x - s * y, centre.y + s * x + c * y

    points = [world(corner) for corner in _corners(shape)]
    if isinstance(shape, pymunk.Poly):
        return shapely.Polygon(points)
    return shapely.Point(points) if len(points) == 1 else shapely.LineString(points)
