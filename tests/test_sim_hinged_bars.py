"""Bars between hinges, and a strip that a moment rolls up: closed forms at displacements of any size."""

import math

import numpy as np
import pytest

import sim
from scene import parse_scene
from sim import Model

NINE = Model("lobatto", 9, "fibre", 16)
AREA, E, FY, ET = math.pi * (0.0761**2 - 0.0681**2) / 4.0, 210e9, 235e6, 2.1e9


def bars(direction: int, distance: float) -> str:
    """Two bars of tube from pins at x = 0 and 4 m to a hinge at (2, 1), which is pushed; they harden."""
    return f"""
    title = "two bars"
    gravity = 0.0
    kinematics = "large"
    nodes.A = {{ at = [0.0, 0.0], support = "pinned" }}
    nodes.B = {{ at = [2.0, 1.0] }}
    nodes.C = {{ at = [4.0, 0.0], support = "pinned" }}
    [members.left]
    from = "A"
    to = "B"
    section = "CHS 76.1x4 mm"
    material = "fy=235 MPa, E=210 GPa, rho=7850 kg/m^3, Et=2.1 GPa"
    releases = ["to"]
    [members.right]
    from = "B"
    to = "C"
    section = "CHS 76.1x4 mm"
    material = "fy=235 MPa, E=210 GPa, rho=7850 kg/m^3, Et=2.1 GPa"
    releases = ["from"]
    [push]
    node = "B"
    direction = [0, {direction}]
    distance = {distance!r}
    """


def force_of_two_bars(up: np.ndarray) -> np.ndarray:
    """F = 2 N (1 + d) / ℓ, N of the bars' strain, bilinear, on first loading [N]."""
    length = np.hypot(2.0, 1.0 + up)
    strain = length / math.sqrt(5.0) - 1.0
    stress = np.where(np.abs(strain) < FY / E, E * strain, np.sign(strain) * (FY + ET * (np.abs(strain) - FY / E)))
    return np.asarray(2.0 * AREA * stress * (1.0 + up) / length)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 1000])
def test_a_node_of_hinges_alone_pulls_its_bars_far_beyond_yield(dt: float) -> None:
    """Nothing holds the node against turning. The bars harden alike from end to end, hinges included; 0.2 %."""
    way = np.linspace(0.0, 0.06, 61)
    push = sim.push_over(parse_scene(bars(1, 0.06), "bars"), Model("lobatto", 9, "fibre", 16, dt=dt), way)
    expected = force_of_two_bars(way)
    assert push.unconverged == 0
    assert np.abs(push.load_at_distances - expected).max() <= 2e-3 * expected.max()


def test_pushed_bars_give_the_elastic_load_of_the_turned_geometry() -> None:
    way = np.linspace(0.0, 0.004, 21)
    push = sim.push_over(parse_scene(bars(-1, 0.004), "bars"), NINE, way)
    expected = -force_of_two_bars(-way)
    assert np.abs(push.load_at_distances - expected).max() <= 2e-3 * expected.max()


def test_a_strip_is_bent_into_an_arc_by_a_moment_at_its_tip() -> None:
    """Sag (1 - cos θ) L / θ of an arc of θ = M L / EI up to 1.9 rad; the node is where the push shall bring it."""
    scene = parse_scene(
        """
        title = "strip"
        gravity = 0.0
        kinematics = "large"
        nodes.A = { at = [0.0, 0.0], support = "clamped" }
        nodes.B = { at = [1.0, 0.0] }
        [members.strip]
        from = "A"
        to = "B"
        section = "rectangle 4x5 mm"
        material = "fy=1e6 MPa, E=210 GPa, rho=7850 kg/m^3"
        theory = "euler-bernoulli"
        [[loads]]
        node = "B"
        moment = -1.0
        [push]
        node = "B"
        direction = [0, -1]
        distance = 0.7
        """,
        "strip",
    )
    turns = np.linspace(0.05, 1.928, 40)
    sags = (1.0 - np.cos(turns)) / turns
    push = sim.push_over(scene, NINE, np.concatenate([[0.0], sags]))
    moments = turns * E * 0.004 * 0.005**3 / 12.0
    assert push.displacement[-1] == pytest.approx(sags[-1], rel=2e-4)
    assert np.abs(push.load_at_distances[1:] - moments).max() <= 3e-3 * moments.max()
