"""Saved and resumed to the last bit: loose bodies that touch each other, bodies that sleep, vehicles."""

import gc
import hashlib
import itertools
import pickle
import random
import subprocess
import sys
import weakref
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pymunk
import pytest
from hard_cases import chain, law

from sim import DuctileJoint


def trajectory(space: pymunk.Space, steps: int) -> bytes:
    """Where all bodies are and how they move after each step, and who sleeps, to the last bit."""
    rows = []
    for _ in range(steps):
        space.step(1 / 120)
        rows.append([(*b.position, b.angle, *b.velocity, b.angular_velocity, b.is_sleeping) for b in space.bodies])
    return np.array(rows).tobytes()


def ground(space: pymunk.Space) -> None:
    line = pymunk.Segment(space.static_body, (-5.0, -1.0), (5.0, -1.0), 0.1)
    line.friction = 0.8
    space.add(line)


def pile() -> pymunk.Space:
    """Boxes and balls that fall on a clamped bar and off it; some others were there and are gone."""
    case, draw = chain(20, shapes=True), random.Random(5)
    space = case.space
    space.gravity = (0.0, -9.81)
    ground(space)
    gone = [pymunk.Body(1.0, 1.0) for _ in range(5)]
    space.add(*gone, *(pymunk.Circle(body, 0.1) for body in gone))
    for k in range(14):
        body = pymunk.Body(2.0, 0.02)
        body.position, body.angle = (draw.uniform(-0.3, 0.6), 0.2 + 0.22 * k), draw.uniform(-1.0, 1.0)
        shape = pymunk.Poly.create_box(body, (0.2, 0.2)) if k % 3 else pymunk.Circle(body, 0.1)
        shape.friction, shape.elasticity = 0.5, 0.2
        space.add(body, shape)
    space.step(1 / 120)
    space.remove(*gone, *(shape for body in gone for shape in body.shapes))
    return space


def pile_asleep() -> pymunk.Space:
    """Another one, in which bodies fall asleep one after another, and are struck later."""
    space = pile()
    space.sleep_time_threshold, space.idle_speed_threshold = 0.2, 0.5
    for side in (-1.0, 1.0):
        ball = pymunk.Body(5.0, 0.1)
        ball.position = (0.3 * side, 25.0)
        space.add(ball, pymunk.Circle(ball, 0.15))
    return space


def vehicle() -> pymunk.Space:
    """Wheels on motors and springs, on a cantilever; one of its constraints was taken out on the way."""
    space = chain(30, shapes=True).space
    space.gravity = (0.0, -9.81)
    ground(space)
    chassis = pymunk.Body(40.0, 4.0)
    chassis.position = (0.5, 0.35)
    space.add(chassis, pymunk.Poly.create_box(chassis, (0.5, 0.1)))
    for k, x in enumerate((-0.2, 0.2)):
        wheel = pymunk.Body(5.0, 0.03)
        wheel.position = (0.5 + x, 0.17)
        tyre = pymunk.Circle(wheel, 0.1)
        tyre.friction = 0.9
        space.add(wheel, tyre, pymunk.GrooveJoint(chassis, wheel, (x, -0.1), (x, -0.3), (0.0, 0.0)))
        space.add(pymunk.DampedSpring(chassis, wheel, (x, 0.0), (0.0, 0.0), 0.18, 8e3, 200.0))
        brake = pymunk.GearJoint(chassis, wheel, 0.0, 1.0)
        space.add(brake, pymunk.SimpleMotor(wheel, chassis, 8.0))
        if k == 0:
            space.step(1 / 120)
        space.remove(brake)
    return space


@pytest.mark.parametrize(("build", "saved_at"), [(pile, (30, 90)), (pile_asleep, (90, 230)), (vehicle, (60,))])
def test_what_touches_and_what_sleeps_goes_on_to_the_last_bit(
    build: Callable[[], pymunk.Space], saved_at: tuple[int, ...]
) -> None:
    space, passed, course, later = build(), 0, b"", []
    for step in saved_at:
        course += trajectory(space, step - passed)
        passed = step
        saved, copied = pickle.dumps(space), space.copy()
        resumed = pickle.loads(saved)
        assert [b.is_sleeping for b in resumed.bodies] == [b.is_sleeping for b in space.bodies]
        on = trajectory(resumed, 150)
        assert trajectory(copied, 150) == on
        assert trajectory(pickle.loads(pickle.dumps(pickle.loads(saved))), 150) == on
        later.append((len(course), on))
    # The space itself goes on like them, and none of this has touched it.
    course += trajectory(space, 150)
    for start, on in later:
        assert course[start : start + len(on)] == on
    assert trajectory(build(), passed + 150) == course


def test_bodies_sleep_and_wake_in_what_is_compared() -> None:
    space, sleeping = pile_asleep(), []
    for _ in range(10):
        trajectory(space, 40)
        sleeping.append(sum(body.is_sleeping for body in space.bodies))
    assert max(sleeping) > 8
    assert any(later < earlier for earlier, later in itertools.pairwise(sleeping))


RUN = """
import hashlib, pickle, sys
from test_sim_saving_contacts import trajectory
for _ in range(2):
    print(hashlib.sha256(trajectory(pickle.load(sys.stdin.buffer), 150)).hexdigest())
"""


def test_another_process_goes_on_to_the_last_bit() -> None:
    spaces = [pile(), pile_asleep()]
    for space in spaces:
        trajectory(space, 150)
    out = subprocess.run(
        [sys.executable, "-c", RUN],
        cwd=Path(__file__).parent,
        input=b"".join(map(pickle.dumps, spaces)),
        check=True,
        capture_output=True,
        timeout=300,
    ).stdout.decode()
    assert out.split() == [hashlib.sha256(trajectory(space, 150)).hexdigest() for space in spaces]


class Level(pymunk.Space):
    """A space of a user's own."""

    def __init__(self, threaded: bool = False) -> None:
        super().__init__(threaded)
        self.score = 0


def test_a_space_of_a_users_own_class_is_saved_with_its_own_things() -> None:
    space = Level()
    space.gravity, space.collision_slop, space.score = (0.0, -9.81), 1e-3, 7
    ground(space)
    plank, boxes = pymunk.Body(20.0, 2.0), [pymunk.Body(2.0, 0.02) for _ in range(6)]
    joint = DuctileJoint(space.static_body, plank, (-0.5, 0.0), law(strength=0.02), direction=0.0)
    space.add(plank, pymunk.Poly.create_box(plank, (1.0, 0.05)), joint)
    for k, box in enumerate(boxes):
        box.position, box.angle = (0.1 * (k % 3) - 0.1, 0.2 + 0.22 * k), 0.3 * k
        space.add(box, pymunk.Poly.create_box(box, (0.2, 0.2)))
    trajectory(space, 60)
    resumed = pickle.loads(pickle.dumps(space))
    assert type(resumed) is Level
    assert resumed.score == 7
    assert trajectory(resumed, 60) == trajectory(space, 60)


def test_a_space_with_a_structure_asleep_can_be_let_go() -> None:
    """Bodies that no shape holds up, which pymunk would wake when their space is gone."""
    case = chain(6)
    space = case.space
    space.sleep_time_threshold, space.gravity = 0.1, (0.0, 0.0)
    trajectory(space, 60)
    assert all(body.is_sleeping for body in case.structure.bodies if body.body_type == pymunk.Body.DYNAMIC)
    gone = weakref.ref(space)
    del space, case
    gc.collect()
    assert gone() is None
