"""Stress–strain laws, moment and curvature, and what breaks."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import (
    InputError,
    StressStrain,
    capacity,
    moment_curvature,
    moment_history,
    parse_material,
    parse_section,
    rotation_capacity,
)

EPP = parse_material("fy=235 MPa, E=210 GPa")
HARD = parse_material("S355, Et=2.1 GPa")
TABLE = parse_material("curve=0.001:200 0.01:250 0.1:400 MPa")
RECTANGLE = parse_section("rectangle 50x100 mm")
KAPPA_Y = 235e6 / 210e9 / 0.05
BEARS, HARD_BEARS = capacity(RECTANGLE, EPP), capacity(RECTANGLE, HARD)


def test_rectangle_with_axial_force_of_case_c4(case: Callable[[str], dict[str, Any]]) -> None:
    for row in case("C4-rect")["outputs"]["rows"]:
        curve = moment_curvature(RECTANGLE, EPP, KAPPA_Y * np.array(row["kappa_over_ky"]), -row["n"] * 1.175e6)
        np.testing.assert_allclose(curve.moment, row["M_Nm"], rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "text"),
    [("C1-rect", "rectangle 50x100 mm"), ("C1-ipe300", "I 300x150x7.1x10.7 mm"), ("C1-chs", "CHS 168.3x8 mm")],
)
def test_moments_and_curvatures_of_group_1(name: str, text: str, case: Callable[[str], dict[str, Any]]) -> None:
    """M_y, M_p and κ_y = 3 δ_y / L² of the cantilevers."""
    inputs, outputs = case(name)["inputs"], case(name)["outputs"]
    section = parse_section(text)
    c = capacity(section, EPP)
    assert c.M_yield == pytest.approx(inputs["My_Nm"], rel=1e-9)
    assert c.M_max == pytest.approx(inputs["Mp_Nm"], rel=1e-9)
    kappa = 3.0 * outputs["delta_y_m"] / inputs["L_m"] ** 2
    assert c.M_yield / c.EI == pytest.approx(kappa, rel=1e-9)
    curve = moment_curvature(section, EPP, [kappa, 1e4 * kappa])
    np.testing.assert_allclose(curve.moment, [inputs["My_Nm"], inputs["Mp_Nm"]], rtol=1e-6)


@given(ratio=st.floats(1.0, 1e3))
def test_rectangle_beyond_yield(ratio: float) -> None:
    """M / M_y = 3/2 - 1/2 (κ_y / κ)² (Gere & Goodno, Mechanics of Materials, 8th ed., section 6.10)."""
    moment = moment_curvature(RECTANGLE, EPP, [ratio * KAPPA_Y]).moment[0]
    assert moment / (235e6 * 0.05 * 0.1**2 / 6.0) == pytest.approx(1.5 - 0.5 / ratio**2, rel=1e-10)


@pytest.mark.parametrize("text", ["IPE 300", "UPN 200", "L 100x100x10", "T 150x150x7.1x10.7x15 mm"])
@pytest.mark.parametrize("material", [EPP, HARD, TABLE], ids=["perfectly plastic", "hardening", "table"])
def test_fibres_and_exact_integration_agree_on_first_loading(text: str, material: Any) -> None:
    section = parse_section(text)
    kappa = np.linspace(0.0, 0.15, 16)
    exact, fibres = (f(section, material, kappa, -1e5) for f in (moment_curvature, moment_history))
    np.testing.assert_allclose(fibres.moment, exact.moment, atol=2e-3 * exact.moment.max())


@pytest.mark.parametrize(
    ("text", "bound"),
    [
        ("rectangle 50x100 mm", 6e-3),
        ("IPE 300", 3e-3),
        ("HEB 200", 4e-3),
        ("CHS 168.3x8 mm", 4e-3),
        ("RHS 200x100x8 mm", 7e-3),
        ("circle 80 mm", 8.5e-3),
        ("UPN 200", 4e-3),
        ("L 100x100x10", 4e-3),
        ("T 150x150x10x15 mm", 4e-3),
    ],
)
@pytest.mark.parametrize("n", [-0.5, 0.0, 0.2])
def test_sixteen_fibres_follow_the_exact_curve(text: str, bound: float, n: float) -> None:
    """To within a share of M_p wherever the stress is zero, bent either way."""
    section = parse_section(text)
    once = np.geomspace(0.5, 30.0, 40) * EPP.yield_stress / (EPP.youngs_modulus * section.depth / 2.0)
    force, full = n * section.area * EPP.yield_stress, section.plastic_modulus * EPP.yield_stress
    for kappa in (once, -once):
        exact = moment_curvature(section, EPP, kappa, force).moment
        fibres = moment_history(section, EPP, kappa, force, fibres=16).moment
        assert np.abs(fibres - exact).max() <= bound * full


@pytest.mark.parametrize("material", [EPP, HARD, TABLE], ids=["perfectly plastic", "hardening", "table"])
@given(kappa=st.floats(0.001, 0.3), n=st.floats(-0.8, 0.8))
def test_turning_the_moment_round_mirrors_the_curve(material: Any, kappa: float, n: float) -> None:
    section, N = parse_section("T 150x150x7.1x10.7x15 mm"), n * 2690e-6 * 200e6
    up = moment_curvature(section, material, [kappa], N).moment[0]
    down = moment_curvature(section.rotated(math.pi), material, [-kappa], N).moment[0]
    assert down == pytest.approx(-up, rel=1e-9)


def test_unloading_is_elastic_and_twice_as_long() -> None:
    """Masing: from (κ, M) back by twice the strain of first loading; M returns with the slope EI."""
    c = capacity(RECTANGLE, EPP)
    path = KAPPA_Y * np.array([3.0, 2.0, 1.0, -3.0])
    moment = moment_history(RECTANGLE, EPP, path).moment
    np.testing.assert_allclose(np.diff(moment)[:2], -c.EI * KAPPA_Y, rtol=1e-4)
    first = moment_curvature(RECTANGLE, EPP, [3.0 * KAPPA_Y]).moment[0]
    assert moment[0] == pytest.approx(first, rel=1e-4)
    assert moment[-1] == pytest.approx(-first, rel=1e-4)


@given(st.lists(st.floats(-0.2, 0.2), min_size=2, max_size=12))
def test_a_closed_cycle_never_gives_work_back(path: list[float]) -> None:
    kappa = np.concatenate([np.linspace(a, b, 6)[1:] for a, b in zip([0.0, *path], [*path, 0.0], strict=True)])
    for material, c in ((EPP, BEARS), (HARD, HARD_BEARS)):
        curve = moment_history(RECTANGLE, material, kappa, fibres=16)
        mean = 0.5 * (curve.moment + np.concatenate([[0.0], curve.moment[:-1]]))
        work = np.sum(mean * np.diff(np.concatenate([[0.0], kappa])))
        stored = curve.moment[-1] ** 2 / (2.0 * c.EI)
        assert work >= -stored - 0.02 * c.M_max * 0.05


def test_a_curve_that_grows_steeper_does_not_say_how_to_unload() -> None:
    plateau = parse_material("curve=0.001:200 0.02:200 0.1:300 MPa")
    assert moment_curvature(RECTANGLE, plateau, [0.5]).moment[0] > 0.0
    with pytest.raises(InputError, match="steeper"):
        moment_history(RECTANGLE, plateau, [0.5])


def test_axial_force_beyond_full_yield_is_refused() -> None:
    with pytest.raises(InputError, match="full yield"):
        moment_curvature(RECTANGLE, EPP, [0.01], 1.2e6)


@given(strain=st.floats(-0.2, 0.2))
def test_laws_in_closed_form(strain: float) -> None:
    size, sign = abs(strain), math.copysign(1.0, strain)
    bilinear = StressStrain.bilinear(200e9, 400e6, 2e9)
    assert bilinear.stress(strain) == pytest.approx(sign * min(200e9 * size, 400e6 + 2e9 * (size - 0.002)), rel=1e-12)
    table = StressStrain.table([(0.001, 200e6), (0.01, 250e6), (0.1, 400e6)])
    expected = np.interp(size, [0.0, 0.001, 0.01, 0.1], [0.0, 200e6, 250e6, 400e6])
    assert table.stress(strain) == pytest.approx(sign * expected, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("curve=0.001:200 MPa 0.002:100", "curve"),
        ("curve=0.001:200 0.002:100 MPa", "must not fall"),
        ("curve=0.002:200 0.001:300 MPa", "must ascend"),
        ("curve= MPa", "at least one point"),
        ("S235, eu=0.01 %", "less than the strain at first yield"),
        ("S235, t=1 m", "beyond the 250 mm"),
        ("S235, colour=2", "none of"),
        ("concrete with 0 % steel", "share of 0"),
        ("concrete with 500 % steel", "share of 5"),
    ],
)
def test_bad_laws_are_refused(text: str, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        parse_material(text)


@pytest.mark.parametrize(
    ("text", "thickness", "fy"),
    [("S235", 0.016, 235e6), ("S235", 0.03, 225e6), ("S355", 0.05, 335e6), ("S460", 0.1, 400e6), ("S355", None, 355e6)],
)
def test_yield_stress_falls_with_thickness(text: str, thickness: float | None, fy: float) -> None:
    """EN 10025-2:2019, Table 6, and EN 10025-3:2019."""
    assert parse_material(text, thickness=thickness).yield_stress == fy


def test_concrete_with_a_share_of_steel() -> None:
    """The Demolisher's bridge: 25 × 0.4375 × 9 m, 5 % steel: M = 4.31 MN m, N = 39.4 MN, 56.4 t a quarter."""
    material, section = parse_material("concrete with 5 % steel"), parse_section("rectangle 9000x437.5 mm")
    c = capacity(section, material)
    assert pytest.approx(4.31e6, rel=1e-3) == c.M_max
    assert pytest.approx(39.4e6, rel=1e-3) == c.N_max
    assert material.density * section.area * 25.0 / 4.0 == pytest.approx(56.4e3, rel=1e-3)


@given(ultimate=st.floats(0.01, 0.3), length=st.floats(0.01, 2.0))
def test_rotation_at_break_of_a_rectangle(ultimate: float, length: float) -> None:
    """κ_u = 2 ε_u / h, θ_p = (κ_u - M_u / EI) L_h, elongation (ε_u - fy / E) L_h."""
    material = parse_material(f"fy=235 MPa, E=210 GPa, eu={ultimate!r}")
    found = rotation_capacity(RECTANGLE, material, length)
    ratio = 2.0 * ultimate / 0.1 / KAPPA_Y
    bent_back = KAPPA_Y * (1.5 - 0.5 / ratio**2)
    assert found.ultimate_curvature == pytest.approx(2.0 * ultimate / 0.1, rel=1e-9)
    assert found.plastic_rotation == pytest.approx((2.0 * ultimate / 0.1 - bent_back) * length, rel=1e-8)
    assert found.elongation == pytest.approx((ultimate - 235e6 / 210e9) * length, rel=1e-12)


def test_no_rotation_without_an_ultimate_strain() -> None:
    with pytest.raises(InputError, match="no ultimate strain"):
        rotation_capacity(RECTANGLE, EPP)
    with pytest.raises(InputError, match="not greater than zero"):
        rotation_capacity(RECTANGLE, HARD, -1.0)
