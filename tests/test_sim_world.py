"""Scenes run as a whole: the original's block and post, and the parts that a world is made of."""

import math
from typing import Any

import numpy as np
import pytest

from scene import builtin_text, load_scene, parse_scene
from sim.joint import AVERAGE_ACCELERATION
from sim.model import Model
from sim.motion import follow
from sim.world import World


def run(text: str, dt: float | None = None, duration: float | None = None) -> tuple[World, dict[str, Any]]:
    """The scene of ``text``, or a built-in one of that name, run to its end; what it measured."""
    scene = parse_scene(text, "test") if "\n" in text else load_scene(text)
    world = World(scene, dt, duration=duration)
    while not world.finished:
        world.step()
    return world, world.results()


def test_a_joint_that_hangs_a_block_bears_it_from_the_first_step() -> None:
    """m g h = 6000 · 10 / 60 = 1000 N s at once; the original's joint began with 0 and 1330 N s and yielded."""
    _, found = run("block-under-tension")
    assert found["impulse in the first step"] == pytest.approx(1000.0, rel=1e-3)
    assert found["impulse in the end"] == pytest.approx(1000.0, rel=1e-9)
    assert found["plastic elongation"] == 0.0


def test_a_weaker_joint_yields_and_breaks() -> None:
    """N_max = 55 kN under 60 kN: 5/6 m/s² of fall until the plastic elongation is used up, then free fall."""
    text = builtin_text("block-under-tension").replace('"80 kN"', '"55 kN"')
    world, found = run(text)
    assert found["impulse in the first step"] == pytest.approx(55e3 / 60.0, rel=1e-6)
    assert found["joints broken"] == 1.0
    assert found["plastic elongation"] >= 0.02
    (when, label), acceleration = world.broken[0], 5e3 / 6e3
    assert label == "hanger"
    assert when == pytest.approx(math.sqrt(2 * 0.02 / acceleration), abs=2 / 60)
    # The rest of the way with the speed that it has by then.
    speed = acceleration * when
    fall = (-speed + math.sqrt(speed**2 + 2 * 10.0 * 1.48)) / 10.0
    assert found["block hits the ground"] == pytest.approx(when + fall, abs=1 / 60)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_free_fall_hits_the_ground_when_it_should(dt: float) -> None:
    """√(2 · 1.5 / 10) = 0.548 s, within a step."""
    text = builtin_text("block-under-tension")
    without_joint = text[: text.index("[joints.hanger]")] + text[text.index('[measures."block') :]
    _, found = run(without_joint, dt)
    assert found["block hits the ground"] == pytest.approx(math.sqrt(0.3), abs=dt)


def test_a_ball_breaks_the_post_and_keeps_the_same_speed_at_any_step() -> None:
    """At 30 m/s; solved joint by joint the original's ball kept 15.5 to 25.7 m/s, depending on the step."""
    after_the_break, speeds = [], []
    for dt in (1 / 60, 1 / 240, 1 / 1000, 1 / 4000):
        world, found = run("post-impact", dt, duration=0.02)
        assert found["foot broken"] == 1.0
        after_the_break.append(world.bodies["ball"].velocity.x)
        _, found = run("post-impact", dt, duration=0.31)
        speeds.append(found["ball's speed behind the post"])
    assert max(after_the_break) / min(after_the_break) < 1.03
    # The post, free by now and spinning by up to 0.3 rad in a step, meets the ball again on its way.
    assert max(speeds) / min(speeds) < 1.02
    # Momentum about the foot, then M over the rotation limit (slip and friction left out).
    inertia = 36.0 * 3.0**2 / 3 + 200.0 * 1.4**2
    together = 200.0 * 30.0 * 1.4 / inertia
    assert speeds[-1] == pytest.approx(math.sqrt(together**2 - 2.0 * 15.1e3 * 0.2 / inertia) * 1.4, rel=0.1)


def test_the_stop_block_ends_what_comes_through() -> None:
    """2000 kg with friction 0.25 against the ground: the ball ends in front of it, and it slides."""
    world, found = run("post-impact", duration=3.0)
    assert 0.1 < found["block pushed by"] < 5.0
    assert world.bodies["ball"].position.x < world.bodies["stop"].position.x


@pytest.mark.parametrize("dt", [1 / 60, 1 / 1000])
def test_a_push_is_run_to_its_last_stop(dt: float) -> None:
    """The plastic moment over the arm, M_p / L = 29.375 kN, within 1 % at ten times the deflection at yield.

    It stops there gently, without a jerk in its last steps, which a mass of 200 kg at the tip would show.
    """
    text = builtin_text("cantilever").replace("[nodes.tip]", '[nodes.tip]\nmass = "200 kg"')
    world = World(parse_scene(text, "heavy"), dt=dt)
    loads = []
    while not world.finished:
        world.step()
        assert world.push is not None
        loads.append(world.push.load)
    assert world.push is not None
    assert world.push.displacement == pytest.approx(74.6031746e-3, rel=2e-4)
    assert loads[-1] == pytest.approx(29375.0, rel=0.01)
    assert loads[-3:] == pytest.approx([loads[-1]] * 3, rel=1e-3)


FALL = """
title = "Something falls"
[simulation]
duration = "0.5 s"
dt = "10 ms"
[[grounds]]
points = [["-9 m", "0 m"], ["9 m", "0 m"]]
"""


def test_a_fast_body_goes_into_nothing() -> None:
    """A plate 10 mm thick at 250 m/s and 10 ms: 2.5 m of way a step. Without `continuous` it is gone."""
    plate = """
[bodies.plate]
at = ["0 m", "2 m"]
velocity = ["0 m/s", "-250 m/s"]
mass = "1 kg"
shapes = [{ kind = "box", size = ["1 m", "10 mm"] }]
[measures.overlap]
quantity = "overlap"
of = "plate"
take = "largest"
"""
    world, _ = run(FALL + plate)
    assert world.bodies["plate"].position.y < -1.0
    world, found = run(FALL + plate.replace("mass =", "continuous = true\nmass ="))
    assert found["overlap"] <= 1e-3
    assert world.bodies["plate"].position.y == pytest.approx(5e-3, abs=1e-3)


@pytest.mark.parametrize("ahead", [-20.0, 0.0, 45.0])
def test_a_fast_body_ends_its_move_at_what_moves_too(ahead: float) -> None:
    """At 50 m/s behind, before or against another: it neither goes into it nor loses it by the end of the step."""
    pair = "".join(
        f"""
[bodies.{name}]
at = ["{x} m", "5 m"]
velocity = ["{speed} m/s", "0 m/s"]
mass = "1 kg"
shapes = [{{ kind = "circle", radius = "0.1 m" }}]
{"continuous = true" if name == "fast" else ""}
"""
        for name, x, speed in (("fast", -0.31, 50.0), ("other", 0.0, ahead))
    )
    world = World(parse_scene(FALL + pair, "test"))
    fast, other = world.bodies["fast"], world.bodies["other"]
    while fast.velocity.x > 0.5 * (50.0 + ahead) + 1e-6:
        gap = other.position.x - fast.position.x - 0.2
        world.step()
    assert gap > 0.0
    assert other.position.x - fast.position.x - 0.2 == pytest.approx(0.0, abs=1e-3)
    assert fast.velocity.x == pytest.approx(0.5 * (50.0 + ahead))


def test_mass_centre_and_inertia_of_shapes() -> None:
    """A T of two rectangles, by Steiner's theorem."""
    text = (
        FALL
        + """
[bodies.tee]
at = ["0 m", "3 m"]
density = "1000 kg/m^3"
depth = "0.5 m"
shapes = [{ kind = "box", size = ["2 m", "1 m"], at = ["0 m", "1.5 m"] }, { kind = "box", size = ["1 m", "2 m"] }]
"""
    )
    body = World(parse_scene(text, "test")).bodies["tee"]
    assert body.mass == pytest.approx(2000.0)
    assert body.center_of_gravity.y == pytest.approx(0.75)
    own = 1000.0 * (4.0 + 1.0) / 12.0
    assert body.moment == pytest.approx(2.0 * own + 2000.0 * 0.75**2)


def test_bodies_of_a_group_pass_through_each_other() -> None:
    pair = "".join(
        f"""
[bodies.{name}]
at = ["0 m", "{height} m"]
mass = "1 kg"
shapes = [{{ kind = "circle", radius = "0.1 m" }}]
group = "pair"
"""
        for name, height in (("low", 0.1), ("high", 0.5))
    )
    world, _ = run(FALL + pair)
    assert world.bodies["high"].position.y == pytest.approx(0.1, abs=0.02)
    world, _ = run(FALL + pair.replace('group = "pair"', ""))
    assert world.bodies["high"].position.y > 0.25


def test_a_load_follows_its_history() -> None:
    """A stiff column: 20 kN at 0.5 of the way up the ramp, none after it."""
    text = """
title = "Column"
gravity = "0 m/s^2"
[simulation]
duration = "2 s"
integration = "implicit-euler"
[nodes.foot]
at = ["0 m", "0 m"]
support = "clamped"
[nodes.top]
at = ["0 m", "2 m"]
[members.column]
from = "foot"
to = "top"
section = "IPE 300"
material = "S235"
[[loads]]
node = "top"
force = ["0 N", "-40 kN"]
kind = "history"
history = [["0 s", 0.0], ["1 s", 1.0], ["1.1 s", 0.0]]
[measures.half]
quantity = "N"
of = "column"
at = "0.5 s"
[measures.full]
quantity = "N"
of = "column"
take = "largest"
[measures.after]
quantity = "N"
of = "column"
"""
    _, found = run(text)
    assert found["half"] == pytest.approx(-20e3, rel=0.01)
    assert found["full"] == pytest.approx(-40e3, rel=0.01)
    assert abs(found["after"]) < 100.0


COLUMN = """
title = "Cantilever pushed to and fro"
gravity = "0 m/s^2"
[nodes.wall]
at = ["0 m", "0 m"]
support = "clamped"
[nodes.tip]
at = ["2 m", "0 m"]
[members.beam]
from = "wall"
to = "tip"
section = "IPE 300"
material = "S235"
[measures.work]
quantity = "plastic-work"
of = "beam"
[push]
node = "tip"
direction = [0, 1]
"""


def test_a_cyclic_push_goes_to_every_turning_point_and_its_work_is_the_loop_s_area() -> None:
    text = COLUMN + 'turning_points = ["30 mm", "-30 mm", "30 mm"]'
    world = World(parse_scene(text, "test"))
    assert world.push is not None
    way, load = [0.0], [0.0]
    while not world.finished:
        world.step()
        way.append(world.push.displacement)
        load.append(world.push.load)
    assert max(way) == pytest.approx(0.030, rel=1e-3)
    assert min(way) == pytest.approx(-0.030, rel=1e-3)
    assert way[-1] == pytest.approx(0.030, rel=1e-3)
    area = float(np.trapezoid(load, way))
    stored = load[-1] ** 2 / 2.0 * 0.030 / load[-1]
    assert world.results()["work"] == pytest.approx(area, rel=0.05, abs=stored)


def test_a_push_that_unloads_ends_without_load() -> None:
    world, _ = run(COLUMN + 'distance = "40 mm"\nunload = true\n')
    assert world.push is not None
    assert abs(world.push.load) < 0.03 * 75e3
    assert 0.01 < world.push.displacement < 0.035


def test_a_motion_is_run_as_its_own_solver_runs_it() -> None:
    text = (
        COLUMN[: COLUMN.index("[measures")]
        + """
[motion]
duration = "0.1 s"
[simulation]
dt = "0.1 ms"
numerical_damping = 0.0
[measures.peak]
quantity = "displacement"
of = "tip"
take = "largest"
"""
    )
    text = text.replace('at = ["2 m", "0 m"]', 'at = ["2 m", "0 m"]\nmass = "100 kg"\nvelocity = ["0 m/s", "-2 m/s"]')
    _, found = run(text)
    model = Model("lobatto", 5, "elastic-plastic", dt=1e-4, scheme=AVERAGE_ACCELERATION)
    assert found["peak"] == pytest.approx(-follow(parse_scene(text, "test"), model).peak, rel=2e-3)
