"""Parts of a step while a blow lasts: how long they are, and that blows are those of steps which resolve them."""

import itertools
import math

import numpy as np
import pymunk
import pytest
from numba import njit
from sudden_cases import SIX, beam_on_pins, new_space

from scene import builtin_text, parse_scene
from sim import Assembly, assemble
from sim.kernels import layout as at
from sim.kernels.lengths import averaged_lengths, part_lengths

STRIP = parse_scene(builtin_text("cantilever").replace("rectangle 50x100 mm", "rectangle 20x50 mm"), "strip")
LONGEST = 0.5e-3


@njit
def part_lengths_of(settings, span):  # type: ignore[no-untyped-def]
    return part_lengths(settings, span)


@njit
def averaged_lengths_of(settings, span):  # type: ignore[no-untyped-def]
    return averaged_lengths(settings, span)


def lengths(span: float, age: float, shortest: float = 0.05e-3) -> tuple[np.ndarray, np.ndarray]:
    settings = np.zeros(at.SETTINGS_WORDS)
    settings[[at.WHOLE_STEP, at.BLOW_AGE, at.SHORTEST]] = span, age, shortest
    moves, steps = part_lengths_of(settings, span)
    return moves, steps


@pytest.mark.parametrize("shortest", [0.05e-3, 0.2e-3, LONGEST])
def test_moves_and_the_times_that_forces_act_sum_up_to_the_step(shortest: float) -> None:
    spans, ages = (1.9 / 60, 1 / 60, 1 / 144, 1e-3, 0.98e-3, 0.55e-3, 0.13e-3, 0.06e-3), (0.0, 0.7e-3, 5e-3, 0.1)
    for span, age in itertools.product(spans, ages):
        if span > max(0.05 * age, shortest):  # it is taken whole otherwise
            moves, steps = lengths(span, age, shortest)
            assert moves.sum() == pytest.approx(span, rel=1e-13)
            assert steps.sum() == pytest.approx(span, rel=1e-13)
            assert (moves > 0.0).all()
            assert moves.max() <= LONGEST * (1.0 + 1e-12)


@pytest.mark.parametrize("shortest", [0.05e-3, LONGEST])
def test_averaged_parts_move_bodies_for_the_mean_of_the_times_that_forces_act(shortest: float) -> None:
    """And end with a move as long as the last of these."""
    settings = np.zeros(at.SETTINGS_WORDS)
    for span, age in itertools.product((1 / 60, 1e-3, 0.63e-3), (0.0, 0.7e-3, 0.1)):
        settings[[at.WHOLE_STEP, at.BLOW_AGE, at.SHORTEST]] = span, age, shortest
        moves, steps = averaged_lengths_of(settings, span)
        assert steps.sum() == pytest.approx(span, rel=1e-13)
        assert steps.max() <= LONGEST * (1.0 + 1e-12)
        np.testing.assert_allclose(moves[:-1], 0.5 * (steps[1:] + steps[:-1]))
        assert moves[-1] == steps[-1]


def test_parts_grow_with_the_blow_up_to_half_a_millisecond() -> None:
    moves, steps = lengths(1 / 60, 0.0)
    assert moves[[0, -1]] == pytest.approx(0.05e-3)
    assert (np.diff(moves[:-1]) >= -1e-18).all()
    assert (moves[:-1] <= np.maximum(0.05 * (np.cumsum(moves[:-1]) - moves[:-1]), 0.05e-3) * (1.0 + 1e-12)).all()
    np.testing.assert_allclose(steps[1:], 0.5 * (moves[1:] + moves[:-1]))
    assert len(moves) < 2.5 * len(lengths(1 / 60, 0.1)[0])
    assert len(lengths(1 / 60, 0.1)[0]) <= 1.0 / 60 / LONGEST + 2


def struck(rate: int, ratio: float, speed: float) -> tuple[float, float]:
    """Peak and lasting deflection [m] of a strip whose tip a ball of ``ratio`` times its mass strikes."""
    space = new_space(10, 0.0)
    beam: Assembly = assemble(STRIP, SIX, space)
    mass = ratio * float(STRIP.members["beam"].mass_per_length)
    ball = pymunk.Body(mass, 0.5 * mass * 0.05**2)
    # It overlaps by a third of its way in a step, or by 5 mm, when it is seen.
    ball.position, ball.velocity = (0.98, 0.075 + speed / rate - min(5e-3, 0.3 * speed / rate)), (0.0, -speed)
    space.add(ball, pymunk.Circle(ball, 0.05))
    way = []
    for _ in range(round(0.15 * rate)):
        space.step(1.0 / rate)
        way.append(-beam.nodes["tip"].now()[1])
    return max(way), float(np.mean(way[-math.ceil(0.03 * rate) :]))


@pytest.mark.parametrize(("ratio", "speed"), [(0.2, 30.0), (1.0, 15.0), (20.0, 3.0)])
def test_a_ball_bends_a_strip_as_in_steps_that_resolve_the_blow(ratio: float, speed: float) -> None:
    fine = struck(16000, ratio, speed)
    for rate in (240, 1000):
        assert struck(rate, ratio, speed) == pytest.approx(fine, rel=0.05)


def test_a_beam_that_falls_on_pins_takes_what_it_takes_in_short_steps() -> None:
    """671 J and 86.3 mm in steps of 25 µs of the second-order scheme."""
    assert beam_on_pins(60, 10) == pytest.approx((671.0, 0.0863), rel=0.05)
