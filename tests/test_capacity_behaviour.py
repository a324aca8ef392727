"""Capacities from a wanted behaviour, torsion, and the options that ask for them."""

import json
import math
from pathlib import Path

import pytest
from command_line import ductile
from hypothesis import given
from hypothesis import strategies as st

from capacity import InputError, catalogue, parse_material, parse_section, torsion_capacity
from capacity.behaviour import (
    Bridge,
    from_elastic_rotation,
    from_own_weight_share,
    from_plastic_share,
    lightest_for_bridge,
    reduced,
    stiffness_and_damping,
    sudden_plastic_rotation,
)
from capacity.torsion import heap_volume, plastic_torsion_modulus

RAMP_INERTIA, RAMP_WEIGHT = 58320.0, 2160.0 * 10.0 * 9.0


def test_the_papers_ramp() -> None:
    """1 Hz, 0.12 rad: k = 2.302 MN m/rad and M_max = 276.3 kN m, of which own weight uses 70 %."""
    k, c = stiffness_and_damping(1.0, 0.2, reduced(RAMP_INERTIA))
    assert k == pytest.approx(2.302e6, rel=1e-3)
    assert c == pytest.approx(2.0 * 0.2 * 2.0 * math.pi * RAMP_INERTIA)
    demand = from_elastic_rotation(k, 0.12)
    assert demand.value == pytest.approx(276.3e3, rel=1e-3)
    assert from_own_weight_share(RAMP_WEIGHT, 0.7).value == pytest.approx(demand.value, rel=0.01)


@given(ratio=st.floats(1.05, 1.99), k=st.floats(1e3, 1e8))
def test_sudden_load_without_damping_keeps_its_energy(ratio: float, k: float) -> None:
    """m (θ_e + θ_p) = M θ_e / 2 + M θ_p."""
    moment, M = 1e5, ratio * 1e5
    plastic = sudden_plastic_rotation(moment, M, k)
    elastic = M / k
    assert moment * (elastic + plastic) == pytest.approx(0.5 * M * elastic + M * plastic, rel=1e-6)


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.2])
def test_sudden_load_against_small_steps(damping: float) -> None:
    """The same motion by a thousand small steps a radian of phase, the moment capped."""
    m, M, k, inertia = 1.0, 1.2, 1.0, 1.0
    angle = speed = plastic = time = 0.0
    step = 1e-3
    while time < 1.0 or speed > 0.0:
        borne = k * (angle - plastic) + 2.0 * damping * speed
        if borne > M:
            plastic += (borne - M) / k
            borne = M
        speed += step * (m - borne) / inertia
        angle += step * speed
        time += step
    assert sudden_plastic_rotation(m, M, k, damping) == pytest.approx(max(0.0, angle - M / k), abs=5e-3)


def test_share_of_the_plastic_reserve() -> None:
    """The paper's ramp uses about 13 %; the capacity found uses just what was asked."""
    k, _ = stiffness_and_damping(1.0, 0.2, RAMP_INERTIA)
    demand = from_plastic_share(RAMP_WEIGHT, k, 0.4, 0.13, damping_ratio=0.1)
    assert sudden_plastic_rotation(RAMP_WEIGHT, demand.value, k, 0.1) == pytest.approx(0.13 * 0.4, rel=1e-6)
    # With the damping that the ramp's own turning gives, half of the joint's, the paper's M_max is close to it.
    assert demand.value == pytest.approx(276.3e3, rel=0.05)


def test_bridge_starts_to_turn_where_it_should() -> None:
    """Influence line of the moment at mid-span: W x / 2 for a vehicle at x before it."""
    bridge = Bridge(span=20.0, vehicle_weight=5e5, vehicle_at=8.0, joint_at=10.0)
    assert bridge.M_max().value == pytest.approx(5e5 * 8.0 / 2.0)
    assert bridge.M_max(1e3).value == pytest.approx(5e5 * 8.0 / 2.0 + 1e3 * 20.0**2 / 8.0)
    steel = parse_material("S355")
    entries = catalogue.family("HEB")
    choice = lightest_for_bridge(bridge, steel, entries)
    assert choice.Q_max > 5e5
    assert choice.M_max >= choice.demand_M.value
    for entry in entries:
        section = entry.section()
        if section.area < choice.section.area:
            shears = section.wall_area * 355e6 / math.sqrt(3.0) > 5e5
            needed = bridge.M_max(7850.0 * 9.81 * section.area).value
            assert not (shears and section.plastic_modulus * 355e6 >= needed), entry.name


def test_impossible_wishes_are_refused() -> None:
    with pytest.raises(InputError, match="no section bears"):
        lightest_for_bridge(Bridge(500.0, 1e7, 250.0, 250.0), parse_material("S235"), catalogue.family("IPE"))
    with pytest.raises(InputError, match="between the ends"):
        Bridge(10.0, 1e5, 12.0, 5.0)
    with pytest.raises(InputError, match="nothing to move"):
        reduced(math.inf)
    with pytest.raises(InputError, match="not between 0 and 1"):
        from_own_weight_share(1e5, 1.5)


@pytest.mark.parametrize(
    ("text", "tolerance"),
    [("rectangle 50x100 mm", 1e-3), ("circle 80 mm", 5e-3), ("CHS 168.3x8 mm", 5e-3), ("SHS 100x5 mm", 5e-3)],
)
def test_closed_forms_of_torsion_are_sand_heaps(text: str, tolerance: float) -> None:
    """b² (3h - b) / 6, π d³ / 12, π (d³ - d_i³) / 12 and 2 A_m t are twice the heap's volume."""
    section = parse_section(text)
    assert 2.0 * heap_volume(section.outline) == pytest.approx(plastic_torsion_modulus(section), rel=tolerance)


def test_torsion_of_a_square_with_a_square_hole() -> None:
    """A heap of side a with a level roof at depth t: V = ∫_0^t (a - 2s)² ds."""
    section = parse_section("polygon 0,0 100,0 100,100 0,100 hole 20,20 80,20 80,80 20,80 mm")
    expected = 2.0 * (100.0**3 - 60.0**3) / 6.0 * 1e-9
    assert plastic_torsion_modulus(section) == pytest.approx(expected, rel=1e-3)
    assert torsion_capacity(section, parse_material("S235"), "tresca") == pytest.approx(117.5e6 * expected, rel=1e-3)


def test_command_tells_which_rule_decided(capsys: pytest.CaptureFixture[str]) -> None:
    tokens = [
        "--largest-rotation",
        "0.12 rad",
        "--frequency",
        "1 Hz",
        "--inertia",
        "58320 kg m^2",
        "--damping-ratio",
        "0.2",
    ]
    tokens += ["--own-weight-moment", "194.4 kN m", "--own-weight-share", "70 %"]
    assert ductile("capacity", *tokens, "--json") == 0
    wanted = json.loads(capsys.readouterr().out)["wanted"]
    assert wanted["M_max"]["value"] == pytest.approx(194.4e3 / 0.7)
    assert "own weight" in wanted["M_max"]["rule"]
    assert len(wanted["M_max"]["all"]) == 2
    assert ductile("capacity", "--heaviest-vehicle", "50 t", "--span", "12 m", "--family", "HEB") == 0
    assert "HEB 600" in capsys.readouterr().out


def test_command_gives_the_whole_section(capsys: pytest.CaptureFixture[str]) -> None:
    tokens = ["--axial-force", "-235 kN", "--moment", "20 kN m", "--curvature", "0.01 1/m, 0.05 1/m, 0 1/m"]
    assert ductile("capacity", "rectangle 50x100 mm", *tokens, "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["M_N_over_M_max"] == pytest.approx(1.0 - 0.2**2, abs=1e-9)
    assert answer["inside"] is True
    assert answer["T_max"] == pytest.approx(235e6 / math.sqrt(3.0) * 0.05**2 * 0.25 / 6.0)
    assert answer["curve"]["rule"].startswith("fibres")
    assert answer["centroid"] == pytest.approx([0.025, 0.05])
    assert answer["plastic_centroid"] == pytest.approx([0.025, 0.05])
    assert answer["second_moment_y"] == pytest.approx(0.1 * 0.05**3 / 12.0)
    assert answer["at_break"]["hinge_length"] == pytest.approx(0.1)


def test_command_lists_a_family_and_draws(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert ductile("capacity", "--list", "IPE") == 0
    assert "IPE 300" in capsys.readouterr().out
    assert ductile("capacity", "--list", "upe", "--json") == 0
    assert json.loads(capsys.readouterr().out)[0]["name"] == "UPE 80"
    path = tmp_path / "curve.svg"
    assert ductile("capacity", "IPE 300", "--axial-force", "100 kN", "--plot", str(path), "--json") == 0
    assert "<svg" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("tokens", "fault"),
    [
        ([], "there is none"),
        (["--list", "IPX"], "no family"),
        (["IPE 300", "--thickness", "400 mm"], "beyond the 250 mm"),
        (["IPE 300", "--axial-force", "9 MN"], "exceeds"),
        (["--largest-rotation", "0.1 rad"], "neither it nor --frequency"),
        (["--largest-rotation", "0.1 rad", "--frequency", "1 Hz"], "--inertia"),
        (["--heaviest-vehicle", "50 t"], "--span"),
        (["--own-weight-share", "70 %"], "--own-weight-moment"),
        (["IPE 300", "--plot", "/nowhere/at/all.svg"], "cannot be written"),
        (["IPE 300", "--curvature", "0.1 kg"], "does not fit"),
    ],
)
def test_bad_options_end_with_2(tokens: list[str], fault: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert ductile("capacity", *tokens) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.startswith("ductile: ")
    assert error.count("\n") == 1
    assert fault in error
