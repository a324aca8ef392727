"""Frames that are struck, refined where they are."""

import math
from pathlib import Path

import msgspec
import numpy as np
import pymunk
import pytest
from frames import STEEL

from scene import load_scene, parse_scene
from sim import Model, Recorder, assemble
from sim.world import World

STEP = 2e-3
STRUCK = """
title = "A frame struck by a car that crumples"
gravity = 0.0
[simulation]
duration = 0.12
dt = 0.5e-3
joints = 9
collision_slop = 1e-4
refine_at = {at}
[nodes]
A = {{ at = [0.0, 0.0], support = "clamped" }}
B = {{ at = [0.0, 3.0] }}
C = {{ at = [4.0, 3.0] }}
D = {{ at = [4.0, 0.0], support = "clamped" }}
E = {{ at = [8.0, 3.0] }}
F = {{ at = [8.0, 0.0], support = "clamped" }}
{members}
[bodies.bumper]
at = [-0.251, 1.5]
velocity = [{speed}, 0.0]
mass = 10.0
shapes = [{{ kind = "circle", radius = 0.2 }}]
[bodies.car]
at = [-1.5, 1.5]
velocity = [{speed}, 0.0]
mass = 300.0
shapes = [{{ kind = "box", size = [1.5, 0.5] }}]
[joints.front]
between = ["car", "bumper"]
at = [-0.5, 1.5]
direction = [1.0, 0.0]
stiffness = [3e6, 1e8, 1e7]
N_max = 90e3
[measures.work]
quantity = "plastic-work"
of = "A-B"
[measures.corner]
quantity = "displacement"
of = "B"
take = "largest"
[measures.speed]
quantity = "vx"
of = "car"
"""


def struck(at: str, speed: float = 8.0) -> World:
    member = 'section = "rectangle 50x100 mm"\nfriction = 0.3\nbreak_rotation = 0.8\n' + f'material = "{STEEL}"\n'
    names = ("A-B", "B-C", "C-D", "C-E", "E-F")
    members = "".join(f'[members.{name}]\nfrom = "{name[0]}"\nto = "{name[2]}"\n{member}' for name in names)
    text = STRUCK.format(at=at, speed=speed, members=members)
    return World(parse_scene(text if at else text.replace("refine_at = \n", ""), "test"))


def test_a_struck_frame_is_refined_where_it_is_struck_and_follows_the_fine_one() -> None:
    """Within 3 % of its peak; the struck column is first, shapes keep what they were given, the ledger closes."""
    runs = {}
    for at in ("", "0.5"):
        world = struck(at)
        recorder = Recorder(world.space, 0.01, world.labels)
        kinds = {shape.collision_type for shape in world.space.shapes if shape.collision_type}
        while not world.finished:
            world.step()
            recorder.sample(world.part)
        bodies = {body for name in world.scene.members for joint in world.joints[name] for body in (joint.a, joint.b)}
        shapes = [s for body in bodies if body.body_type == pymunk.Body.DYNAMIC for s in body.shapes]
        assert {shape.collision_type for shape in shapes} == kinds
        assert {shape.friction for shape in shapes} == {0.3}
        runs[at] = world, recorder.finish()
    (fine, _), (world, recording) = runs[""], runs["0.5"]
    assert [name for _, name in world.refined][:2] == ["A-B", "B-C"]
    assert [time for time, _ in world.refined] == sorted(time for time, _ in world.refined)
    expected, found = fine.results(), world.results()
    assert found["corner"] == pytest.approx(expected["corner"], rel=0.03)
    assert found["work"] == pytest.approx(expected["work"], rel=0.03)
    assert found["speed"] == pytest.approx(expected["speed"], rel=0.03)
    # Bodies and joints that are gone are not there any more, and the new ones were not there before.
    gone, made = np.isnan(recording.pose[-1, :, 0]), np.isnan(recording.pose[0, :, 0])
    refined = len(world.refined)
    assert (gone.sum(), made.sum()) == (3 * refined, 8 * refined)
    labels = [joint.label for joint in recording.joints]
    assert len(set(labels)) == len(labels)
    assert sum(label.endswith("of the coarse member") for label in labels) == 4 * refined
    accounts = recording.energy
    spent = sum(accounts[name] for name in ("kinetic", "elastic", "plastic", "contact", "viscous", "numerical"))
    assert np.abs(accounts["external"] - spent).max() <= 1e-9 * accounts["external"].max()


def test_a_joint_that_breaks_in_a_refined_member_is_told() -> None:
    """And a member in which one has broken while it was coarse is not refined any more."""
    world = struck("0.5", speed=60.0)
    while not world.finished:
        world.step()
    refined = {name for _, name in world.refined}
    assert any(name in refined for name in (label.rsplit(" ", 1)[0] for _, label in world.broken))
    assembly = assemble(world.scene, Model("lobatto", 9, "elastic-plastic", refine_at=math.inf))
    assembly.step(STEP)
    assembly.space.remove(assembly.joints[1])
    assembly.step(STEP)
    assert assembly.refine(["A-B", "E-F"]) == ("E-F",)


def test_a_frame_struck_in_one_corner_pays_for_that_corner() -> None:
    """The multifloor frame: within 1.5 % of the uniformly fine one with a quarter of its joints; 6 a member are not."""
    scene = load_scene(str(Path(__file__).parent.parent / "examples" / "struck-frame.toml"))
    paths, joints = [], []
    for settings in ({"refine_at": None}, {}, {"refine_at": None, "joints": 6}):
        run = msgspec.structs.replace(scene.simulation, duration=0.1, dt=5e-4, **settings)
        world = World(msgspec.structs.replace(scene, simulation=run))
        start, path, count = world.point_called("frame-0-1")[0].position, [], 0
        while not world.finished:
            world.step()
            path.append(world.point_called("frame-0-1")[0].position - start)
            count += sum(map(len, world.joints.values()))
        paths.append(np.array(path))
        joints.append(count / world.steps)
        if not settings:
            assert [name for _, name in world.refined] == ["frame-column-0-1", "frame-beam-0-1"]
    fine, adaptive, coarse = paths
    largest = np.linalg.norm(fine, axis=1).max()
    assert np.linalg.norm(adaptive - fine, axis=1).max() <= 0.015 * largest
    assert np.linalg.norm(coarse - fine, axis=1).max() >= 0.05 * largest
    assert joints[1] <= 0.25 * joints[0]
