"""A bounce creates no energy, whatever stands behind the surfaces."""

import itertools
import math

import pymunk
import pytest
from hard_cases import MASS, PIECE, Case, chain, law

from sim import SystemLedger


def thrown(case: Case, ratio: float, restitution: float, position: tuple[float, float], slant: float) -> pymunk.Body:
    """A ball of ``ratio`` times a piece's mass that comes down at 5 m/s."""
    mass = ratio * MASS
    ball = pymunk.Body(mass, 0.5 * mass * 0.05**2)
    ball.position, ball.velocity = position, (slant, -5.0)
    circle = pymunk.Circle(ball, 0.05)
    circle.friction = 0.5
    case.space.add(ball, circle)
    for shape in case.space.shapes:
        shape.elasticity = math.sqrt(restitution)
    return ball


@pytest.mark.parametrize("ratio", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("stiffness", [1.0, 1e3])
@pytest.mark.parametrize("restitution", [0.3, 1.0])
@pytest.mark.parametrize("clamped", [True, False])
def test_a_ball_that_bounces_off_a_bar_creates_no_energy(
    clamped: bool, restitution: float, stiffness: float, ratio: float
) -> None:
    """Ten pieces of 40 mm that do not yield, struck off centre by a ball of ``ratio`` times a piece's mass at 5 m/s."""
    case = chain(10, law(stiffness, strength=1e3), clamped=clamped, gravity=0.0, shapes=True)
    ball = thrown(case, ratio, restitution, (8.5 * PIECE, 0.12), 1.5)
    ledger, given = SystemLedger(case.space), 0.5 * ball.kinetic_energy
    for _ in range(100):
        case.space.step(1 / 1000)
        ledger.note()
        now = ledger.energy
        assert now.external == pytest.approx(given, rel=1e-12)
        assert now.kinetic + now.elastic <= given * (1.0 + 1e-12)
        assert now.numerical >= -1e-12 * given
        assert now.contact >= 0.0
    assert case.structure.unconverged == 0


@pytest.mark.parametrize("ratio", [1.0, 1e3])
@pytest.mark.parametrize("clamped", [True, False])
def test_a_ball_wedged_between_pieces_creates_no_energy(clamped: bool, ratio: float) -> None:
    """At 60 Hz it goes 83 mm in a step, into pieces of 40 × 100 mm, and may come to lie between two of them."""
    for restitution, stiffness, piece, height, slant in itertools.product(
        (0.0, 0.3, 1.0), (1.0, 1e3), (5.0, 8.5, 9.7), (0.101, 0.12, 0.15, 0.17), (0.0, 1.5)
    ):
        case = chain(10, law(stiffness, strength=1e3), clamped=clamped, gravity=0.0, shapes=True)
        ball = thrown(case, ratio, restitution, (piece * PIECE, height), slant)
        ledger, given = SystemLedger(case.space), 0.5 * ball.kinetic_energy
        for _ in range(12):
            case.space.step(1 / 60)
            ledger.note()
            now = ledger.energy
            assert now.kinetic + now.elastic <= now.external + 1e-9 * given
            assert now.numerical >= -1e-9 * given


@pytest.mark.parametrize("restitution", [0.2, 0.6, 1.0])
def test_a_light_ball_bounces_as_its_shape_asks_for(restitution: float) -> None:
    """What is behind the surface takes nothing from a ball of a thousandth of a piece."""
    case = chain(10, law(1e3), gravity=0.0, shapes=True)
    ball = pymunk.Body(1e-3 * MASS, 1e-6)
    ball.position, ball.velocity = (8.5 * PIECE, 0.12), (0.0, -5.0)
    case.space.add(ball, pymunk.Circle(ball, 0.05))
    for shape in case.space.shapes:
        shape.elasticity = math.sqrt(restitution)
    for _ in range(20):
        case.space.step(1 / 1000)
    assert ball.velocity.y == pytest.approx(5.0 * restitution, rel=0.01)
