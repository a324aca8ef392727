"""Frames as rigid bodies: N–M interaction, supports and springs, and a frame of two storeys that hardens."""

from collections.abc import Sequence

import numpy as np
import pytest
from conftest import CASES
from frames import frame_scene, push_down

import sim
from capacity import Interaction
from fem_reference import pushover
from scene import Scene
from sim import Model, SolverError
from sim.load_driver import LoadDriver

FINE = Model("lobatto", 9, "fibre", 16)


@pytest.mark.parametrize("row", [0, 1, 2])
def test_interacting_hinges_fold_at_the_exact_moment_beside_an_axial_force(row: int) -> None:
    """C4-rect: M_pl,N / M_p = 1 - n², with the axial force's moment on the sunk tip; to 0.2 % of both."""
    outputs = CASES["C4-rect"]["outputs"]
    case, dy, squash = outputs["rows"][row], outputs["delta_y_m_no_axial"], 1175e3
    distance = 2.0 * dy
    nodes = {"A": (0.0, 0.0, "clamped"), "T": (1.0, 0.0, "free")}
    axial = f'node = "T"\nforce = [{-case["n"] * squash!r}, 0.0]\nkind = "dead"'
    scene = frame_scene(nodes, [("A", "T")], push_down("T", distance), [axial], section="rectangle 50x100 mm")
    push = sim.push_over(scene, Model("lobatto", 6, "interaction", dt=1 / 240), np.linspace(0.0, distance, 101))
    assert push.unconverged == 0
    reached = push.load[-1] + case["n"] * squash * push.displacement[-1]
    exact = Interaction(scene.members["A-T"].section, scene.members["A-T"].material)
    assert exact.moments_at(case["n"] * squash)[1] == pytest.approx(case["M_plN_Nm"], rel=1e-9)
    assert exact.load_factor(-case["n"] * squash, 0.0, reached) == pytest.approx(1.0, abs=2e-3)


def test_springs_releases_settlements_and_masses() -> None:
    """A beam on a spring bears k δ; a released end bears no moment; a settled support lifts its share of load."""
    nodes = {"A": (0.0, 0.0, "pinned"), "B": (4.0, 0.0, "free"), "C": (2.0, 0.0, "free")}
    members, push = [("A", "C"), ("C", "B")], push_down("C", 0.002)
    spring = "[nodes.B]\nat = [4.0, 0.0]\nspring = [0.0, 1e6, 0.0]"
    scene = frame_scene({k: v for k, v in nodes.items() if k != "B"} | {}, members, push, extra=spring)
    load = sim.push_over(scene, FINE, np.linspace(0.0, 0.002, 11)).load_at_distances[-1]
    ei = scene.capacity("A-C").EI
    # Half of the load comes to the spring, whose end sinks by P / 2k; the middle by half of that and P L³ / 48 EI.
    assert load == pytest.approx(0.002 / (4.0**3 / (48.0 * ei) + 1.0 / (4.0 * 1e6)), rel=2e-3)


def two_storeys(hardening: float, kinematics: str) -> Scene:
    """One bay of 5 m, storeys of 4 and 3 m; weights on the beams first, then pushed sideways at both floors."""
    nodes = {
        "A": (0.0, 0.0, "clamped"),
        "B": (0.0, 4.0, "free"),
        "C": (0.0, 7.0, "free"),
        "D": (5.0, 7.0, "free"),
        "E": (5.0, 4.0, "free"),
        "F": (5.0, 0.0, "pinned"),
    }
    members = [("A", "B"), ("B", "C"), ("C", "D"), ("B", "E"), ("F", "E"), ("E", "D")]
    weights = [
        f'member = "{beam}"\nper_length = [0.0, {load}]\nkind = "dead"' for beam, load in (("B-E", -2e4), ("C-D", -1e4))
    ]
    sway = ['node = "B"\nforce = [1.0, 0.0]', 'node = "C"\nforce = [2.0, 0.0]']
    return frame_scene(
        nodes,
        members,
        '[push]\nnode = "C"\ndirection = [1, 0]\ndistance = 0.4',
        [*weights, *sway],
        material=f"fy=355 MPa, E=210 GPa, rho=7850 kg/m^3, Et={210.0 * hardening!r} GPa",
        kinematics=kinematics,
    )


def test_a_frame_of_two_storeys_follows_the_finite_elements() -> None:
    """Fibre beam elements that turn with their chords, within their own estimate and 1 % of the peak."""
    scene = two_storeys(0.02, "large")
    reference = pushover(scene, 3e-3)
    push = sim.push_over(scene, FINE, reference.displacement)
    assert push.unconverged == 0
    error = np.abs(push.load_at_distances - reference.load).max() / reference.load.max()
    assert error <= 0.01 + reference.error_estimate
    assert reference.error_estimate <= 3e-3


def portal(push: str, hardening: float, loads: Sequence[str] = ()) -> Scene:
    """4 m high, 6 m wide; sideways at the knee B, and half of it upwards or downwards at the beam's middle C."""
    nodes = {
        "A": (0.0, 0.0, "clamped"),
        "B": (0.0, 4.0, "free"),
        "C": (3.0, 4.0, "free"),
        "D": (6.0, 4.0, "free"),
        "E": (6.0, 0.0, "clamped"),
    }
    return frame_scene(
        nodes,
        [("A", "B"), ("B", "C"), ("C", "D"), ("E", "D")],
        f'[push]\nnode = "B"\ndirection = [1, 0]\n{push}',
        ['node = "B"\nforce = [1.0, 0.0]', 'node = "C"\nforce = [0.0, -0.5]', *loads],
        material=f"fy=235 MPa, E=210 GPa, rho=7850 kg/m^3, Et={210.0 * hardening!r} GPa",
        kinematics="large",
    )


def test_cycles_of_a_load_pattern_on_a_portal_that_hardens() -> None:
    """There, back, further, and unloaded: within 1 % of the largest load and the reference's own estimate."""
    weight = 'node = "C"\nforce = [0.0, -20000.0]\nkind = "dead"'
    scene = portal("turning_points = [0.1, -0.1, 0.12]\nunload = true", 0.01, [weight])
    reference = pushover(scene, 3e-3)
    push = sim.push_over(scene, Model("lobatto", 9, "fibre", 32), reference.displacement)
    assert push.unconverged == 0
    error = np.abs(push.load_at_distances - reference.load).max() / np.abs(reference.load).max()
    assert error <= 0.01 + reference.error_estimate


@pytest.mark.parametrize("law", sim.LAWS)
def test_neither_step_nor_iterations_matter_to_a_slow_push(law: str) -> None:
    """The same path within 0.3 % from 1/30 to 1/1000 s and for 2 or 30 iterations."""
    scene, way = portal("distance = 0.1", 0.0), np.linspace(0.0, 0.1, 51)
    loads = []
    for dt, iterations in ((1 / 1000, 2), (1 / 60, 2), (1 / 60, 30), (1 / 30, 2)):
        push = sim.push_over(scene, Model("lobatto", 5, law, dt=dt, iterations=iterations), way)
        assert push.unconverged == 0
        loads.append(push.load_at_distances[2:])
    assert max(np.abs(load - loads[0]).max() for load in loads) <= 3e-3 * loads[0].max()


def test_a_push_whose_node_runs_away_is_stopped_and_told() -> None:
    """Before its way grows to where numbers end; a warning would fail this test."""
    scene = two_storeys(0.01, "large")
    assembly = sim.assemble(scene, Model("lobatto", 3, "elastic-plastic"), shapes=False)
    node, way = assembly.nodes[scene.push.node], scene.push_direction()
    driver = LoadDriver(assembly, scene.push.node, way, reach=0.1)
    driver.aim(0.001, 1 / 60)
    assembly.step(1 / 60)
    driver.read(1 / 60)
    node.body.velocity = (1e200, 0.0)
    with pytest.raises(SolverError, match=r"left its way of 0\.1 m by 1\.667e\+198 m"):
        driver.read(1 / 60)
