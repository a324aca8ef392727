"""Hard cases with constraints of pymunk's own at the bodies of structures, and with supports that move."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
from hard_cases import MASS, PIECE, RIGID, Case, chain, law

from sim import DuctileJoint, Structure


def load(case: Case, mass: float, x: float, y: float) -> pymunk.Body:
    """A loose body, 0.1 m across."""
    body = pymunk.Body(mass, mass * 0.1**2 / 6.0)
    body.position = (x, y)
    case.space.add(body)
    case.bodies.append(body)
    return body


def driven() -> Case:
    """A motor turns a loose body at the tip of a free bar of stiff joints, and a gear another one at its middle."""
    case = chain(10, law(1e3), clamped=False, gravity=0.0)
    wheels = [load(case, mass, x, -0.2) for mass, x in ((30.0, 0.38), (0.3, 0.18))]
    gear = pymunk.GearJoint(case.bodies[4], wheels[1], 0.0, 1.0)
    case.space.add(pymunk.SimpleMotor(case.bodies[9], wheels[0], 30.0), gear)
    case.isolated = True
    return case


def sprung() -> Case:
    """A stiff spring with a damper between the tips of two bars, of which one is clamped and the other falls."""
    case = chain(10)
    other = chain(10, clamped=False, gravity=0.0)
    more, joints = other.bodies, other.structure.joints
    other.space.remove(*other.space.constraints, *other.space.bodies)
    for body in more:
        body.position += (0.0, -0.5)
    case.space.add(*more, *joints)
    case.bodies += more
    tip = case.bodies[9]
    case.space.add(pymunk.DampedSpring(tip, more[9], (0.0, 0.0), (0.0, 0.0), 0.4, 1e5, 1e3))
    return case


def hung(mass: float, count: int, piece: float) -> Case:
    """A body hangs on two pivots from the tip of a bar, one pivot beside the other."""
    case = chain(count, law(strength=RIGID), mass=piece)
    tip = case.bodies[-1]
    body = load(case, mass, tip.position.x, -0.3)
    for x in (-0.1, 0.1):
        case.space.add(pymunk.PivotJoint(tip, body, (tip.position.x + x * PIECE, -0.2)))
    return case


def carried() -> Case:
    """A kinematic body swings a bar to and fro by its end, in steps of five lengths by turns."""
    case = chain(20, clamped=False)
    mover = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    case.space.add(mover)
    joint = DuctileJoint(mover, case.bodies[0], (0.0, 0.0), law(), direction=0.0)
    case.space.add(joint)
    case.structure = Structure([*case.structure.joints, joint])

    def act(step: int) -> None:
        mover.velocity = (0.0, 0.5 * math.sin(0.2 * step))
        case.dt = (1 / 60, 1 / 30, 1 / 240, 1 / 100, 1 / 40)[step % 5]

    case.act = act
    return case


CASES: dict[str, Callable[[], Case]] = {
    "motor and gear on stiff joints, no gravity": driven,
    "stiff damped spring between two bars": sprung,
    "312 kg hang on two pivots from the tip": lambda: hung(100.0 * MASS, 20, MASS),
    "312 kg hang so from pieces of 0.1 kg": lambda: hung(100.0 * MASS, 20, 0.1),
    "a support swings, steps of 1/240 to 1/30 s by turns": carried,
}
