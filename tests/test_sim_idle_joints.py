"""Joints that another one acts for are not gone through in Chipmunk's iterations, and are back when a step ends."""

import math

import pymunk
import pytest
from hard_cases import Case, chain, law

from sim import DuctileJoint, Limits, SolverError, Structure, chipmunk
from sim.chipmunk import CONSTRAINTS_OF_SPACE


def struck(**of_joints: Limits) -> Case:
    """A bar under a ball that is about to strike it, so that steps are taken in parts and Python is asked in them."""
    case = chain(8, law(strength=0.05), shapes=True, **of_joints)
    ball = pymunk.Body(8.0, 0.01)
    ball.position, ball.velocity = case.bodies[6].position + pymunk.Vec2d(0.0, 0.2), (0.0, -15.0)
    case.space.add(ball, pymunk.Circle(ball, 0.05))
    case.bodies.append(ball)
    return case


def listed(space: pymunk.Space) -> list[int]:
    """Addresses of the constraints that Chipmunk goes through."""
    return [int(one) for one in chipmunk.listed(space, CONSTRAINTS_OF_SPACE)]


def seen_by_python(case: Case, monkeypatch: pytest.MonkeyPatch, steps: int) -> set[int]:
    """How many constraints there were to go through whenever the kernels asked Python for something."""
    seen: set[int] = set()
    told = Structure.told

    def look(structure: Structure) -> None:
        seen.add(len(listed(case.space)))
        told(structure)

    monkeypatch.setattr(Structure, "told", look)
    for _ in range(steps):
        case.space.step(1 / 60)
    return seen


def test_one_joint_is_gone_through_while_a_structure_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    case = struck()
    before = listed(case.space)
    assert seen_by_python(case, monkeypatch, 3) == {1, 8}
    assert listed(case.space) == before


def add_others(case: Case) -> None:
    """Beside the bar, bodies on pivots of pymunk's own and on another structure's joints, before and after its own."""
    space, joints = case.space, case.structure.joints
    space.remove(*joints)
    bodies = [pymunk.Body(1.0, 1.0) for _ in range(4)]
    for body, place in zip(bodies, [(3.0, 3.0), (-3.0, 3.0), (-4.0, 3.0), (3.0, 6.0)], strict=True):
        body.position = place
    hung = [pymunk.PivotJoint(space.static_body, bodies[i], (2.0, bodies[i].position.y)) for i in (0, 3)]
    beside = DuctileJoint(space.static_body, bodies[1], (-2.0, 3.0), law(0.05))
    space.add(*bodies, hung[0], *joints, beside, hung[1], DuctileJoint(bodies[1], bodies[2], (-3.5, 3.0), law(0.05)))


def test_all_others_are_gone_through_too_each_in_its_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """What acts for two structures, and constraints of pymunk's own; what users have called is called once for each."""
    case = struck()
    add_others(case)
    before, called = listed(case.space), []
    for one in case.space.constraints:
        one.post_solve = lambda own, _: called.append(chipmunk.address(own._constraint))
    assert seen_by_python(case, monkeypatch, 3) == {4, 12}
    assert called == 3 * before
    assert listed(case.space) == before


def test_all_are_back_after_a_step_that_was_refused() -> None:
    case = struck()
    for _ in range(2):
        case.space.step(1 / 60)
    before = listed(case.space)
    case.bodies[4].force = (math.inf, 0.0)
    with pytest.raises(SolverError):
        case.space.step(1 / 60)
    assert listed(case.space) == before


def test_all_that_hold_are_back_after_a_step_in_which_joints_broke() -> None:
    case = struck(limits=Limits(rotation=1e-3))
    for _ in range(3):
        case.space.step(1 / 60)
    holding = [joint for joint in case.structure.joints if not joint.broken]
    assert 0 < len(holding) < 8
    assert sorted(listed(case.space)) == sorted(chipmunk.address(joint._constraint) for joint in holding)
