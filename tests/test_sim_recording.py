"""Recordings: times, poses, forces, contacts and peaks as the space had them."""

import math

import numpy as np
import pymunk
import pytest
from replay_runs import DEPTH, LENGTH, PIECES, SECTION, STEEL, cantilever, falling_ball, world

from capacity import capacity
from sim import DuctileJoint, ElasticPlastic, Limits
from sim.recording import Recorder, Recording


@pytest.fixture(scope="module")
def recording() -> Recording:
    return falling_ball()


def test_samples_are_an_even_time_apart_at_any_step() -> None:
    for dt in (1 / 60, 1 / 240, 1 / 1000, 0.0007):
        space = pymunk.Space()
        recorder = Recorder(space, every=1 / 30)
        for _ in range(math.ceil(1.0 / dt)):
            space.step(dt)
            recorder.sample()
        time = recorder.finish().time
        assert len(time) in (31, 32)
        wanted = np.arange(31) / 30
        assert np.all((time[:31] >= wanted - 1e-9) & (time[:31] < wanted + dt))


def test_a_step_longer_than_the_period_gives_one_sample_each() -> None:
    space = pymunk.Space()
    recorder = Recorder(space, every=0.01)
    for _ in range(4):
        space.step(0.05)
        recorder.sample()
    np.testing.assert_allclose(recorder.finish().time, [0.0, 0.05, 0.1, 0.15, 0.2])


def test_a_period_that_is_no_time_is_refused() -> None:
    for every in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="positive time"):
            Recorder(pymunk.Space(), every)


def test_a_resting_cantilever_shows_the_forces_of_statics() -> None:
    """Root of a cantilever under own weight: Q = q L, M = -q L² / 2; half a piece's length sags less."""
    space = world()
    cantilever(space)
    recorder = Recorder(space, every=0.1)
    for _ in range(600):
        space.step(1 / 60)
        recorder.sample()
    recording = recorder.finish("rest")
    q = STEEL.density * SECTION.area * 9.81
    np.testing.assert_allclose(recording.force[-1, 0, 1:], [-q * LENGTH, -q * LENGTH**2 / 2], rtol=1e-3)
    assert recording.utilisation[-1, 0, 2] == pytest.approx(q * LENGTH**2 / 2 / recording.joints[0].maxima[2], rel=1e-3)
    assert np.all(recording.utilisation <= 1.0 + 1e-12)
    assert np.all(recording.peak >= np.abs(recording.force).max(axis=0))
    assert not recording.broken.any()
    assert recording.contacts.start[-1] == 0


def test_anchors_of_a_joint_stay_together(recording: Recording) -> None:
    """Until it breaks, a joint's place on its two bodies is the same but for what it gives, here less than 3 mm."""
    for j, joint in enumerate(recording.joints):
        places = []
        for body, anchor in zip(joint.bodies, joint.anchors, strict=True):
            x, y, angle = recording.pose[:, body].T
            c, s = np.cos(angle), np.sin(angle)
            places.append(np.stack([x + c * anchor[0] - s * anchor[1], y + s * anchor[0] + c * anchor[1]], axis=-1))
        gap = np.hypot(*(places[0] - places[1]).T)
        whole = ~recording.broken[:, j]
        assert gap[whole].max() < 3e-3


def test_a_broken_joint_stays_broken_and_bears_nothing(recording: Recording) -> None:
    broken = recording.broken[:, 0]
    assert not broken[0]
    assert broken[-1]
    assert np.all(np.diff(broken.astype(int)) >= 0)
    assert np.all(recording.force[broken, 0] == 0.0)
    assert np.all(recording.capacity_used[broken, 0] == 1.0)
    assert recording.peak[0, 2] == pytest.approx(recording.joints[0].maxima[2], rel=1e-9)


def test_a_joint_that_breaks_in_its_first_step_is_seen_broken() -> None:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    body.velocity = (1000.0, 0.0)
    law = ElasticPlastic((1e6, 1e6, 1e6), (10.0, 10.0, 10.0))
    joint = DuctileJoint(space.static_body, body, (0.0, 0.0), law, direction=0.0, limits=Limits(elongation=1e-3))
    space.add(body, joint)
    recorder = Recorder(space)
    space.step(1 / 60)
    recorder.sample()
    assert joint.broken
    recording = recorder.finish()
    assert recording.broken[:, 0].tolist() == [False, True]
    assert recording.peak[0, 0] > 0.0
    assert recording.energy["plastic"][-1] > 0.0


def test_contacts_lie_where_bodies_meet_and_carry_their_weight() -> None:
    """A box of 50 kg rests on a plate: a force of 490.5 N upwards on the box, at the plate's surface."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    box = pymunk.Body(50.0, 50.0 / 6)
    box.position = (0.3, 0.55)
    space.add(box, pymunk.Poly.create_box(box, (1.0, 1.0)), pymunk.Segment(space.static_body, (-5, 0), (5, 0), 0.05))
    recorder = Recorder(space)
    for _ in range(120):
        space.step(1 / 60)
        recorder.sample()
    contacts = recorder.finish().contacts
    first, last = contacts.start[-2:]
    assert last - first == 1
    np.testing.assert_allclose(contacts.point[first], [0.3, 0.05], atol=0.06)
    np.testing.assert_allclose(contacts.force[first], [0.0, 490.5], rtol=1e-3, atol=0.1)


def test_what_a_structure_carries_reaches_the_ground_through_its_contacts(recording: Recording) -> None:
    """At the end all lies still, and the ground carries the weight of ball and beam."""
    first, last = recording.contacts.start[-2:]
    weight = 9.81 * (300.0 + STEEL.density * SECTION.area * LENGTH)
    assert np.abs(recording.velocity[-1]).max() < 0.05
    upwards = recording.contacts.force[first:last, 1]
    ground = recording.contacts.point[first:last, 1] < -1.45
    assert upwards[ground].sum() == pytest.approx(weight, rel=0.05)


def test_bodies_and_joints_that_come_and_go() -> None:
    space = world()
    recorder = Recorder(space, every=1 / 60)
    for k in range(90):
        if k == 30:
            joints = cantilever(space)
        if k == 60:
            space.remove(joints[-1], joints[-1].b, *joints[-1].b.shapes)
        space.step(1 / 60)
        recorder.sample()
    recording = recorder.finish()
    there = ~np.isnan(recording.pose[:, :, 0])
    assert len(recording.bodies) == 1 + PIECES
    assert there[:30].sum(axis=1).max() == 1
    assert there[31:60].all()
    assert not there[61:, -1].any()
    assert there[61:, :-1].all()
    assert np.all(recording.force[:30] == 0.0)
    assert np.all(recording.force[61:, -1] == 0.0)
    assert np.abs(recording.force[61:, 0]).max() > 0.0
    assert not recording.broken.any()


def test_shapes_are_those_of_the_bodies(recording: Recording) -> None:
    still = recording.bodies[0].outlines
    assert sorted((outline.kind, outline.radius) for outline in still) == [
        ("polygon", 0.0),
        ("segment", 0.02),
        ("segment", 0.02),
    ]
    piece = recording.bodies[1]
    assert piece.in_structure
    np.testing.assert_allclose(np.ptp(piece.outlines[0].points, axis=0), [LENGTH / PIECES, DEPTH])
    ball = recording.bodies[-1]
    assert not ball.in_structure
    assert ball.outlines[0].kind == "circle"


def test_the_ledger_closes_while_joints_break(recording: Recording) -> None:
    """External work is what is stored and dissipated, in the structures that there are and were."""
    energy = recording.energy
    spent = sum(energy[name] for name in ("kinetic", "elastic", "plastic", "contact", "viscous", "numerical"))
    largest = np.abs(energy["external"]).max()
    np.testing.assert_allclose(energy["external"], spent, atol=1e-9 * largest)
    assert np.all(np.diff(energy["plastic"]) >= -1e-9 * largest)
    when = int(recording.broken[:, 0].argmax())
    # The root yields at M_max until it has turned by its limit, 0.12; what it stored is lost with it. It may turn on by
    # some of what it does in a part of a step; what N and Q stored is lost, too.
    moment, stiffness = recording.joints[0].maxima[2], capacity(SECTION, STEEL).EI / (LENGTH / PIECES)
    assert energy["plastic"][when] == pytest.approx(0.12 * moment + 0.5 * moment**2 / stiffness, rel=5e-3)
    kinetic = 0.5 * STEEL.density * SECTION.area * LENGTH / PIECES * (recording.velocity[-1, 1:-1] ** 2).sum()
    assert energy["kinetic"][-1] == pytest.approx(kinetic, rel=0.2, abs=1e-3)
