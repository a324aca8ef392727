"""Pushes that are slow enough for what they push, and that end where a second path branches off."""

import json
import math
from typing import Any

import numpy as np
import pytest
from frames import down, frame_scene, push_towards

import sim
from calibration import calibrate
from calibration.comparable_push import push_model
from calibration.export import joint_table
from capacity import InputError
from fem_reference import NotConverged, branches_at, pushover
from scene import Scene
from sim import Model, Pace
from sim.world import World

STRONG = "fy=1e5 MPa, E=210 GPa, rho=7850 kg/m^3"
LENGTH = 2.0


def column(head: str, direction: tuple[int, int], distance: float, disturbed: float = 0.0) -> Scene:
    """An upright elastic column, clamped at its foot; ``disturbed`` is a share of the load that acts across."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (0.0, LENGTH, head)}
    loads = [f'node = "B"\nforce = [{disturbed!r}, -1.0]'] if disturbed else []
    push = push_towards("B", direction, distance)
    return frame_scene(
        nodes, [("A", "B")], push, loads, section="rectangle 20x20 mm", material=STRONG, kinematics="large"
    )


@pytest.mark.parametrize(("head", "effective"), [("free", 2.0), ("roller-y", 0.699156), ("guided-y", 0.5)])
def test_a_column_branches_off_at_eulers_load(head: str, effective: float) -> None:
    """π² EI / (k L)², k of Timoshenko & Gere, Theory of elastic stability, chapter 2; the way there is P L / EA."""
    probe = column(head, (0, -1), 1e-3).capacity("A-B")
    buckled = math.pi**2 * probe.EI / (effective * LENGTH) ** 2 * LENGTH / probe.EA
    found = branches_at(column(head, (0, -1), 2.0 * buckled))
    assert found is not None
    # The last point before, of fifty, with twenty elements.
    assert found / buckled == pytest.approx(1.0, abs=0.03)
    assert branches_at(column(head, (0, -1), 0.9 * buckled)) is None


def test_a_disturbed_column_has_one_path() -> None:
    assert branches_at(column("free", (0, -1), 0.05, disturbed=0.01)) is None


def test_a_column_that_its_dead_load_buckles_is_told() -> None:
    heavy = 'node = "B"\nforce = [0.0, -5e3]\nkind = "dead"'  # four times Euler's load
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (0.0, LENGTH, "free")}
    push = push_towards("B", (1, 0), 0.01)
    scene = frame_scene(
        nodes, [("A", "B")], push, [heavy], section="rectangle 20x20 mm", material=STRONG, kinematics="p-delta"
    )
    with pytest.raises(NotConverged, match="not stable under its own weight and dead loads"):
        calibrate(scene)


def test_loads_that_do_not_move_the_node_are_told() -> None:
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (LENGTH, 0.0, "free")}
    with pytest.raises(InputError, match='the loads do not move node "B" that way'):
        pushover(frame_scene(nodes, [("A", "B")], push_towards("B", (1, 0), 0.01), [down("B")]))


def test_calibration_compares_up_to_there_and_says_so() -> None:
    probe = column("free", (0, -1), 1e-3).capacity("A-B")
    buckled = math.pi**2 * probe.EI / (2.0 * LENGTH) ** 2 * LENGTH / probe.EA
    result = calibrate(column("free", (0, -1), 2.0 * buckled))
    assert result.target_met
    assert result.branches_at == pytest.approx(buckled, rel=0.03)
    assert result.reference.displacement[-1] == pytest.approx(result.branches_at)
    assert any("slightest disturbance" in remark for remark in result.remarks)


def test_heavy_nodes_are_pushed_slowly() -> None:
    """A tonne at the tip of a slender cantilever, of whose load inertia would bear some per cent."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (LENGTH, 0.0, 'free"\nmass = "1 t')}
    push = push_towards("B", (0, -1), 0.1)
    scene = frame_scene(nodes, [("A", "B")], push, section="rectangle 30x50 mm", material=STRONG)
    way, model = np.linspace(0.0, 0.1, 101), Model("lobatto", 5, "elastic-plastic")
    exact = 3.0 * scene.capacity("A-B").EI / LENGTH**3 * way
    pushes = [push_model(scene, model, way, Pace(most_inertia=most)) for most in (1.0, 1e-3)]
    off = [np.abs(push.load_at_distances - exact).max() / exact.max() for push in pushes]
    assert off[0] > 5e-3
    assert pushes[0].inertia == pytest.approx(off[0], rel=0.5)
    assert off[1] < 2e-3
    assert pushes[1].inertia <= 1e-3
    assert sim.PACE.duration == pushes[0].duration < pushes[1].duration


def test_a_push_stands_when_a_slower_one_breaks_down(monkeypatch: pytest.MonkeyPatch) -> None:
    push, scene = sim.pushover._push, strip()
    way, model = np.linspace(0.0, 0.7, 11), Model("lobatto", 5, "elastic-plastic")
    stands = sim.push_over(scene, model, way, pace=Pace(most_inertia=1.0))

    def breaks_down(*args: Any) -> sim.Push:
        if args[-1] > sim.PACE.duration:
            raise sim.SolverError("slower")
        return push(*args)

    monkeypatch.setattr(sim.pushover, "_push", breaks_down)
    again = sim.push_over(scene, model, way, pace=Pace(most_inertia=0.5 * stands.inertia))
    assert again.inertia == stands.inertia
    assert np.array_equal(again.load, stands.load)


def strip() -> Scene:
    """A strip of 4 Hz that a moment at its tip rolls up."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (1.0, 0.0, "free")}
    moment, push = 'node = "B"\nmoment = -1.0', push_towards("B", (0, -1), 0.7)
    return frame_scene(
        nodes, [("A", "B")], push, [moment], section="rectangle 4x5 mm", material=STRONG, kinematics="large"
    )


def strut() -> Scene:
    """Bent by 1/400 of its length, of perfect plasticity: past its largest load it loses a fifth of it at once."""
    nodes = {"A": (0.0, 0.0, "pinned"), "M": (0.01, 2.0, "free"), "B": (0.0, 4.0, "roller-y")}
    push = push_towards("B", (0, -1), 0.03)
    return frame_scene(nodes, [("A", "M"), ("M", "B")], push, [down("B")], section="HEB 100", kinematics="large")


@pytest.mark.parametrize(("scene", "short"), [(strip(), 1 / 500), (strut(), 1 / 240)], ids=["strip", "strut"])
def test_what_vibrates_or_gives_way_at_once_is_pushed_alike_by_short_steps(scene: Scene, short: float) -> None:
    """Within 1 % of the largest load at every hundredth of the way; short steps damp nothing of either."""
    way = np.linspace(0.0, float(scene.push.distance), 101)
    long_steps, short_steps = (
        sim.push_over(scene, Model("graded", 9, "fibre", 16, dt=dt), way) for dt in (1 / 60, short)
    )
    off = np.abs(short_steps.load_at_distances - long_steps.load_at_distances).max()
    assert off <= 0.01 * long_steps.load.max()


def test_a_simulated_push_goes_slowly_where_a_strut_gives_way() -> None:
    """At 1/60 and 1/240 s within 2.5 % of the largest load; pushed evenly it would be 10 %."""
    way, loads = np.linspace(0.0, 0.03, 101), []
    for dt in (1 / 60, 1 / 240):
        world, places, load = World(strut(), dt), [0.0], [0.0]
        while not world.finished:
            world.step()
            assert world.push is not None
            places.append(world.push.displacement)
            load.append(world.push.load)
        assert 4.0 < world.time < 12.0
        loads.append(np.interp(way, np.maximum.accumulate(places), load))
    assert np.abs(loads[1] - loads[0]).max() <= 0.025 * loads[0].max()


@pytest.mark.parametrize("law", sim.LAWS)
def test_joints_of_every_law_can_be_handed_over_as_json(law: str) -> None:
    table = joint_table(column("free", (1, 0), 0.01), Model("lobatto", 3, law))
    assert json.loads(json.dumps(table, allow_nan=False))["joints"] == table["joints"]


@pytest.mark.parametrize("distances", [[], [0.0], [0.01, 0.02], [0.0, math.nan], [[0.0, 0.01]]])
def test_distances_that_are_no_way_are_told(distances: list[Any]) -> None:
    with pytest.raises(InputError, match="distances: they are no way from 0"):
        sim.push_over(column("free", (1, 0), 0.01), Model("lobatto", 3, "elastic"), distances)
