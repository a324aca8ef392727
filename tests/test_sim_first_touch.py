"""Where fast bodies first touch, against distances by shapely."""

import math

import pymunk
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from scene import builtin_text, parse_scene
from sim import Model, assemble, stop_at_first_touch
from sim.chipmunk import overlap
from sim.first_touch import first_touches, hold_back, moved, rounding

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


def bent_by_a_fast_ball(rate: int, stopped: bool) -> float:
    """Plastic work [J] of a cantilever of 50 mm that a ball of 0.1 m and 20 kg flies at with 40 m/s.

    Without gravity, whose first steps are taken in parts, in which the ball is seen.
    """
    space = pymunk.Space()
    space.collision_slop = 1e-3
    strip = parse_scene(builtin_text("cantilever").replace("50x100 mm", "50x50 mm"), "strip")
    beam = assemble(strip, Model("lobatto", 6, "fibre", fibres=8), space)
    ball = pymunk.Body(20.0, 0.5 * 20.0 * 0.05**2)
    ball.position, ball.velocity = (0.85, 0.25), (0.0, -40.0)
    space.add(ball, pymunk.Circle(ball, 0.05))
    for _ in range(round(0.25 * rate)):
        if stopped:
            stop_at_first_touch(space, 1.0 / rate)
        space.step(1.0 / rate)
    return sum(float(joint.dissipated) for joint in beam.joints)


@pytest.mark.parametrize("rate", [60, 240])
def test_a_ball_that_would_pass_a_strip_within_a_step_is_stopped_by_it(rate: int) -> None:
    assert bent_by_a_fast_ball(rate, stopped=False) == 0.0
    assert bent_by_a_fast_ball(rate, stopped=True) == pytest.approx(bent_by_a_fast_ball(1000, stopped=True), rel=0.05)


def test_slow_bodies_and_those_on_constraints_are_not_stopped() -> None:
    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (-1.0, 0.0), (1.0, 0.0), 0.01))
    slow, held = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    slow.position, slow.velocity = (0.0, 0.1), (0.0, -1.0)
    held.position, held.velocity = (0.5, 0.2), (0.0, -40.0)
    space.add(slow, pymunk.Circle(slow, 0.05), held, pymunk.Circle(held, 0.05))
    space.add(pymunk.PinJoint(held, space.static_body, (0.0, 0.0), (0.5, 1.0)))
    assert stop_at_first_touch(space, 1 / 60) == []
    assert slow.position == (0.0, 0.1)
    assert held.position == (0.5, 0.2)


def test_what_broke_off_is_stopped_by_what_it_was_joined_to() -> None:
    """pymunk's bodies go on to list the joints that have left the space, some of which kept the two from colliding."""
    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (-1.0, 0.0), (1.0, 0.0), 0.01))
    ball = pymunk.Body(1.0, 1.0)
    ball.position, ball.velocity = (0.0, 0.3), (0.0, -40.0)
    space.add(ball, pymunk.Circle(ball, 0.05))
    joint = pymunk.PinJoint(ball, space.static_body, (0.0, 0.0), (0.0, 1.0))
    joint.collide_bodies = False
    space.add(joint)
    assert first_touches(space, [ball], 1 / 60) == []
    space.remove(joint)
    (touch,) = stop_at_first_touch(space, 1 / 60)
    assert touch.time == pytest.approx(0.24 / 40.0, abs=space.collision_slop / 40.0)


def test_what_meets_by_turning_while_its_centre_draws_back_stays_with_what_it_meets() -> None:
    """A bar of 2 m that spins on its way up: its end comes down on a ball, from 20 mm above it."""
    space = pymunk.Space()
    space.collision_slop = 1e-4
    bar, ball = pymunk.Body(10.0, 10.0 * 2.0**2 / 12.0), pymunk.Body(1.0, 0.01)
    bar.velocity, bar.angular_velocity = (0.0, 4.0), -10.0
    ball.position = (0.9, -0.17)
    shape, round_one = pymunk.Poly.create_box(bar, (2.0, 0.1)), pymunk.Circle(ball, 0.1)
    space.add(bar, ball, shape, round_one)
    (touch,) = first_touches(space, [bar], 1 / 60)
    assert 0.0 < touch.turning / -10.0 < 0.9
    hold_back(touch, 1 / 60)
    space.step(1 / 60)
    # Where it was put back by all of its turn, they ended 50 mm apart.
    assert abs(shape.point_query(ball.position).distance - 0.1) < 5e-3
