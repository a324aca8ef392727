"""Spaces with joints, pickled, copied and resumed; the same run in another process."""

import hashlib
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymunk
import pytest
from hard_cases import MASS, Case, chain, falls_on_the_ground, law, rests, struck

from capacity import InputError
from sim import AVERAGE_ACCELERATION, DuctileJoint, Limits
from sim.kernels import layout as at


def trajectory(space: pymunk.Space, steps: int = 60, dt: float = 1 / 240) -> bytes:
    """Where all bodies are and how they move after each step, to the last bit."""
    rows = []
    for _ in range(steps):
        space.step(dt)
        rows.append([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])
    return np.array(rows).tobytes()


def yielding() -> Case:
    case = chain(12, law(strength=0.02))
    case.bodies[-1].velocity = (0.0, -20.0)
    return case


def breaking() -> Case:
    case = chain(8, law(strength=0.02), limits=Limits(rotation=0.02))
    case.bodies[-1].velocity = (0.0, -30.0)
    return case


def undamped() -> Case:
    case = yielding()
    case.structure.scheme = AVERAGE_ACCELERATION
    return case


@pytest.mark.parametrize("build", [yielding, breaking, undamped])
def test_a_saved_run_goes_on_to_the_last_bit(build: type[Case]) -> None:
    case = build()
    trajectory(case.space, 20)
    saved, copied = pickle.dumps(case.space), case.space.copy()
    on = trajectory(case.space)
    assert trajectory(pickle.loads(saved)) == on
    assert trajectory(copied) == on
    # The copy is a space of its own.
    joint = next(iter(copied.constraints))
    assert isinstance(joint, DuctileJoint)
    assert joint.structure is not case.structure


def test_what_pymunk_finds_anew_from_where_bodies_are_is_saved() -> None:
    """The distance of a pin joint that is stretched, and where a ratchet has got to."""
    case = chain(4, law(strength=0.01))
    bob = pymunk.Body(20.0, 1.0)
    bob.position = (0.5, -0.3)
    case.space.add(bob, pymunk.PinJoint(case.bodies[-1], bob), pymunk.RatchetJoint(case.bodies[0], bob, 0.0, 0.3))
    bob.angular_velocity = 8.0
    trajectory(case.space, 20)
    saved = pickle.dumps(case.space)
    assert trajectory(pickle.loads(saved)) == trajectory(case.space)


def test_what_is_left_when_all_joints_have_broken_goes_on_to_the_last_bit() -> None:
    """Pieces that lie on each other and on the ground, as pymunk alone does not save them."""
    case = chain(8, law(strength=1e-3), limits=Limits(rotation=1e-3, slip=1e-4), shapes=True)
    for shape in case.space.shapes:
        shape.filter = pymunk.ShapeFilter()
    ground = pymunk.Segment(case.space.static_body, (-5.0, -0.3), (5.0, -0.3), 0.1)
    ground.friction = 0.5
    case.space.add(ground)
    for k, body in enumerate(case.bodies):
        body.velocity, body.angular_velocity = (0.0, -2.0 * (-1) ** k), 20.0
    trajectory(case.space, 100)
    assert not case.space.constraints
    saved = pickle.dumps(case.space)
    assert trajectory(pickle.loads(saved)) == trajectory(case.space)


def test_a_step_of_another_length_after_a_contact_is_the_same_in_a_resumed_run() -> None:
    """Bodies that touched something in the last step are not moved on, though nothing touches them any more."""
    case = rests(10.0, MASS)
    trajectory(case.space, 30, 1 / 60)
    assert case.structure.tables.control[at.CONTACTS] > 0
    resumed = pickle.loads(pickle.dumps(case.space))
    found = []
    for space in (case.space, resumed):
        box = list(space.bodies)[-1]
        box.position += (0.0, 5.0)
        found.append(trajectory(space, 5, 1 / 100))
    assert found[0] == found[1]


def test_what_a_structure_has_been_through_is_saved() -> None:
    case = yielding()
    trajectory(case.space, 20)
    joint = list(pickle.loads(pickle.dumps(case.space)).constraints)[3]
    assert isinstance(joint, DuctileJoint)
    old, new = case.structure, joint.structure
    assert new is not None
    assert new.energy == old.energy
    assert new.energy.plastic > 0.0
    np.testing.assert_array_equal(new.plastic_deformation, old.plastic_deformation)
    np.testing.assert_array_equal(new.force, old.force)
    assert (new.newton_steps, new.residual) == (old.newton_steps, old.residual)


def bouncing() -> Case:
    return falls_on_the_ground(0.9)


def swinging() -> Case:
    """Stock constraints beside the joints: what hangs from the bar's tip, and a motor."""
    case = chain(6)
    tip = case.bodies[-1]
    a, b = pymunk.Body(2.0, 0.1), pymunk.Body(3.0, 0.2)
    x, y = tip.position
    a.position, b.position = (x, y - 0.3), (x + 0.2, y - 0.5)
    case.space.add(a, b, pymunk.PivotJoint(tip, a, tip.position), pymunk.SlideJoint(a, b, (0, 0), (0, 0), 0.1, 0.3))
    case.space.add(pymunk.GearJoint(tip, a, 0.0, 1.0), pymunk.SimpleMotor(a, b, 2.0))
    return case


@pytest.mark.parametrize("build", [lambda: rests(500.0, 3.12), bouncing, lambda: struck(10.0), swinging])
def test_contacts_and_stock_constraints_go_on_to_the_last_bit(build: type[Case]) -> None:
    case = build()
    trajectory(case.space, 40)
    saved, copied = pickle.dumps(case.space), case.space.copy()
    on = trajectory(case.space)
    assert trajectory(pickle.loads(saved)) == on
    assert trajectory(copied) == on


def test_joints_that_no_step_has_seen_can_be_saved() -> None:
    case = chain(3)
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    space.add(body, DuctileJoint(space.static_body, body, (0.0, 0.0), law(), direction=0.0))
    again = pickle.loads(pickle.dumps(space))
    assert trajectory(again, 3) == trajectory(space, 3)
    assert trajectory(case.space.copy(), 3) == trajectory(case.space, 3)


RUN = """
import hashlib, pickle, sys
from hard_cases import rests, struck
from test_sim_saving import breaking, trajectory
spaces = [case.space for case in (breaking(), rests(500.0, 3.12), struck(10.0))]
for space in [*spaces, pickle.load(sys.stdin.buffer)]:
    print(hashlib.sha256(trajectory(space)).hexdigest())
"""


def test_another_process_comes_to_the_same_bytes() -> None:
    """From the start, and from where a run was saved."""
    begun = bouncing().space
    trajectory(begun, 40)
    out = subprocess.run(
        [sys.executable, "-c", RUN],
        cwd=Path(__file__).parent,
        input=pickle.dumps(begun),
        check=True,
        capture_output=True,
        timeout=300,
    ).stdout.decode()
    spaces = (breaking().space, rests(500.0, 3.12).space, struck(10.0).space, begun)
    assert out.split() == [hashlib.sha256(trajectory(space)).hexdigest() for space in spaces]


def test_a_joint_takes_less_than_two_kilobytes() -> None:
    """All that the solver allocates for a chain: what its arrays hold for a thousand joints more."""
    sizes = []
    for count in (200, 1200):
        tables = chain(count).structure.tables
        own = [value for value in vars(tables).values() if isinstance(value, np.ndarray)]
        sizes.append(sum(array.nbytes for array in [*tables._arrays.values(), *own]))
    assert (sizes[1] - sizes[0]) / 1000 < 2000.0


def test_a_space_with_a_spatial_hash_is_not_saved_without_a_word() -> None:
    """pymunk would resume it with trees, in which Chipmunk comes upon contacts in another order."""
    space = chain(3, shapes=True).space
    space.use_spatial_hash(0.1, 100)
    space.step(1 / 240)
    with pytest.raises(InputError, match=r"space: it uses a spatial hash.*make it without use_spatial_hash\(\)"):
        pickle.dumps(space)
