"""Where fast bodies first touch, against distances by shapely."""

import math

import pymunk
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from sim.chipmunk import overlap
from sim.first_touch import first_touches, moved, rounding

CORNERS = [(-0.4, -0.2), (0.5, -0.3), (0.3, 0.4), (-0.2, 0.3)]
KINDS = ["circle", "polygon", "rounded polygon", "segment"]
NUMBERS = st.floats(-3.0, 3.0)
MOTION = st.tuples(NUMBERS, NUMBERS, NUMBERS, st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(-30.0, 30.0))


def shape_of(space: pymunk.Space, kind: str, motion: tuple[float, ...]) -> pymunk.Shape:
    """A shape of a body whose centre of gravity is not its origin."""
    body = pymunk.Body(1.0, 1.0)
    body.center_of_gravity = (0.1, -0.05)
    if kind == "circle":
        shape: pymunk.Shape = pymunk.Circle(body, 0.3, (0.2, 0.1))
    elif kind == "segment":
        shape = pymunk.Segment(body, (-0.6, 0.0), (0.5, 0.2), 0.02)
    else:
        shape = pymunk.Poly(body, CORNERS, radius=0.05 if kind.startswith("rounded") else 0.0)
    body.position, body.angle = motion[:2], motion[2]
    body.velocity, body.angular_velocity = motion[3:5], motion[5]
    space.add(body, shape)
    return shape


@given(kinds=st.tuples(st.sampled_from(KINDS), st.sampled_from(KINDS)), one=MOTION, two=MOTION)
def test_first_touch_is_where_the_distance_is_gone(
    kinds: tuple[str, str], one: tuple[float, ...], two: tuple[float, ...]
) -> None:
    """Apart until the touch, within the space's slop of each other at it; without one apart all the way."""
    dt, space = 1.0 / 60.0, pymunk.Space()
    space.collision_slop = 1e-3
    own, other = (shape_of(space, kind, motion) for kind, motion in zip(kinds, (one, two), strict=True))

    def apart(time: float) -> float:
        return float(shapely.distance(moved(own, time), moved(other, time))) - rounding(own) - rounding(other)

    assert own.body is not None
    touches = first_touches(space, [own.body], dt)
    if abs(apart(0.0)) > 1e-9:
        assert overlap(own, other) == (apart(0.0) < 0.0)
    if overlap(own, other):
        assert not touches
        return
    end = touches[0].time if touches else dt
    if touches:
        assert abs(apart(end)) <= space.collision_slop
    if touches or own.cache_bb().intersects(other.cache_bb()):
        # What comes from outside of its way is not looked for.
        assert all(apart(share * end) > -space.collision_slop for share in (0.25, 0.5, 0.75, 1.0))


@pytest.mark.parametrize("kind", KINDS)
def test_a_body_that_flies_at_a_wall_touches_it_in_time(kind: str) -> None:
    space = pymunk.Space()
    wall = pymunk.Segment(space.static_body, (10.0, -50.0), (10.0, 50.0), 0.1)
    space.add(wall)
    shape = shape_of(space, kind, (0.0, 0.0, 0.0, 100.0, 0.0, 0.0))
    ahead = 9.9 - max(x for x, _ in shapely.get_coordinates(moved(shape, 0.0))) - rounding(shape)
    assert shape.body is not None
    (touch,) = first_touches(space, [shape.body], 0.2)
    assert touch.time == pytest.approx(ahead / 100.0, abs=space.collision_slop / 100.0)
    assert touch.closing == pytest.approx((100.0, 0.0), abs=1e-9)
    assert math.isclose(touch.time, first_touches(space, [shape.body], 1.0)[0].time)
