"""What pymunk's collision callbacks are told of a structure's contacts, and in which iterations these are solved."""

import math

import pymunk
import pytest
from bodies import piece

from sim import DuctileJoint, ElasticPlastic

STRONG = ElasticPlastic((1e8, 1e8, 1e6), (1e9, 1e9, 1e9))


def bar(space: pymunk.Space, clamped: bool, elasticity: float = 0.0) -> list[pymunk.Body]:
    """Two pieces of a metre and 10 kg."""
    bodies = [piece(space, 10.0, 10.0 / 12.0, x, 0.0) for x in (0.5, 1.5)]
    for body in bodies:
        shape = pymunk.Poly.create_box(body, (1.0, 0.1))
        shape.filter, shape.friction, shape.elasticity = pymunk.ShapeFilter(group=1), 0.5, elasticity
        space.add(shape)
    if clamped:
        space.add(DuctileJoint(space.static_body, bodies[0], (0.0, 0.0), STRONG))
    space.add(DuctileJoint(*bodies, (1.0, 0.0), STRONG))
    return bodies


def told(space: pymunk.Space, kind: int) -> list[tuple[float, float]]:
    """Impulse along y and energy of every contact of shapes of one collision type, from now on."""
    notes: list[tuple[float, float]] = []

    def note(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:  # noqa: ARG001
        notes.append((arbiter.total_impulse.y, arbiter.total_ke))

    space.on_collision(kind, None, post_solve=note)
    return notes


def test_what_rests_presses_with_its_weight() -> None:
    space = pymunk.Space()
    space.gravity, space.collision_slop = (0.0, -9.81), 1e-3
    bar(space, clamped=True)
    box = piece(space, 50.0, 50.0 * 0.04 / 6.0, 1.6, 0.155)
    shape = pymunk.Poly.create_box(box, (0.2, 0.2))
    shape.collision_type = 1
    space.add(shape)
    for _ in range(300):
        space.step(1 / 60)
    notes = told(space, 1)
    space.step(1 / 60)
    assert abs(sum(impulse for impulse, _ in notes)) == pytest.approx(50.0 * 9.81 / 60, rel=1e-4)
    assert all(0.0 <= lost < math.inf for _, lost in notes)
    told_later: list[float] = []
    box.each_arbiter(lambda arbiter: told_later.append(arbiter.total_impulse.y))
    assert sum(told_later) == pytest.approx(sum(impulse for impulse, _ in notes))


@pytest.mark.parametrize("elasticity", [0.0, 0.5])
def test_a_blow_is_told_with_all_the_momentum_that_it_passes_on(elasticity: float) -> None:
    """And with pymunk's energy of it, (1 - e) / (1 + e) Σ j² / m of the two pieces that meet, which is finite."""
    space = pymunk.Space()
    bodies = bar(space, clamped=False, elasticity=elasticity)
    ball = piece(space, 2.0, 0.1, 1.5, 0.2)
    ball.velocity = (0.0, -5.0)
    shape = pymunk.Circle(ball, 0.1)
    shape.collision_type, shape.elasticity = 2, 1.0
    space.add(shape)
    notes = told(space, 2)
    for _ in range(30):
        space.step(1 / 60)
    passed_on = 2.0 * (ball.velocity.y + 5.0)
    assert abs(sum(impulse for impulse, _ in notes)) == pytest.approx(passed_on, rel=1e-9)
    assert sum(body.mass * body.velocity.y for body in bodies) == pytest.approx(-passed_on)
    loss = (1.0 - elasticity) / (1.0 + elasticity) * (1 / 2.0 + 1 / 10.0)
    for impulse, lost in notes:
        # Met away from its middle, a piece turns, too, and is lighter.
        assert loss * impulse**2 <= lost * (1.0 + 1e-9) < 4.0 * loss * impulse**2


def test_energies_are_finite_where_a_step_is_taken_whole_though_more_is_near() -> None:
    """A pivot holds the bar, which no part of a step is taken with; other balls are about to hit it."""
    space = pymunk.Space()
    bodies = bar(space, clamped=False)
    space.add(pymunk.PivotJoint(space.static_body, bodies[0], bodies[0].position))
    notes = told(space, 3)
    for k in range(8):
        ball = piece(space, 10.0, 1.0, 0.1 + 0.25 * k, 0.2 + 0.03 * k)
        ball.velocity = (0.0, -3.0)
        shape = pymunk.Circle(ball, 0.1)
        shape.collision_type = 3
        space.add(shape)
    for _ in range(20):
        space.step(1 / 60)
    assert len(notes) >= 8
    assert all(0.0 <= lost < math.inf for _, lost in notes)


@pytest.mark.parametrize("stacked", [False, True])
def test_a_contact_is_solved_anew_only_where_something_else_has_moved_what_touches(stacked: bool) -> None:
    """A box on a bar: the first iteration has the answer. With another one on it, which Chipmunk solves, it has not."""
    ended = []
    for iterations in (2, 30):
        space = pymunk.Space()
        space.gravity, space.collision_slop, space.iterations = (0.0, -9.81), 1e-3, iterations
        bodies = bar(space, clamped=True)
        for k in range(1 + stacked):
            box = piece(space, 100.0, 1.0, 1.5, 0.15 + 0.2 * k)
            space.add(pymunk.Poly.create_box(box, (0.2, 0.2)))
        for _ in range(30):
            space.step(1 / 60)
        ended.append([(*body.position, body.angle, *body.velocity, body.angular_velocity) for body in [*bodies, box]])
    assert (ended[0] == ended[1]) != stacked
