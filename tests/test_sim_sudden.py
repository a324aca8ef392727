"""What is set going suddenly, in every way that there is: one answer at any step, and that of short steps."""

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pymunk
import pytest
from frames import frame_scene
from hard_cases import law, momenta
from sudden_cases import BEAM, SIX, loaded_beam, mass_on_hinge, new_space

from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER, DuctileJoint, ElasticPlastic, Model, Structure, assemble
from sim.kernels import layout as at

MASS, SPEED = 50.0, 6.0
Scheme = tuple[float, float]
Way = Callable[[pymunk.Space, float, Scheme], pymunk.Body]


def struck(space: pymunk.Space, dt: float, scheme: Scheme) -> pymunk.Body:  # noqa: ARG001
    """The mass on the tip of a cantilever has a velocity before the first step."""
    body = loaded_beam(space, MASS, scheme)[1]
    body.velocity = (0.0, -SPEED)
    return body


def pushed(space: pymunk.Space, dt: float, scheme: Scheme) -> pymunk.Body:  # noqa: ARG001
    """It is given an impulse before the first step."""
    body = loaded_beam(space, MASS, scheme)[1]
    body.apply_impulse_at_world_point((0.0, -SPEED * MASS), body.position)
    return body


def pushed_later(space: pymunk.Space, dt: float, scheme: Scheme) -> pymunk.Body:
    """It is given an impulse after some steps of rest."""
    body = loaded_beam(space, MASS, scheme)[1]
    for _ in range(3):
        space.step(dt)
    body.apply_impulse_at_local_point((0.0, -SPEED * MASS), (0.0, 0.0))
    return body


def joined_in_flight(space: pymunk.Space, dt: float, scheme: Scheme) -> pymunk.Body:
    """It flies past the tip of a beam at rest, and is joined to it."""
    beam = assemble(BEAM, replace(SIX, scheme=scheme), space, shapes=False)
    tip = beam.nodes["tip"]
    body = pymunk.Body(MASS, MASS * 0.1**2)
    x, y = tip.now()
    body.position, body.velocity = (x, y + 3.0 * dt * SPEED), (0.0, -SPEED)
    space.add(body)
    for _ in range(3):
        space.step(dt)
    rigid = ElasticPlastic((1e9, 1e9, 1e7), (1e9, 1e9, 1e9))
    space.add(DuctileJoint(tip.body, body, tuple(tip.now()), rigid, direction=0.0, scheme=scheme))
    return body


def thrown_frame(space: pymunk.Space, dt: float, scheme: Scheme) -> pymunk.Body:  # noqa: ARG001
    """All pieces of a frame have a velocity before the first step."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (0.0, 1.0, "free"), "C": (1.0, 1.0, "free"), "D": (1.0, 0.0, "clamped")}
    members = [("A", "B"), ("B", "C"), ("D", "C")]
    scene = frame_scene(nodes, members, "[simulation]\nduration = 1.0", section="rectangle 50x20 mm")
    frame = assemble(scene, Model("lobatto", 5, "fibre", fibres=8, scheme=scheme), space, shapes=False)
    for piece in frame.pieces:
        piece.body.velocity = (20.0, 0.0)
    return frame.nodes["B"].body


def bent(way: Way, rate: int, scheme: Scheme) -> tuple[float, float]:
    """Plastic work [J], and how far the body goes within a quarter of a second [m]."""
    space = new_space(10, 0.0)
    body = way(space, 1.0 / rate, scheme)
    start, furthest = body.position, 0.0
    joints = [c for c in space.constraints if isinstance(c, DuctileJoint)]
    for _ in range(rate // 4):
        space.step(1.0 / rate)
        furthest = max(furthest, (body.position - start).length)
    return sum(float(joint.dissipated) for joint in joints), furthest


WAYS = (struck, pushed, pushed_later, joined_in_flight, thrown_frame)


@pytest.mark.parametrize("scheme", [IMPLICIT_EULER, AVERAGE_ACCELERATION])
@pytest.mark.parametrize("way", WAYS)
def test_velocities_that_come_suddenly_do_the_same_work_at_any_step(way: Way, scheme: Scheme) -> None:
    """Within 5 % from 1/60 to 1/1000 s, and of steps of a tenth of a millisecond of the second-order scheme."""
    found = np.array([bent(way, rate, scheme)[0] for rate in (60, 240, 1000)])
    assert found.max() / found.min() <= 1.05
    assert found == pytest.approx(bent(way, 10_000, AVERAGE_ACCELERATION)[0], rel=0.05)


def free_bar(space: pymunk.Space) -> tuple[list[pymunk.Body], Structure]:
    """Ten pieces of a weak bar of 1 m that nothing holds, some way from the origin."""
    bodies = []
    for i in range(10):
        body = pymunk.Body(0.6, 0.6 * 0.1**2 / 12.0)
        body.position = (2.0 + (i + 0.5) * 0.1, 0.3)
        bodies.append(body)
    joints = [
        DuctileJoint(a, b, (b.position.x - 0.05, 0.3), law(strength=0.1), direction=0.0)
        for a, b in itertools.pairwise(bodies)
    ]
    structure = Structure(joints)
    space.add(*bodies, *joints)
    return bodies, structure


def test_a_free_bar_is_struck_in_parts_and_keeps_its_momenta() -> None:
    """An impulse across its end; to rounding as read between the steps, and the same plastic work at any step."""
    works = []
    for rate in (60, 240, 1000):
        space = new_space(10, 0.0)
        bodies, structure = free_bar(space)
        bodies[0].apply_impulse_at_world_point((1.0, 8.0), bodies[0].position)
        before, size = momenta(bodies)
        in_parts = False
        for _ in range(rate // 4):
            space.step(1.0 / rate)
            in_parts |= structure.tables.control[at.PARTS] > 1
            now, _ = momenta(bodies)
            np.testing.assert_allclose(now, before, atol=1e-13 * size)
        assert in_parts
        assert structure.unconverged == 0
        works.append(float(structure.dissipated.sum()))
    assert max(works) <= 1.05 * min(works)


def test_what_moves_a_free_bar_as_a_whole_is_not_sudden() -> None:
    """Gravity, and velocities of a rigid turn."""
    space = new_space(10)
    bodies, structure = free_bar(space)
    for body in bodies:
        body.velocity, body.angular_velocity = (1.0, 0.5 * (body.position.x - 2.0)), 0.5
    for _ in range(3):
        space.step(1 / 60)
        assert structure.tables.control[at.PARTS] == 1


def test_a_sudden_force_does_the_same_work_in_steps_as_short_as_parts() -> None:
    """C6-sdof-step with a fibre section, which steps of 25 µs without damping find to take 93.9 J."""
    assert [mass_on_hinge(rate, 10)[0] for rate in (60, 4000)] == pytest.approx([93.9] * 2, rel=0.03)


def test_a_swing_about_rest_is_over_when_it_has_swung_back() -> None:
    """A load is gone: the bar swings to the other side and back in parts of steps, and in whole ones from then on."""
    space = new_space(2, 9.81)
    loaded_beam(space, MASS, IMPLICIT_EULER)
    for _ in range(400):
        space.step(1 / 60)
    space.gravity = (0.0, 0.0)
    (structure,) = {joint.structure for joint in space.constraints if isinstance(joint, DuctileJoint)}
    assert structure is not None
    parts = []
    for _ in range(120):
        space.step(1 / 60)
        parts.append(int(structure.tables.control[at.PARTS]))
    assert parts[0] > 1
    assert set(parts[60:]) == {1}
