"""The exact yield surface in N, Q and M, and its faceted form."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from capacity import InputError, Interaction, capacity, parse_material, parse_section

STEEL = parse_material("S235")
TEXTS = [
    "rectangle 50x100 mm",
    "IPE 300",
    "UPN 200",
    "CHS 168.3x8",
    "SHS 100x5",
    "T 150x150x7.1x10.7x15 mm",
    "L 100x100x10",
]
SURFACES = {text: Interaction(parse_section(text), STEEL) for text in TEXTS}
FACETS = {text: surface.facets() for text, surface in SURFACES.items()}


def test_rectangle_of_case_c4(case: Callable[[str], dict[str, Any]]) -> None:
    """M_N / M_p = 1 - n², closed form."""
    surface = SURFACES["rectangle 50x100 mm"]
    for row in case("C4-rect")["outputs"]["rows"]:
        greatest = surface.moments_at(-row["n"] * surface.N_max)[1]
        assert greatest / surface.M_max == pytest.approx(row["M_plN_over_Mp"], abs=1e-12)
        assert greatest == pytest.approx(row["M_plN_Nm"], rel=1e-12)


@given(n=st.floats(-1.0, 1.0))
def test_thin_tube(n: float) -> None:
    """M_N / M_p = cos(π n / 2) for a thin tube, closed form."""
    surface = Interaction(parse_section("CHS 1000x0.01 mm"), STEEL)
    assert surface.moments_at(n * surface.N_max)[1] / surface.M_max == pytest.approx(
        math.cos(0.5 * math.pi * n), abs=1e-4
    )


@given(n=st.floats(-0.99, 0.99), q=st.floats(0.0, 0.99))
def test_rectangle_with_shear(n: float, q: float) -> None:
    """The whole section at fy √(1 - q²): M_N / M_p = √(1 - q²) - n² / √(1 - q²)."""
    surface, left = SURFACES["rectangle 50x100 mm"], math.sqrt(1.0 - q * q)
    if abs(n) > left:
        with pytest.raises(InputError, match="axial force"):
            surface.moments_at(n * surface.N_max, q * surface.Q_max)
    else:
        found = surface.moments_at(n * surface.N_max, q * surface.Q_max)[1] / surface.M_max
        assert found == pytest.approx(left - n * n / left, abs=1e-9)


def test_shear_takes_the_web_of_an_i_section_alone() -> None:
    """At Q_max the flanges are left: N = fy (A - A_web), M = M_p - fy A_web d / 4 with the web's depth d."""
    section, surface = parse_section("IPE 300"), SURFACES["IPE 300"]
    web, depth = section.wall_area, 0.3 - 0.0107
    assert surface.axial_at(surface.Q_max) == pytest.approx(235e6 * (section.area - web), rel=1e-12)
    assert surface.moments_at(0.0, surface.Q_max)[1] == pytest.approx(
        surface.M_max - 235e6 * web * depth / 4, rel=1e-12
    )


@pytest.mark.parametrize("text", TEXTS)
def test_corners_of_the_surface_are_the_capacities(text: str) -> None:
    surface, c = SURFACES[text], capacity(parse_section(text), STEEL)
    assert surface.N_max == pytest.approx(c.N_max, rel=1e-12)
    assert surface.Q_max == pytest.approx(c.Q_max, rel=1e-12)
    assert surface.moments_at(0.0) == pytest.approx((-c.M_max, c.M_max), rel=1e-10)


@pytest.mark.parametrize("text", TEXTS)
@settings(max_examples=8)
@given(data=st.data())
def test_the_region_is_convex(text: str, data: st.DataObject) -> None:
    """The middle of two states on the surface is borne."""
    surface = SURFACES[text]
    ends = []
    for _ in range(2):
        n, q, m = (data.draw(st.floats(-1.0, 1.0)) for _ in range(3))
        if abs(n) + abs(q) + abs(m) < 1e-3:
            n = 1.0
        state = np.array([n * surface.N_max, q * surface.Q_max, m * surface.M_max])
        ends.append(surface.load_factor(*state) * state)
    assert surface.load_factor(*(0.4999999 * (ends[0] + ends[1]) + 1e-9 * ends[0])) >= 1.0


STATES = [
    (0.5, 0.5, 0.25),
    (0.0, 0.5, 0.25),
    (-0.3, 0.2, 0.7),
    (0.4, 0.9, -0.3),
    (1.0, 0.0, 0.0),
    (0.1, 0.8, 0.9),
    (0, 0, -1),
]


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("shares", STATES)
def test_facets_stay_inside_by_no_more_than_they_say(text: str, shares: tuple[float, float, float]) -> None:
    surface, facets = SURFACES[text], FACETS[text]
    state = np.array(shares) * (surface.N_max, surface.Q_max, surface.M_max)
    used = float(facets.value(*state)) * surface.load_factor(*state)
    assert 1.0 - 1e-3 <= used <= 1.0 + facets.error + 1e-3
    assert facets.error < 0.03


@given(scale=st.floats(0.01, 100.0))
def test_facets_are_homogeneous(scale: float) -> None:
    facets = FACETS["IPE 300"]
    one = facets.value(1e5, 5e4, 6e4)
    assert facets.value(scale * 1e5, scale * 5e4, scale * 6e4) == pytest.approx(scale * one, rel=1e-12)


def test_more_facets_are_closer() -> None:
    surface = SURFACES["rectangle 50x100 mm"]
    errors = [surface.facets(count).error for count in (16, 32, 64, 128)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < errors[0] / 8.0


@pytest.mark.parametrize("text", TEXTS)
def test_curve_goes_through_the_moments_beside_a_force(text: str) -> None:
    surface = SURFACES[text]
    N, M = surface.curve(41, 0.5 * surface.Q_max)
    for force, moment in zip(N[2:39:6], M[2:39:6], strict=True):
        assert surface.moments_at(float(force), 0.5 * surface.Q_max)[1] == pytest.approx(
            moment, abs=1e-7 * surface.M_max
        )


def test_states_beyond_the_surface_are_told() -> None:
    surface = SURFACES["IPE 300"]
    assert surface.bears(0.0, 0.0, 0.999 * surface.M_max)
    assert not surface.bears(0.0, 0.0, 1.001 * surface.M_max)
    assert not surface.bears(0.0, 1.001 * surface.Q_max, 0.0)
    assert surface.load_factor(0.0, 0.0, 0.5 * surface.M_max) == pytest.approx(2.0, rel=1e-9)
    with pytest.raises(InputError, match="all are zero"):
        surface.load_factor(0.0, 0.0, 0.0)
    with pytest.raises(InputError, match="exceeds Q_max"):
        surface.moments_at(0.0, 2.0 * surface.Q_max)
