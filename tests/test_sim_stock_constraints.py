"""Constraints of pymunk's own at the bodies of structures: solved through these, whatever the space's iterations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pymunk
import pytest
from hard_cases import BAR, PIECE, RIGID, chain, law
from stock_cases import load

from sim import DuctileJoint, energy
from sim.stock import KINDS

TIP, BELOW = (0.38, 0.0), (0.38, -0.2)

Tie = Callable[[pymunk.Body, pymunk.Body], pymunk.Constraint]
TIES: dict[str, Tie] = {
    "pin": lambda a, b: pymunk.PinJoint(a, b),
    "slide": lambda a, b: pymunk.SlideJoint(a, b, (0.0, 0.0), (0.0, 0.0), 0.0, 0.25),
    "pivot": lambda a, b: pymunk.PivotJoint(a, b, BELOW),
    "groove": lambda a, b: pymunk.GrooveJoint(a, b, (-0.1, -0.2), (0.1, -0.2), (0.0, 0.0)),
    "rotary limit": lambda a, b: pymunk.RotaryLimitJoint(a, b, -0.1, 0.1),
    "ratchet": lambda a, b: pymunk.RatchetJoint(a, b, 0.0, 0.1),
    "gear": lambda a, b: pymunk.GearJoint(a, b, 0.1, 2.0),
    "motor": lambda a, b: pymunk.SimpleMotor(a, b, 5.0),
    "spring": lambda a, b: pymunk.DampedSpring(a, b, (0.0, 0.0), (0.0, 0.0), 0.2, 5e4, 1e3),
    "rotary spring": lambda a, b: pymunk.DampedRotarySpring(a, b, 0.2, 50.0, 1.0),
}


def swung(make: Tie, iterations: int, first: bool, stiffness: float = 1.0) -> np.ndarray:
    """How a bar of ten pieces, and a body of 30 kg that turns and is tied to its tip, move within half a second."""
    case = chain(10, law(stiffness, RIGID))
    space, joints = case.space, list(case.structure.joints)
    body = load(case, 30.0, *BELOW)
    body.angular_velocity = 2.0
    tie = make(case.bodies[9], body)
    if first:
        # So that Chipmunk comes to it before it comes to the structure.
        space.remove(*joints)
        space.add(tie, *joints)
    else:
        space.add(tie)
    space.iterations = iterations
    found = []
    for _ in range(30):
        space.step(1 / 60)
        found.append([*body.position, body.angle, *case.bodies[9].position, case.bodies[9].angle])
    assert energy(space).numerical >= 0.0
    return np.array(found)


def test_every_kind_is_tried() -> None:
    assert len(TIES) == len(KINDS)


@pytest.mark.parametrize("name", TIES)
def test_the_answer_does_not_depend_on_iterations_nor_on_the_order_in_the_space(name: str) -> None:
    """It does on a piece alone, which is a hundredth of what hangs on it."""
    wanted = swung(TIES[name], 2, first=False)
    np.testing.assert_allclose(swung(TIES[name], 30, first=False), wanted, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(swung(TIES[name], 1, first=True), wanted, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("iterations", [1, 10])
def test_what_hangs_on_a_pivot_bends_a_bar_as_statics_says(iterations: int) -> None:
    """Σ P (l - x)² w / EI + P w / GA_s over joints at x that stand for w each, without the weight of the bar."""
    case = chain(20, law(strength=RIGID), mass=1e-3)
    case.space.iterations = iterations
    case.space.damping = 0.9
    body = load(case, 1000.0, 0.78, -0.2)
    case.space.add(pymunk.PivotJoint(case.bodies[19], body, (0.78, 0.0)))
    for _ in range(600):
        case.space.step(1 / 60)
    sag = sum((0.78 - PIECE * i) ** 2 * PIECE / BAR.EI + PIECE / BAR.GA_s for i in range(20)) * 9.81 * 1000.0
    assert -case.bodies[19].position.y == pytest.approx(sag, rel=1e-3)


def test_a_motor_bends_no_more_than_its_greatest_torque() -> None:
    """The joint at the wall bears the torque that turns the wheel."""
    for iterations in (1, 30):
        case = chain(10, gravity=0.0)
        case.space.iterations = iterations
        wheel = load(case, 5e4, 0.38, -0.2)
        motor = pymunk.SimpleMotor(case.bodies[9], wheel, 100.0)
        motor.max_force = 200.0
        case.space.add(motor)
        for _ in range(120):
            case.space.step(1 / 60)
        assert abs(case.structure.force[0, 2]) == pytest.approx(200.0, rel=1e-3)
        assert abs(wheel.angular_velocity) == pytest.approx(2.0 * 200.0 / wheel.moment, rel=1e-2)


def test_structures_on_one_tie_are_solved_as_one() -> None:
    """Of two bars on one pivot, each bears its half of a load on one of them, with one iteration."""
    case = chain(10, law(strength=RIGID), mass=1e-3)
    other = chain(10, law(strength=RIGID), mass=1e-3)
    space, joints = case.space, list(other.structure.joints)
    other.space.remove(*other.space.constraints, *other.space.bodies)
    root = DuctileJoint(space.static_body, other.bodies[0], (0.0, 0.0), law(strength=RIGID), direction=0.0)
    space.add(*other.bodies, root, *joints[1:])
    space.add(pymunk.PivotJoint(case.bodies[9], other.bodies[9], TIP))
    space.iterations, space.damping = 1, 0.9
    body = load(case, 1000.0, 0.38, -0.2)
    space.add(pymunk.PivotJoint(case.bodies[9], body, TIP))
    for _ in range(400):
        space.step(1 / 60)
    halves = [joint.force[1] for joint in (case.structure.joints[0], root)]
    assert halves[0] == pytest.approx(halves[1], rel=1e-3)
    assert abs(sum(halves)) == pytest.approx(9.81 * (1000.0 + 20e-3), rel=1e-3)
    assert case.bodies[9].position.y == pytest.approx(other.bodies[9].position.y, abs=1e-9)


def test_a_tie_may_come_and_go() -> None:
    """What hung on it falls, and is caught by the next one."""
    case = chain(10)
    tip, body = case.bodies[9], load(case, 10.0, 0.38, -0.2)
    for _ in range(6):
        tie = pymunk.PivotJoint(tip, body, tip.position)
        case.space.add(tie)
        for _ in range(20):
            case.space.step(1 / 60)
        assert body.position.get_distance(tip.position) == pytest.approx(0.2, rel=0.01)
        case.space.remove(tie)
        body.velocity, body.position = (0.0, 0.0), tip.position - (0.0, 0.2)
    assert energy(case.space).numerical >= 0.0
