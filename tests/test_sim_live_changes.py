"""What a pymunk user does to a space that runs: sleep, removal in callbacks, other types of bodies, other spaces."""

import numpy as np
import pymunk
import pytest
from hard_cases import chain, law

from capacity import InputError
from sim import DuctileJoint, SolverError, energy


def is_finite(space: pymunk.Space) -> bool:
    return all(np.isfinite([*b.position, b.angle, *b.velocity, b.angular_velocity]).all() for b in space.bodies)


def drop(space: pymunk.Space, x: float, y: float) -> pymunk.Body:
    ball = pymunk.Body(5.0, 0.1)
    ball.position, ball.velocity = (x, y), (0.0, -5.0)
    shape = pymunk.Circle(ball, 0.05)
    shape.collision_type = 1
    space.add(ball, shape)
    return ball


def test_a_structure_falls_asleep_loses_nothing_and_wakes_when_touched() -> None:
    case = chain(6, shapes=True)
    space = case.space
    space.sleep_time_threshold, space.idle_speed_threshold = 0.3, 0.05
    for _ in range(100):
        space.step(1 / 60)
    assert all(body.is_sleeping for body in case.bodies)
    force, ledger = case.structure.force, case.structure.energy
    for _ in range(50):
        space.step(1 / 60)
    np.testing.assert_array_equal(case.structure.force, force)
    assert case.structure.energy == ledger
    drop(space, 0.2, 0.2)
    for _ in range(3):
        space.step(1 / 60)
    assert not any(body.is_sleeping for body in case.bodies)
    # Of the ball's 66 J.
    assert case.structure.energy.external > 50.0 + ledger.external
    assert case.structure.unconverged == 0


@pytest.mark.parametrize("phase", ["begin", "pre_solve", "post_solve"])
@pytest.mark.parametrize("pieces_too", [False, True])
def test_callbacks_may_take_out_joints_and_pieces(phase: str, pieces_too: bool) -> None:
    case = chain(10, shapes=True)
    space, gone = case.space, set()
    drop(space, 0.3, 0.4)

    def take_out(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:  # noqa: ARG001
        for body in (shape.body for shape in arbiter.shapes):
            if body in case.bodies and body not in gone:
                gone.add(body)
                space.remove(*body.constraints, *((*body.shapes, body) if pieces_too else ()))

    space.on_collision(1, None, **{phase: take_out})
    for _ in range(60):
        space.step(1 / 60)
    assert gone
    assert is_finite(space)
    assert abs(energy(space).gap) < 1e-12 * max(1.0, energy(space).external)


def test_a_body_may_change_its_type() -> None:
    """To kinematic and back; a joint of it asks for the structure anew."""
    case = chain(6)
    space, tip = case.space, case.bodies[-1]
    for kind, speed in ((pymunk.Body.KINEMATIC, 0.1), (pymunk.Body.DYNAMIC, 0.0)):
        tip.body_type, tip.velocity = kind, (0.0, speed)
        if kind == pymunk.Body.DYNAMIC:
            tip.mass, tip.moment = 3.12, 0.001
        for joint in tip.constraints:
            assert isinstance(joint, DuctileJoint)
            joint.ask_for_structure()
        for _ in range(20):
            space.step(1 / 60)
        ledger = energy(space)
        assert abs(ledger.gap) < 1e-12 * ledger.external
        assert ledger.numerical > -1e-12 * ledger.external
        if kind == pymunk.Body.KINEMATIC:
            assert tip.position.y == pytest.approx(0.1 * 19 / 60, abs=0.1 / 60)
    assert is_finite(space)


def test_a_body_of_another_type_is_refused_until_its_structure_is_asked_for() -> None:
    case = chain(6)
    space, tip = case.space, case.bodies[-1]
    space.step(1 / 60)
    tip.body_type = pymunk.Body.STATIC
    before = [body.position for body in case.bodies]
    with pytest.raises(SolverError, match=r"another type than before; .*ask_for_structure"):
        space.step(1 / 60)
    assert [body.position for body in case.bodies] == before
    case.structure.joints[-1].ask_for_structure()
    for _ in range(5):
        space.step(1 / 60)
    assert tip.position == pytest.approx(before[-1], abs=1e-12)
    tip.body_type, tip.mass, tip.moment = pymunk.Body.DYNAMIC, 3.12, 0.001
    with pytest.raises(SolverError, match="another type"):
        space.step(1 / 60)


def test_a_body_that_was_removed_without_its_joints_is_told() -> None:
    """With them it may go, and the rest swings on."""
    case = chain(6)
    space, gone = case.space, case.bodies[3]
    space.step(1 / 60)
    space.remove(gone)
    with pytest.raises(SolverError, match=r"joint [34] .*no longer in the space; take the joint out, too"):
        space.step(1 / 60)
    space.remove(*gone.constraints)
    for _ in range(30):
        space.step(1 / 60)
    assert is_finite(space)
    assert case.bodies[2].position.y > -0.1
    assert case.bodies[4].position.y == pytest.approx(-0.5 * 9.81 * 0.5**2, rel=0.1)


def test_a_joint_to_a_body_of_another_space_is_refused() -> None:
    here, there = pymunk.Space(), pymunk.Space()
    a, b = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    b.position = (1.0, 0.0)
    here.add(a, DuctileJoint(a, b, (0.5, 0.0), law()))
    there.add(b)
    with pytest.raises(InputError, match="not in the space"):
        here.step(1 / 60)


def test_what_a_user_has_called_after_a_step_is_called_for_every_joint() -> None:
    """Also for the one that acts for its structure, whose own end of the step Chipmunk calls in the same way."""
    case = chain(3)
    called: list[int] = []
    for joint in case.structure.joints:
        joint.post_solve = lambda own, _: called.append(own.index)
    case.space.step(1 / 60)
    first = case.structure.energy
    case.space.step(1 / 60)
    assert called == [0, 1, 2, 0, 1, 2]
    assert case.structure.energy != first
