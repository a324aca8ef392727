"""Joints that share bodies find each other, and part again; what else is in their space."""

import itertools

import numpy as np
import pymunk
import pytest
from bodies import piece

from sim import DuctileJoint, ElasticPlastic, Limits

LAW = ElasticPlastic((1e6, 1e6, 1e4), (1e4, 1e4, 1e3))


def row(space: pymunk.Space, count: int, y: float = 0.0) -> tuple[list[pymunk.Body], list[DuctileJoint]]:
    """Pieces of 1 m in a row and the joints between them, unsupported."""
    bodies = [piece(space, 1.0, 1 / 12, i + 0.5, y) for i in range(count)]
    return bodies, [DuctileJoint(a, b, (i + 1.0, y), LAW) for i, (a, b) in enumerate(itertools.pairwise(bodies))]


def test_joints_that_share_bodies_form_one_structure_by_themselves() -> None:
    space = pymunk.Space()
    bodies, joints = row(space, 4)
    others, other_joints = row(space, 3, y=5.0)
    space.add(*joints, *other_joints)
    assert joints[0].structure is None
    space.step(1 / 60)
    assert {j.structure for j in joints} == {joints[0].structure}
    assert {j.structure for j in other_joints} == {other_joints[0].structure}
    assert joints[0].structure is not other_joints[0].structure
    bridge = DuctileJoint(bodies[3], others[0], (3.5, 2.5), LAW)
    space.add(bridge)
    space.step(1 / 60)
    assert len({j.structure for j in [*joints, *other_joints, bridge]}) == 1


def test_static_bodies_do_not_join_structures() -> None:
    space = pymunk.Space()
    joints = []
    for i in range(2):
        body = piece(space, 1.0, 1.0, 3.0 * i, 0.0)
        joints.append(DuctileJoint(space.static_body, body, (3.0 * i, 1.0), LAW))
    space.add(*joints)
    space.step(1 / 60)
    assert joints[0].structure is not joints[1].structure


def test_a_structure_keeps_its_plastic_state_when_it_grows() -> None:
    space = pymunk.Space()
    bodies, joints = row(space, 3)
    joints.append(DuctileJoint(space.static_body, bodies[0], (0.0, 0.0), LAW))
    space.add(*joints)
    bodies[2].apply_impulse_at_local_point((0.0, 60.0))
    for _ in range(120):
        space.step(1 / 60)
    bent = [joint.plastic_deformation for joint in joints]
    assert max(max(values) for values in bent) > 1e-3
    force = [joint.force for joint in joints]
    new = piece(space, 1.0, 1 / 12, *bodies[2].local_to_world((1.0, 0.0)), bodies[2].angle)
    space.add(DuctileJoint(bodies[2], new, bodies[2].local_to_world((0.5, 0.0)), LAW))
    space.step(1 / 60)
    for joint, values, before in zip(joints, bent, force, strict=True):
        np.testing.assert_allclose(joint.plastic_deformation, values, rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(joint.force, before, rtol=1e-2, atol=5.0)


def test_stock_constraints_work_beside_joints() -> None:
    """A motor turns a jointed row at its own rate, whatever the joints bear."""
    space = pymunk.Space()
    space.iterations = 30
    bodies, joints = row(space, 3)
    pivot = pymunk.PivotJoint(space.static_body, bodies[0], (0.0, 0.0))
    motor = pymunk.SimpleMotor(space.static_body, bodies[0], -1.0)
    space.add(*joints, pivot, motor)
    for _ in range(240):
        space.step(1 / 240)
    assert bodies[0].angular_velocity == pytest.approx(1.0, rel=1e-3)
    assert bodies[2].angular_velocity == pytest.approx(1.0, rel=2e-2)


def test_constraints_elsewhere_change_nothing() -> None:
    """Not what a structure does alone, nor how it lets go of a joint that a stock constraint takes the place of."""

    def positions(crowded: bool) -> bytes:
        space = pymunk.Space()
        space.gravity = (0.0, -10.0)
        if crowded:
            far = [piece(space, 1.0, 1.0, x, 99.0) for x in (0.0, 1.0)]
            space.add(pymunk.PinJoint(*far))
        bodies, joints = row(space, 3)
        space.add(DuctileJoint(space.static_body, bodies[0], (0.0, 0.0), LAW), *joints)
        found = b""
        for k in range(60):
            if k == 30:
                space.remove(joints[0])
                space.add(pymunk.PivotJoint(bodies[0], bodies[1], (1.0, 0.0)))
            space.step(1 / 60)
            found += np.array([body.position for body in bodies]).tobytes()
        return found

    assert positions(crowded=False) == positions(crowded=True)


def test_a_structure_falls_asleep_and_wakes_up() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    space.sleep_time_threshold = 1.0
    bodies, joints = row(space, 3)
    joints.append(DuctileJoint(space.static_body, bodies[0], (0.0, 0.0), LAW))
    space.add(*joints)
    for _ in range(240):
        space.step(1 / 60)
    assert all(body.is_sleeping for body in bodies)
    held = bodies[2].position
    bodies[2].activate()
    for _ in range(6):
        space.step(1 / 60)
    assert not bodies[0].is_sleeping
    assert bodies[2].position.get_distance(held) < 1e-4


def test_a_torn_row_becomes_two_structures() -> None:
    """A row hung by its first joint is torn in two; the two halves are two structures and fly apart freely."""
    space = pymunk.Space()
    bodies, joints = row(space, 4)
    told: list[DuctileJoint] = []
    weak = ElasticPlastic((1e6, 1e6, 1e4), (100.0, 1e4, 1e3))
    joints[1] = DuctileJoint(
        bodies[1], bodies[2], (2.0, 0.0), weak, limits=Limits(elongation=0.05), on_break=told.append
    )
    space.add(*joints)
    for body in bodies[2:]:
        body.velocity = (10.0, 0.0)
    for _ in range(30):
        space.step(1 / 60)
    assert told == [joints[1]]
    assert joints[1].broken
    assert joints[1] not in space.constraints
    assert joints[1].capacity_used == 1.0
    assert joints[1].force == (0.0, 0.0, 0.0)
    assert joints[0].structure is not joints[2].structure
    assert not joints[0].broken
    momentum = sum(body.mass * body.velocity.x for body in bodies)
    assert momentum == pytest.approx(20.0, rel=1e-12)
    # The joint took N p_lim and its elastic stretch; implicit Euler damps what the halves then vibrate with.
    assert joints[1].dissipated == pytest.approx(100.0 * 0.05, rel=0.01)
    lost = 100.0 - sum(0.5 * body.mass * body.velocity.length**2 for body in bodies)
    assert 0.99 * 5.0 <= lost <= 1.1 * 5.0
