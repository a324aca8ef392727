"""Joints that come, go and come back, and to bodies of any space: they hold, and the ledger has what they brought."""

import itertools
from typing import Any

import numpy as np
import pymunk
import pytest
from bodies import piece

from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER, DuctileJoint, ElasticPlastic, Energy, Limits, Structure, energy
from sim.kernels import layout as at

STRONG = ElasticPlastic((1e7, 1e7, 1e5), (1e6, 1e6, 1e5))
WEAK = ElasticPlastic((1e7, 1e7, 1e5), (1e6, 1e6, 20.0))
WEIGHT = 5.0 * 9.81


def row(space: pymunk.Space, count: int = 4, law: ElasticPlastic = STRONG, **options: object) -> list[DuctileJoint]:
    """Pieces of a metre, clamped at the left."""
    joints: list[DuctileJoint] = []
    before = space.static_body
    for i in range(count):
        body = piece(space, 5.0, 5.0 / 12.0, i + 0.5, 0.0)
        joints.append(DuctileJoint(before, body, (float(i), 0.0), law, **options))  # type: ignore[arg-type]
        before = body
    space.add(*joints)
    return joints


def falling() -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    return space


def rest(space: pymunk.Space) -> None:
    for _ in range(300):
        space.step(1 / 60)


@pytest.mark.parametrize("away", [0, 1, 5])
@pytest.mark.parametrize("with_body", [False, True])
def test_a_joint_that_was_taken_out_holds_when_it_comes_back(away: int, with_body: bool) -> None:
    space = falling()
    *_, last = row(space)
    rest(space)
    assert last.force[2] == pytest.approx(-0.5 * WEIGHT, rel=1e-3)
    taken = (last, last.b) if with_body else (last,)
    space.remove(*taken)
    for _ in range(away):
        space.step(1 / 60)
        assert not any(last.force)
    space.add(*taken)
    rest(space)
    # It hangs where it was made, however far the piece had fallen.
    assert last.force[2] == pytest.approx(-0.5 * WEIGHT, rel=1e-3)
    assert abs(last.b.position.y) < 0.05


def test_what_comes_back_after_others_took_over_is_solved_once() -> None:
    space = falling()
    joints = row(space)
    rest(space)
    space.remove(joints[3])
    other = piece(space, 1.0, 1.0, 1.5, 0.0)
    space.add(DuctileJoint(joints[1].b, other, (1.5, 0.0), STRONG))
    space.step(1 / 60)
    space.add(joints[3])
    rest(space)
    assert joints[3].structure is joints[0].structure
    assert joints[0].force[1] == pytest.approx(-4.0 * WEIGHT - 9.81, rel=1e-3)


def test_a_broken_joint_that_is_added_again_does_nothing() -> None:
    space = falling()
    joints = row(space, law=WEAK, limits=Limits(rotation=0.01))
    rest(space)
    broken = [joint for joint in joints if joint.broken]
    falls = [body.position.y for body in space.bodies]
    assert broken
    space.add(*broken)
    space.step(1 / 60)
    assert not any(any(joint.force) for joint in broken)
    assert all(body.velocity.y < -40.0 and body.position.y < y for body, y in zip(space.bodies, falls, strict=True))


@pytest.mark.parametrize("whose", ["nobody's", "another space's"])
def test_a_static_body_need_not_be_in_the_space(whose: str) -> None:
    other, space = pymunk.Space(), falling()
    ground = other.static_body if whose == "another space's" else pymunk.Body(body_type=pymunk.Body.STATIC)
    body = piece(space, 5.0, 1.0, 0.5, 0.0)
    joint = DuctileJoint(ground, body, (0.0, 0.0), STRONG)
    space.add(joint)
    rest(space)
    assert joint.force[2] == pytest.approx(-0.5 * WEIGHT, rel=1e-3)


@pytest.mark.parametrize("scheme", [IMPLICIT_EULER, AVERAGE_ACCELERATION])
def test_what_is_bent_before_the_first_step_has_its_energy_from_outside(scheme: tuple[float, float]) -> None:
    """½ k θ² of a lever that is turned by hand and let go; no energy comes from nowhere."""
    space, theta, k = pymunk.Space(), 0.1, 50.0
    lever = piece(space, 2.0, 0.5, 0.0, 0.0)
    joint = DuctileJoint(space.static_body, lever, (0.0, 0.0), ElasticPlastic((1e6, 1e6, k), (1e9,) * 3), scheme=scheme)
    space.add(joint)
    lever.angle = theta
    least = 0.0
    for _ in range(100):
        space.step(1 / 1000)
        ledger = energy(space)
        assert ledger.external == pytest.approx(0.5 * k * theta**2, rel=1e-9)
        assert abs(ledger.gap) < 1e-12
        least = min(least, ledger.numerical)
    assert least > (-1e-12 if scheme == IMPLICIT_EULER else -1e-3)
    assert ledger.kinetic > 0.1


def test_what_on_break_raises_comes_out_of_the_step_and_holds_nothing_up() -> None:
    def fail(joint: DuctileJoint) -> None:
        raise RuntimeError(f"broke at {joint.at[0]:g}")

    space = falling()
    joints = row(space, law=WEAK, limits=Limits(rotation=0.01), on_break=fail)
    faults = []
    for _ in range(100):
        try:
            space.step(1 / 60)
        except RuntimeError as fault:
            faults.append(str(fault))
    broken = [joint for joint in joints if joint.broken]
    assert faults == [f"broke at {joint.at[0]:g}" for joint in broken] != []
    assert not set(broken) & set(space.constraints)
    for joint in broken:
        # What it flowed by until it broke, and not how far apart the pieces then flew.
        assert joint.plastic_deformation[3] == pytest.approx(0.01, rel=1e-4)


def test_a_joint_to_a_step_that_never_ends() -> None:
    """Parts of a step are half a millisecond long, and longer where there would be thousands of them."""
    space = falling()
    (joint,) = row(space, 1)
    space.step(1e6)
    assert joint.force[2] == pytest.approx(-0.5 * WEIGHT, rel=1e-3)
    assert joint.structure is not None
    assert joint.structure.newton_steps < 10_000


def test_what_the_user_has_called_after_a_step_stays_when_joints_come() -> None:
    """Also of the joint that acts for its structure in the step in which another one joins it."""
    space = falling()
    joints = row(space, 2)
    told: list[float] = []
    joints[0].post_solve = lambda joint, space: told.append(joint.impulse)
    for _ in range(5):
        space.step(1 / 60)
    space.add(DuctileJoint(joints[1].b, piece(space, 1.0, 1.0, 2.0, 0.0), (2.0, 0.0), STRONG))
    for _ in range(5):
        space.step(1 / 60)
    assert len(told) == 10
    assert all(impulse > 0.0 for impulse in told[1:])


def test_the_body_that_comes_first_in_a_structure_may_leave_while_others_touch() -> None:
    space = falling()
    joints = row(space, 3)
    space.step(1 / 60)
    structure = joints[0].structure
    assert structure is not None
    for body in (joints[0].b, joints[1].b, joints[2].b):
        space.add(pymunk.Poly.create_box(body, (0.9, 0.1)))
    ball = piece(space, 1.0, 0.1, 1.5, 0.1)
    space.add(pymunk.Circle(ball, 0.05))
    first = structure.bodies[0]
    space.remove(*(joint for joint in joints if first in (joint.a, joint.b)), *first.shapes, first)
    for _ in range(10):
        space.step(1 / 60)
    assert ball.position.y > -0.5


def test_joints_are_grouped_before_any_structure_begins_a_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two bars in mid-blow that touch, one of which grows: nothing is solved with a structure that has ended."""
    space = falling()
    joints = row(space, law=WEAK)
    others = row(space, law=WEAK)
    for i, joint in enumerate([*joints, *others]):
        space.add(pymunk.Poly.create_box(joint.b, (1.0, 0.1)))
        joint.b.position += (0.0, 0.1 * (i // 4))
    for i in range(8):
        ball = pymunk.Body(1.0, 0.1)
        ball.position, ball.velocity = (0.5 * i, 0.4 + 0.3 * (i % 3)), (0.0, -5.0)
        space.add(ball, pymunk.Circle(ball, 0.1))
    begun: list[bool] = []
    build = Structure._build

    def watch(structure: Structure, *arguments: Any) -> None:
        alive = {joint.structure for joint in [*joints, *others] if joint.structure is not None}
        begun.append(any(own.tables.control[at.LEADER] for own in alive))
        build(structure, *arguments)

    monkeypatch.setattr(Structure, "_build", watch)
    in_parts = 0
    for k in range(20):
        twig = piece(space, 0.1, 0.1, 4.5, 0.2 * k)
        space.add(DuctileJoint(joints[-1].b, twig, (4.0, 0.0), STRONG))
        space.step(1 / 60)
        assert joints[0].structure is not None
        in_parts += joints[0].structure.tables.control[at.PARTS] > 1
    assert len(begun) > 20
    assert not any(begun)
    assert in_parts > 5


def test_a_structure_that_grows_goes_on_as_it_was() -> None:
    """A twig without weight changes neither the motion after a blow, in parts, nor the ledger."""

    def live(twigs: bool) -> tuple[np.ndarray, Energy]:
        space = falling()
        joints = row(space, law=WEAK)
        ball = piece(space, 20.0, 1.0, 3.5, 0.2)
        ball.velocity = (0.0, -5.0)
        space.add(pymunk.Circle(ball, 0.1), *(pymunk.Poly.create_box(joint.b, (1.0, 0.1)) for joint in joints))
        for k in range(60):
            if twigs and k % 7 == 3:
                end = joints[-1].b
                twig = piece(space, 1e-9, 1e-9, *end.local_to_world((0.5, 0.0)))
                space.add(DuctileJoint(end, twig, twig.position, ElasticPlastic((1.0, 1.0, 1.0), (1e6,) * 3)))
            space.step(1 / 60)
        return np.array([[*joint.b.position, joint.b.angle] for joint in joints]), energy(space)

    (alone, ledger), (grown, same) = live(twigs=False), live(twigs=True)
    assert ledger.plastic > 50.0
    np.testing.assert_allclose(grown, alone, atol=1e-5)
    for name in ("external", "plastic", "contact", "numerical"):
        assert getattr(same, name) == pytest.approx(getattr(ledger, name), rel=1e-4, abs=1e-3), name


def test_the_ledger_goes_on_in_what_breaks_off() -> None:
    """Halves of a bar that is torn share what was lost before, each as it has of its bodies."""
    space = pymunk.Space()
    bodies = [piece(space, 1.0, 1 / 12, i + 0.5, 0.0) for i in range(5)]
    joints = [DuctileJoint(a, b, (i + 1.0, 0.0), WEAK) for i, (a, b) in enumerate(itertools.pairwise(bodies))]
    space.add(*joints)
    bodies[0].apply_impulse_at_local_point((0.0, 50.0))
    for _ in range(60):
        space.step(1 / 60)
    before = energy(space)
    assert min(before.plastic, before.numerical) > 1.0
    space.remove(joints[2])
    space.step(1 / 60)
    halves = [joints[0].structure, joints[3].structure]
    assert halves[0] is not None
    assert halves[1] is not None
    assert halves[0].energy.plastic >= 0.6 * before.plastic
    assert halves[1].energy.plastic >= 0.4 * before.plastic
    after = energy(space)
    assert after.plastic == pytest.approx(before.plastic, rel=0.05)
    assert abs(after.gap) < 1e-12 * before.external


def test_a_structure_that_was_all_taken_out_comes_back_where_it_is() -> None:
    """It knows nothing of the way on which its bodies went without it; also where nothing else is in the space."""
    space = falling()
    joints = row(space)
    space.step(1 / 60)
    space.remove(*joints)
    for _ in range(10):
        space.step(1 / 60)
    strained = joints[0].b.position.y
    space.add(*joints)
    space.step(1 / 60)
    ledger = energy(space)
    # By as much as the first joint yields, which is at 0.1 m.
    assert strained < -0.1
    assert ledger.external > 0.5 * 1e7 * 0.1**2
    assert ledger.numerical >= 0.0
    assert abs(ledger.gap) < 1e-12 * ledger.external
