"""Bodies so fast that they go past the middle of a piece within a step: held on the side that they came from."""

import itertools
import math

import numpy as np
import pymunk
import pytest
from hard_cases import chain


def shot(speed: float, depth: float, box: bool, clamped: bool) -> tuple[pymunk.Space, pymunk.Body]:
    """A small body that is ``depth`` below the upper face of a bar of 100 mm after three steps of 1/60 s."""
    case = chain(20, clamped=clamped, gravity=0.0, shapes=True)
    space = case.space
    body = pymunk.Body(3.0, 3.0 * 0.05**2 / 2.0)
    body.position, body.velocity = (0.413, 0.05 + 0.05 - depth + 3 * speed / 60), (0.0, -speed)
    space.add(body, pymunk.Poly.create_box(body, (0.1, 0.1)) if box else pymunk.Circle(body, 0.05))
    return space, body


@pytest.mark.parametrize(
    ("speed", "depth", "box", "clamped"),
    [
        *itertools.product([30.0, 60.0, 100.0], [0.09, 0.13, 0.17], [False, True], [False]),
        (30.0, 0.13, False, True),
        (100.0, 0.13, True, True),
    ],
)
def test_a_fast_body_stays_on_its_side(speed: float, depth: float, box: bool, clamped: bool) -> None:
    space, body = shot(speed, depth, box, clamped)
    pieces = [other for other in space.bodies if other is not body]
    momentum = [sum(other.mass * np.array(other.velocity) for other in space.bodies)]
    energy = 0.5 * body.mass * speed**2
    for _ in range(20):
        space.step(1 / 60)
        momentum.append(sum(other.mass * np.array(other.velocity) for other in space.bodies))
    along = min(pieces, key=lambda other: abs(other.position.x - body.position.x))
    assert (body.position - along.position).dot(along.rotation_vector.perpendicular()) > 0.0
    now = sum(0.5 * b.mass * b.velocity.length**2 + 0.5 * b.moment * b.angular_velocity**2 for b in space.bodies)
    assert now < energy
    if not clamped:
        np.testing.assert_allclose(np.diff(momentum, axis=0), 0.0, atol=1e-12 * body.mass * speed)


def test_what_rolls_over_the_pieces_of_a_bar_is_not_stopped_between_them() -> None:
    case = chain(30, gravity=9.81, shapes=True)
    ball = pymunk.Body(1.0, 0.5 * 0.05**2)
    ball.position, ball.velocity, ball.angular_velocity = (0.1, 0.1), (3.0, 0.0), -60.0
    shape = pymunk.Circle(ball, 0.05)
    shape.friction = 0.5
    case.space.add(ball, shape)
    for _ in range(18):
        case.space.step(1 / 60)
    assert ball.position.x == pytest.approx(1.0, abs=0.02)
    assert ball.velocity.length == pytest.approx(3.0, rel=0.02)
    assert math.isclose(ball.position.y, 0.1, abs_tol=5e-3)
