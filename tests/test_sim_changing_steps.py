"""Steps of another length than the last one, in the midst of what happens: nothing is created by the change."""

import pymunk
import pytest
from hard_cases import MASS, chain, largest, law

from sim import DuctileJoint, Structure


def kinetic(space: pymunk.Space) -> float:
    """Of all bodies [J]."""
    return sum(0.5 * (b.mass * b.velocity.length**2 + b.moment * b.angular_velocity**2) for b in space.bodies)


def throw(space: pymunk.Space, mass: float, speed: float, x: float) -> pymunk.Body:
    """A ball that comes down on a bar of 100 mm along x."""
    ball = pymunk.Body(mass, mass * 0.05**2 / 2.0)
    ball.position, ball.velocity = (x, 0.1001), (0.0, -speed)
    space.add(ball, pymunk.Circle(ball, 0.05))
    return ball


@pytest.mark.parametrize("ratio", [0.1, 0.2, 0.5])
def test_a_step_of_another_length_after_one_in_parts_strains_no_joint(ratio: float) -> None:
    """A ball has struck a soft bar that nothing holds, which bends: what both have does not become more."""
    case = chain(8, law(1e-4), clamped=False, gravity=0.0, shapes=True)
    throw(case.space, 5.0, 20.0, 0.14)
    case.space.step(1 / 100)
    had = kinetic(case.space) + case.structure.energy.elastic
    assert case.structure.energy.elastic > 0.05 * had
    case.space.step(ratio / 100)
    assert kinetic(case.space) + case.structure.energy.elastic <= had
    assert case.structure.energy.numerical >= -1e-12 * largest(case.structure.energy)


def test_damped_joints_keep_to_their_bending_stiffness_when_a_step_is_shorter() -> None:
    """They are stiff, and bear a little when a ball strikes: what the bar gets, the ball has lost."""
    case = chain(6, law(1e5), clamped=False, gravity=0.0, shapes=True)
    slow = [5e-4 * k for k in case.structure.joints[0].law.elastic_tangent()]
    damping = slow[0], slow[3], slow[5]
    old = case.structure.joints
    joints = [DuctileJoint(j.a, j.b, j.at, j.law, direction=0.0, damping=damping) for j in old]
    case.space.remove(*old)
    case.space.add(*joints)
    structure = Structure(joints)
    ball = throw(case.space, 50.0 * MASS, 5.0, 0.03)
    ball.position += (0.0, 1.5e-3)
    for h in (1e-4, 1e-4, 0.7e-4, 0.5e-4, 1e-4):
        case.bodies[0].apply_force_at_local_point((0.0, 1.0))
        had = kinetic(case.space)
        case.space.step(h)
        assert kinetic(case.space) <= had * (1.0 + 1e-9)
    assert structure.energy.kinetic > 10.0
