"""Joints in pymunk's debug drawing."""

import pymunk
import pytest
from bodies import piece
from pymunk.space_debug_draw_options import SpaceDebugColor

from sim import DuctileJoint, ElasticPlastic, draw_joints


class Dots(pymunk.SpaceDebugDrawOptions):
    """Draws dots alone, into a list."""

    def __init__(self) -> None:
        super().__init__()
        self.dots: list[tuple[float, pymunk.Vec2d, SpaceDebugColor]] = []

    def draw_dot(self, size: float, pos: pymunk.Vec2d, color: SpaceDebugColor) -> None:
        self.dots.append((size, pos, color))


def test_a_joint_is_a_dot_that_reddens_with_what_it_bears() -> None:
    space, options = pymunk.Space(), Dots()
    space.gravity = (0.0, -10.0)
    space.add(pymunk.PinJoint(space.static_body, piece(space, 1.0, 1.0, 9.0, 9.0)))
    body = piece(space, 1.0, 1.0, 1.0, 0.0)
    space.add(DuctileJoint(space.static_body, body, (0.0, 0.0), ElasticPlastic((1e7, 1e7, 1e6), (1e3, 1e3, 20.0))))
    draw_joints(space, options)
    assert options.dots == [(5.0, pymunk.Vec2d(0.0, 0.0), options.constraint_color)]
    for _ in range(120):
        space.step(1 / 60)
    draw_joints(space, options, 2.0)
    size, _, colour = options.dots[1]
    # It bears m g at 1 m, half of what it can.
    assert size == 2.0
    assert colour.r == pytest.approx(0.5 * (options.constraint_color.r + 231), abs=0.1)
    options.flags = 0
    draw_joints(space, options)
    assert len(options.dots) == 2
