"""Vehicles that strike structures: their order, energy and momentum; what they do at any step is in `step_sweeps`."""

import numpy as np
import pymunk
import pytest
from hard_cases import chain, largest, law
from vehicle_cases import car, post_hit


def test_it_does_not_matter_whether_a_post_or_the_car_that_hits_it_came_first() -> None:
    """The car's springs act before the post begins its step, or after."""
    assert post_hit(60, 10, post_first=True)[:2] == pytest.approx(post_hit(60, 10)[:2], rel=0.01)


@pytest.mark.parametrize("torque", [0.0, 200.0])
def test_a_car_that_a_post_throws_back_meets_it_again_within_a_step(torque: float) -> None:
    """It does so 30 ms later, above or below the end of the same piece, at 60 Hz as at 240 Hz."""
    assert post_hit(60, 10, torque=torque)[:2] == pytest.approx(post_hit(240, 10, torque=torque)[:2], rel=0.02)


def test_a_car_that_is_three_posts_deep_in_one_that_hardly_moves_goes_back_to_where_it_touched() -> None:
    """At 20 m/s it goes by 0.33 m a step, in the second of which it strikes: the first has put the post's weight on."""
    assert post_hit(60, 10, 20.0)[:2] == pytest.approx(post_hit(240, 10, 20.0)[:2], rel=0.03)


@pytest.mark.parametrize(("rate", "speed"), [(60, 10.0), (240, 10.0), (60, 20.0), (240, 5.0)])
def test_energy_of_a_car_that_hits_a_post_goes_somewhere_and_comes_from_nowhere(rate: int, speed: float) -> None:
    _, work, entries = post_hit(rate, 10, speed, torque=200.0)
    for now in entries:
        assert abs(now.gap) <= 1e-12 * largest(now)
        assert now.numerical >= -1e-12 * largest(now)
        assert now.contact >= -1e-12 * largest(now)
    # What 540 kg and two wheels that roll have brought, and what their motors may add.
    assert 0.1 < work / (0.5 * (540.0 + 2.0 * 10.0) * speed**2) < 1.02


def momenta(space: pymunk.Space) -> np.ndarray:
    """Linear momentum and angular momentum about the origin of all bodies."""
    total = np.zeros(3)
    for body in space.bodies:
        momentum = body.mass * body.velocity
        total += (*momentum, body.position.cross(momentum) + body.moment * body.angular_velocity)
    return total


@pytest.mark.parametrize("rate", [60, 240])
def test_momentum_of_a_car_that_flies_into_a_free_bar_is_kept(rate: int) -> None:
    case = chain(8, law(), shapes=True, gravity=0.0, clamped=False)
    case.space.collision_slop = 1e-3
    car(case.space, (-1.0, 0.05), 10.0, torque=200.0)
    before, moved = momenta(case.space), False
    for _ in range(rate // 4):
        case.space.step(1.0 / rate)
        now = momenta(case.space)
        assert np.abs(now - before).max() <= 1e-9 * 5400.0
        moved = moved or case.structure.energy.contact > 10.0
    assert moved
