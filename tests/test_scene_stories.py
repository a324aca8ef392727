"""The original's larger scenes: their stories, with the numbers that statics and the finite-element reference give."""

import itertools
from typing import Any

import numpy as np
import pytest
from test_sim_world import run
from whole_runs import whole_run

from fem_reference import pushover
from scene import builtin_text, load_scene, parse_scene
from sim.world import World


def without(text: str, first: str, following: str) -> str:
    """``text`` without what stands from ``first`` up to ``following``."""
    return text[: text.index(first)] + text[text.index(following) :]


def rotations(world: World, member: str) -> list[float]:
    return [joint.plastic_deformation[3] for joint in world.joints[member]]


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_own_weight_beam(dt: float) -> None:
    """q L⁴ / 8 EI = 22.3 mm and q L² / 2 = 31.2 MN m."""
    _, found = run("own-weight-beam", dt)
    weight, stiffness = 7800.0 * 2.0 * 10.0, 210e9 * 8.0 / 12.0
    assert found["sag of the tip"] == pytest.approx(weight * 20.0**4 / (8.0 * stiffness), rel=2e-3)
    assert found["moment at the wall"] == pytest.approx(-weight * 200.0, rel=2e-3)
    assert found["joints that yielded"] == 0.0


@pytest.fixture(scope="module")
def standing() -> tuple[World, dict[str, Any]]:
    """The frame without the ball, for ten seconds at 60 Hz."""
    text = without(builtin_text("multifloor-frame"), "[bodies.ball]", "[measures.")
    return run(text[: text.index('[measures."ball')])


WEIGHT = 144 * 487.5 * 10.0


def test_the_frame_stands_still_for_ten_seconds(standing: tuple[World, dict[str, Any]]) -> None:
    """The original crept by 0.15 m, broke 157 of 160 joints, or moved by 4.8 m, by the year of its code."""
    world, found = standing
    assert world.time == pytest.approx(10.0)
    assert found["top corner moved at most by"] < 1e-3
    assert found["joints that yielded"] == 0.0
    assert found["joints broken"] == 0.0
    assert sum(body.mass for body in world.space.bodies) * 10.0 == pytest.approx(WEIGHT)


def test_the_frame_bears_what_statics_says(standing: tuple[World, dict[str, Any]]) -> None:
    """All weight arrives at the feet, but for what still vibrates; beams bear about w L² / 12 of 875 kN m."""
    world, _ = standing
    feet = [world.joints[f"frame-column-{i}-1"][0].force[0] for i in range(5)]
    assert -sum(feet) == pytest.approx(WEIGHT, rel=0.05)
    beams = [joint.force[2] for name, joints in world.joints.items() if "beam" in name for joint in joints]
    assert max(map(abs, beams)) < 1.5 * (487.5 * 10.0 / 0.625) * 2.5**2 / 8.0


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240, 1 / 1000])
def test_the_ball_s_damage_is_local(dt: float) -> None:
    """At 30 m/s the struck column yields and nothing else does; at 5 m/s it stores all 12.5 kJ elastically."""
    world, found = run(builtin_text("multifloor-frame").replace('"5 m/s"', '"30 m/s"'), dt, duration=0.3)
    yielded = {name for name, joints in world.joints.items() if any(any(j.plastic_deformation) for j in joints)}
    assert yielded == {"frame-column-0-1"}
    assert found["joints broken"] == 0.0
    assert found["plastic work in the struck column"] == pytest.approx(196e3, rel=0.05)


def bridge(duration: float, load: str = "") -> tuple[World, dict[str, Any]]:
    """The bridge without the lorry, brought to rest by implicit Euler."""
    text = without(builtin_text("bridge"), "[vehicles.lorry]", "[measures.")
    text = text[: text.index('[measures."lorry')] + load
    return run(text.replace('rule = "equal"', 'integration = "implicit-euler"\nrule = "equal"'), duration=duration)


def sag(world: World) -> float:
    joints = world.joints["bridge"]
    middle = joints[len(joints) // 2]
    return 7.71875 - middle.point_on(middle.a)[1]


def test_the_bridge_balances_its_own_weight_by_bending_and_by_its_sag() -> None:
    """M_mid - M_end + N f = q L² / 8. q L² / 12 = 4.70 MN m is beyond M_max = 4.31: the ends yield first."""
    world, found = bridge(12.0)
    joints = world.joints["bridge"]
    (axial, _, end), (_, _, middle) = joints[0].force, joints[2].force
    weight = 2290.0 * 9.0 * 0.4375 * 10.0
    assert middle - end + axial * sag(world) == pytest.approx(weight * 25.0**2 / 8.0, rel=0.02)
    assert found["joints that own weight makes yield"] == 2.0
    assert [rotation > 0.0 for rotation in rotations(world, "bridge")] == [True, False, False, False, True]


def test_the_bridge_deflects_under_the_vehicle_s_weight_as_the_reference_does() -> None:
    """50 t put down at mid-span, against corotational fibre beam elements with their own weight borne first."""
    box = """
[bodies.parked]
at = ["12.5 m", "8.42 m"]
mass = "50 t"
shapes = [{ kind = "box", size = ["1 m", "1 m"] }]
"""
    deflection = sag(bridge(20.0, box)[0]) - sag(bridge(20.0)[0])
    text = builtin_text("bridge")
    head, material = text[: text.index("[simulation]")], text[text.index("section =") : text.index("break_rotation")]
    nodes = "".join(
        f'[nodes.{name}]\nat = ["{x} m", "0 m"]\nsupport = "{support}"\n'
        for name, x, support in (("left", 0.0, "clamped"), ("mid", 12.5, "free"), ("right", 25.0, "clamped"))
    )
    members = "".join(
        f'[members.{a}-{b}]\nfrom = "{a}"\nto = "{b}"\n{material}'
        for a, b in itertools.pairwise(("left", "mid", "right"))
    )
    push = '[push]\nnode = "mid"\ndirection = [0, -1]\ndistance = "0.16 m"\n'
    reference = pushover(parse_scene(head + nodes + members + push, "bridge"), 0.02)
    expected = float(np.interp(50e3 * 10.0, reference.load, reference.displacement))
    assert expected == pytest.approx(0.130, abs=0.004)
    assert deflection == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_one_crossing_leaves_light_damage_on_the_bridge(dt: float) -> None:
    world, found = run("bridge", dt, duration=20.0)
    assert found["lorry is at x ="] > 30.0
    assert found["joints broken"] == 0.0
    assert found["joints that yielded in the end"] == 3.0
    assert found["capacity used in the end"] == pytest.approx(0.0070, rel=0.05)
    assert sag(world) < 0.4


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_an_overloaded_bridge_loses_two_joints_and_falls(dt: float) -> None:
    """1100 t on stiffer springs: the quarter points break, and what is between them lies on the ground."""
    text = builtin_text("bridge").replace('"46 t"', '"1096 t"').replace('"4 Hz"', '"20 Hz"')
    world, found = run(text.replace('"150 kN m"', '"4.4 MN m"'), dt, duration=17.0)
    # Later the lorry, upside down, falls on the wreck a second time, and may tear another joint.
    assert found["joints broken"] == 2.0
    assert [label for _, label in world.broken] == ["bridge 2", "bridge 4"]
    assert world.joints["bridge"][2].a.position.y < 1.0
    assert world.cars["lorry"].chassis.position.y < 5.0


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_the_gate_yields_at_its_foot_first_and_takes_the_lorry_s_energy(dt: float) -> None:
    """50 t at 3 m/s and its wheels: 225 + 9 kJ, and what the motors add: 241 kJ and 0.362 rad in steps of 1/2000 s.

    What a joint bears is M_max = 360 kN m, and no more.
    """
    world = World(load_scene("gate"), dt)
    first: list[str] = []
    most = 0.0
    while not world.finished:
        world.step()
        yielded = [label for joint, label in world.labels.items() if joint.plastic_deformation[3] > 0.0]
        first = first or yielded
        most = max(most, *(abs(joint.force[2]) for joint in world.labels))
    found = world.results()
    assert "gate 1" in first
    assert most == pytest.approx(10e6 * 0.4 * 0.6**2 / 4.0, rel=0.01)
    assert most <= 10e6 * 0.4 * 0.6**2 / 4.0 * (1.0 + 1e-6)
    assert found["plastic work in the gate"] == pytest.approx(241e3, rel=0.02)
    assert found["plastic work in the gate"] > 0.5 * 50e3 * 3.0**2 + 1000.0 * 3.0**2
    assert found["largest plastic rotation"] == pytest.approx(0.362, rel=0.05)
    assert found["joints broken"] == 0.0
    assert found["lorry is at x ="] == pytest.approx(-3.0, abs=0.1)


def test_demolisher_crosses_the_bridge_and_is_stopped_by_the_barrier() -> None:
    found = whole_run("demolisher")[0].results()
    assert found["joints of the bridge that own weight makes yield"] == 2.0
    assert found["joints of the bridge that yielded"] == 3.0
    assert found["capacity used of the bridge"] == pytest.approx(0.006, rel=0.1)
    # In steps of 1/1000 s. Once the lorry stands, its motors push on with nearly what the barrier bears.
    assert found["largest plastic rotation of the barrier"] == pytest.approx(0.330, rel=0.05)
    assert found["joints broken"] == 0.0
    assert found["lorry is at x ="] == pytest.approx(122.0, abs=0.1)
