"""Pushes in which forces turn with what they act on: P–Δ, nothing of it, and all of it without a step's lag."""

import math

import msgspec
import numpy as np
import pytest
from frames import compressed_cantilever, frame_scene, frame_text, push_down

import sim
from calibration.comparable_push import push_model
from calibration.export import joint_table
from scene import Scene, parse_scene
from sim import Model, assemble
from sim.settling import settle

MODEL = Model("lobatto", 14, "elastic-plastic")
STRONG = "fy=1e6 MPa, E=210 GPa, rho=7850 kg/m^3"
LENGTH = 2.0


def column(share: float, kinematics: str) -> tuple[Scene, float]:
    """An elastic cantilever under ``share`` of Euler's load π² EI / 4 L² along it, and EI."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (LENGTH, 0.0, "free")}
    bare = frame_scene(nodes, [("A", "B")], push_down("B", 0.02), section="rectangle 50x60 mm", material=STRONG)
    EI = bare.capacity("A-B").EI
    along = f'node = "B"\nforce = [{-share * math.pi**2 * EI / (4.0 * LENGTH**2)!r}, 0.0]\nkind = "dead"'
    return frame_scene(
        nodes,
        [("A", "B")],
        push_down("B", 0.02),
        [along],
        section="rectangle 50x60 mm",
        material=STRONG,
        kinematics=kinematics,
    ), EI


def stiffness(scene: Scene) -> float:
    way = np.linspace(0.0, 0.02, 21)
    push = push_model(scene, MODEL, way)
    assert push.unconverged == 0
    return float(push.load_at_distances[-1] / way[-1])


@pytest.mark.parametrize("share", [-3.0, -0.5, 0.3, 0.8])
def test_p_delta_is_that_of_the_beam_column(share: float) -> None:
    """P / δ = N k / (tan kL - kL) under compression, N k / (kL - tanh kL) in tension, k² = N / EI (Timoshenko & Gere,
    Theory of elastic stability, chapter 1)."""
    scene, EI = column(share, "p-delta")
    N = abs(share) * math.pi**2 * EI / (4.0 * LENGTH**2)
    k = math.sqrt(N / EI)
    turned = math.tan(k * LENGTH) - k * LENGTH if share > 0.0 else k * LENGTH - math.tanh(k * LENGTH)
    exact = N * k / turned
    assert stiffness(scene) == pytest.approx(exact, abs=2e-3 * max(exact, 3.0 * EI / LENGTH**3))


@pytest.mark.parametrize("N", [-300e3, 300e3])
def test_shear_flexibility_adds_to_p_delta(N: float) -> None:
    """An IPE 200 of 1 m, by Engesser (1891): with b = 1 / (1 + N / GA_s) and k² = b |N| / EI the deflection for a unit
    of load is (b tan kL / k - L) / |N| under compression, (L - b tanh kL / k) / N in tension; without shear's part in
    it, 0.6 % more or less."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (1.0, 0.0, "free")}
    along = f'node = "B"\nforce = [{N!r}, 0.0]\nkind = "dead"'
    options = {"section": "IPE 200", "material": STRONG, "kinematics": "p-delta"}
    text = frame_text(nodes, [("A", "B")], push_down("B", 5e-3), [along], **options)
    scene = parse_scene(text.replace('theory = "euler-bernoulli"', ""), "test")
    c = scene.capacity("A-B")
    b = 1.0 / (1.0 + N / c.GA_s)
    k = math.sqrt(b * abs(N) / c.EI)
    turned = b * (math.tan(k) if N < 0.0 else math.tanh(k)) / k
    exact = N / (1.0 - turned)
    push = push_model(scene, MODEL, np.linspace(0.0, 5e-3, 21))
    assert push.load_at_distances[-1] / 5e-3 == pytest.approx(exact, rel=1.5e-3)


@pytest.mark.parametrize("share", [-3.0, 0.8])
def test_small_displacements_know_nothing_of_axial_forces(share: float) -> None:
    scene, EI = column(share, "small")
    assert stiffness(scene) == pytest.approx(3.0 * EI / LENGTH**3, rel=5e-4)


def test_a_yielding_column_falls_the_same_way_at_any_step() -> None:
    """Half of N_pl on a cantilever that is bent until it carries nothing across: one lag of a step would be 2 %."""
    scene, way = compressed_cantilever(0.5, 0.045, "large"), np.linspace(0.0, 0.045, 91)
    loads = [
        sim.push_over(scene, Model("lobatto", 6, "fibre", 12, dt=dt), way).load_at_distances for dt in (1 / 60, 1 / 480)
    ]
    assert np.abs(loads[0] - loads[1]).max() <= 3e-3 * loads[1].max()
    assert loads[1][-1] < 0.5 * loads[1].max()


def test_a_support_that_settles_bends_the_beam_that_it_clamps() -> None:
    """M = 6 EI Δ / L² at both ends, Q = 12 EI Δ / L³; and it stays there."""
    nodes = {"A": (0.0, 0.0, "clamped"), "C": (1.0, 0.0, "free"), "B": (LENGTH, 0.0, "clamped")}
    level = frame_scene(nodes, [("A", "C"), ("C", "B")], push_down("C", 0.01), section="rectangle 50x60 mm")
    sunk = msgspec.structs.replace(level.nodes["B"], settlement=(0.0, -1e-3))
    scene = msgspec.structs.replace(level, nodes={**level.nodes, "B": sunk})
    assembly = assemble(scene, MODEL, shapes=False)
    settle(scene, assembly, 1e-10)
    EI = scene.capacity("A-C").EI
    first, last = assembly.structure.force[[0, len(assembly.places) - 1]]
    assert [-first[2], last[2]] == pytest.approx([6.0 * EI * 1e-3 / LENGTH**2] * 2, rel=3e-3)
    assert abs(first[1]) == pytest.approx(12.0 * EI * 1e-3 / LENGTH**3, rel=3e-3)
    assert assembly.nodes["B"].now() == pytest.approx((LENGTH, -1e-3), abs=1e-6)
    table = joint_table(scene, MODEL)["joints"]
    held = [joint for joint in table if joint["a"] == "ground" and joint["at"] == [LENGTH, 0.0]]
    assert [joint["anchor_a"] for joint in held] == [[LENGTH, -1e-3]]
