"""Variants of the principal scenes: cantilevers, posts, fence and rod, with numbers from statics and dynamics."""

import math

import pytest
from scipy.optimize import brentq
from test_sim_world import run

from scene import builtin_text
from sim import energy
from sim.world import World

G = 10.0
# The steel beam of 20 x 2 x 1 m.
WEIGHT, STIFFNESS, M_MAX = 7800.0 * 2.0 * G, 210e9 * 8.0 / 12.0, 350e6


def test_a_cantilever_of_equal_pieces_sags_by_one_plus_one_over_n_squared() -> None:
    """q L⁴ / 8 EI with the trapezoidal rule's error, its next term included: there is none."""
    _, found = run("beam-in-pieces")
    for n in range(1, 7):
        exact = WEIGHT * 20.0**4 / (8.0 * STIFFNESS) * (1.0 + 1.0 / n**2)
        assert found[f"sag of {n} piece{'s' if n > 1 else ''}"] == pytest.approx(exact, rel=1e-4)
    assert found["joints that yielded"] == 0.0


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_a_box_of_ten_thousand_tonnes_rests_on_pieces_of_78_t(dt: float) -> None:
    """Own weight and box, q L² / 2 + 17 m · 100 MN, and nothing creeps."""
    _, found = run("loaded-cantilever", dt)
    assert found["moment at the wall"] == pytest.approx(-(WEIGHT * 200.0 + 1e8 * 17.0), rel=1e-4)
    assert found["joints that yielded"] == 0.0
    assert found["box moved by"] < 2e-3
    assert found["box's speed in the end"] < 1e-6


def test_80_m_fall_by_the_same_angle_in_one_piece_and_in_four() -> None:
    """Rigid–plastic: m g L / 2 sin(θ) = M_max θ, θ = 1.407 rad."""
    half_moment = WEIGHT * 80.0**2 / 2.0
    exact = brentq(lambda angle: half_moment * math.sin(angle) - M_MAX * angle, 1.0, 2.0)
    world, found = run("long-cantilevers")
    assert found["plastic rotation of one piece"] == pytest.approx(exact, rel=2e-3)
    assert found["plastic rotation of four pieces"] == pytest.approx(exact, rel=2e-3)
    assert found["joints that yielded"] == 2.0
    assert world.broken == []


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240, 1 / 1000])
def test_a_dropped_box_turns_the_root_by_what_is_left_of_its_energy(dt: float) -> None:
    """One plastic blow and one hinge: ½ (m v a)² / I + (W a + q L² / 2) sin(θ) = M_max θ, θ = 0.47 rad.

    The beam takes some of it elastically and loses some at further contacts, so the root turns by a twentieth less.
    pymunk moves bodies before it speeds them up, so they fall half a step late; it sees a contact within a step.
    """
    mass, arm, beam = 500e3, 17.0, 7800.0 * 2.0 * 20.0**3 / 3.0
    momentum = mass * math.sqrt(2.0 * G * 29.0) * arm
    kinetic, weight = 0.5 * momentum**2 / (beam + mass * arm**2), mass * G * arm + WEIGHT * 200.0
    rigid = brentq(lambda angle: kinetic + weight * math.sin(angle) - M_MAX * angle, 0.1, 1.5)
    assert rigid == pytest.approx(0.473, abs=1e-3)
    world, found = run("dropped-box", dt)
    assert found["rotation of the root"] == pytest.approx(0.95 * rigid, rel=0.05)
    assert found["box hits the beam"] == pytest.approx(math.sqrt(2.0 * 29.0 / G), abs=1.5 * dt + 1e-3)
    assert found["joints broken"] == 0.0
    assert abs(energy(world.space).gap) < 1e-6 * energy(world.space).external


def test_a_joint_of_10_hz_lets_80_m_swing_about_its_root() -> None:
    """θ = M / k with k = (2π f)² I; let go, it goes beyond that by exp(-π ζ' / √(1 - ζ'²)), ζ' = ζ √(I / I_root)."""
    mass = 7800.0 * 160.0
    inertia = mass * (80.0**2 + 2.0**2) / 12.0
    rest = mass * G * 40.0 / ((2.0 * math.pi * 10.0) ** 2 * inertia)
    ratio = 0.2 * math.sqrt(inertia / (inertia + mass * 40.0**2))
    beyond = math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio**2))
    _, found = run("elastic-cantilever")
    assert -found["rotation at rest"] == pytest.approx(rest, rel=1e-3)
    assert -found["largest rotation"] == pytest.approx(rest * (1.0 + beyond), rel=0.02)
    assert found["joints that yielded"] == 0.0


POST_AND_BALL, FOOT = 36.0 * 3.0**2 / 3.0 + 200.0 * 1.4**2, 15.1e3


def after_the_blow(speed: float) -> float:
    """Angular speed of post and ball about the foot [rad/s]."""
    return 200.0 * speed * 1.4 / POST_AND_BALL


@pytest.mark.parametrize(("name", "speed"), [("post-holds", 5.0), ("post-bends", 10.0)])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_a_post_stops_a_ball_as_its_foot_bends(name: str, speed: float, dt: float) -> None:
    """½ I ω² = M_max θ."""
    _, found = run(name, dt)
    bend = 0.5 * POST_AND_BALL * after_the_blow(speed) ** 2 / FOOT
    assert found["foot broken"] == 0.0
    assert found["plastic rotation of the foot"] == pytest.approx(bend, rel=0.05)
    assert found["ball is at x ="] < 0.5


@pytest.mark.parametrize("speed", [10.0, 20.0, 30.0])
def test_a_brittle_post_breaks_and_lets_the_ball_on(speed: float) -> None:
    """√(ω² - 2 M_max 0.2 / I) at the height of the ball."""
    text = builtin_text("post-impact").replace('"30 m/s"', f'"{speed} m/s"')
    _, found = run(text, duration=0.5)
    assert found["foot broken"] == 1.0
    left = 1.4 * math.sqrt(after_the_blow(speed) ** 2 - 2.0 * FOOT * 0.2 / POST_AND_BALL)
    assert found["ball's speed behind the post"] == pytest.approx(left, rel=0.1)


def test_the_fence_yields_at_its_ends_only() -> None:
    """M_max there, q L² / 8 - M_max in the middle; the ends turn by q L³ / 24 EI - M_max L / 2 EI."""
    world, found = run("fence")
    weight, stiffness, most = 2058.0 * 6.0 * G, 2e9 * 2.0 * 3.0**3 / 12.0, 9e6
    moments = [joint.force[2] for joint in world.joints["fence"]]
    assert [moments[0], moments[2], moments[-1]] == pytest.approx(
        [-most, weight * 30.0**2 / 8.0 - most, -most], rel=1e-3
    )
    assert found["joints that own weight makes yield"] == 2.0
    turned = weight * 30.0**3 / (24.0 * stiffness) - most * 30.0 / (2.0 * stiffness)
    assert found["plastic rotation of the ends"] == pytest.approx(turned, rel=0.02)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_the_rod_yields_at_its_foot_first_and_stops_the_lorry(dt: float) -> None:
    """M_max = 243 kN m; of 50 t at 1.48 m/s and their wheels it takes what the blow on pieces of 2 t leaves."""
    from scene import load_scene

    world = World(load_scene("rod"), dt)
    first: list[str] = []
    while not world.finished:
        world.step()
        first = first or [label for joint, label in world.labels.items() if joint.plastic_deformation[3] > 0.0]
        assert all(abs(joint.force[2]) < 243e3 * (1.0 + 1e-6) for joint in world.labels)
    found = world.results()
    assert "rod 1" in first
    brought = (0.5 * 50e3 + 1000.0) * found["lorry's speed before the rod"] ** 2  # type: ignore[operator]
    assert found["plastic work in the rod"] < brought  # type: ignore[operator]
    # In steps of 1/500 s.
    assert found["plastic work in the rod"] == pytest.approx(35.8e3, rel=0.03)
    assert found["largest plastic rotation"] == pytest.approx(0.0497, rel=0.03)
    assert found["joints broken"] == 0.0
    assert found["lorry is at x ="] < -3.0  # type: ignore[operator]
