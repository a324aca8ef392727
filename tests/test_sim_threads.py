"""Spaces with threads of Chipmunk's: more than one of them would solve a structure and what touches it at once."""

import pymunk
import pytest

from sim import DuctileJoint, ElasticPlastic

LAW = ElasticPlastic((1e7, 1e7, 1e5), (1e5, 1e5, 2e3))
PIECES = 14


def struck_strips(space: pymunk.Space) -> list[tuple[float, ...]]:
    """Where four strips, struck by four balls each, end: more than fifty constraints and contacts."""
    space.gravity, space.collision_slop = (0.0, -9.81), 1e-3
    pieces = []
    for strip in range(4):
        last = space.static_body
        for i in range(PIECES):
            piece = pymunk.Body(5.0, 1.0)
            piece.position = (0.5 * i + 0.25, 3.0 * strip)
            shape = pymunk.Poly.create_box(piece, (0.5, 0.1))
            shape.filter = pymunk.ShapeFilter(group=strip + 1)
            space.add(piece, shape, DuctileJoint(last, piece, (0.5 * i, 3.0 * strip), LAW))
            pieces.append(piece)
            last = piece
        for k in range(4):
            ball = pymunk.Body(20.0, 1.0)
            ball.position = (1.0 + 0.6 * k, 3.0 * strip + 1.0)
            space.add(ball, pymunk.Circle(ball, 0.15))
    for _ in range(60):
        space.step(1 / 60)
    return [(*piece.position, piece.angle, *piece.velocity) for piece in pieces]


@pytest.mark.parametrize("threads", [1, 2])
def test_the_answer_is_that_of_one_thread_to_the_last_bit(threads: int) -> None:
    space = pymunk.Space(threaded=True)
    space.threads = threads
    assert struck_strips(space) == struck_strips(pymunk.Space())
