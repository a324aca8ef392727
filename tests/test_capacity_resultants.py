import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import InputError, capacity, parse_material, parse_section
from capacity.units import to_si


@given(b=st.floats(1.0, 1000.0), h=st.floats(1.0, 1000.0), fy=st.floats(10.0, 1000.0))
@pytest.mark.parametrize(("criterion", "share"), [("tresca", 0.5), ("von-mises", 1.0 / math.sqrt(3.0))])
def test_rectangle_of_the_papers_table_1(criterion: str, share: float, b: float, h: float, fy: float) -> None:
    """N = b h fy, Q = 0.5 (0.577) b h fy, M = 0.25 b h² fy: Nikula, Mikkola & Björk, Table 1."""
    c = capacity(parse_section(f"rectangle {b!r}x{h!r} mm"), parse_material(f"fy={fy!r} MPa"), criterion)
    b, h, fy = 1e-3 * b, 1e-3 * h, 1e6 * fy
    assert c.N_max == pytest.approx(b * h * fy, rel=1e-12)
    assert c.Q_max == pytest.approx(share * b * h * fy, rel=1e-12)
    assert c.M_max == pytest.approx(0.25 * b * h * h * fy, rel=1e-12)
    assert c.Q_full_area == pytest.approx(c.Q_max)
    assert c.shape_factor == pytest.approx(1.5)


def test_stiffnesses() -> None:
    c = capacity(parse_section("rectangle 50x100 mm"), parse_material("S235"))
    assert pytest.approx(210e9 * 0.005) == c.EA
    assert pytest.approx(210e9 * 0.05 * 0.1**3 / 12) == c.EI
    assert c.GA_s == pytest.approx(210e9 / 2.6 * 0.005 * 5 / 6)


def test_material_by_values() -> None:
    material = parse_material("fy=300 MPa, E=70 GPa, rho=2700 kg/m^3, nu=0.33, Et=1 GPa")
    assert (material.yield_stress, material.youngs_modulus, material.density) == (300e6, 70e9, 2700.0)
    assert (material.poissons_ratio, material.tangent_modulus) == (0.33, 1e9)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("S999", "no known grade"),
        ("fy=235", "no unit"),
        ("fy=235 mm", "does not fit"),
        ("E=210 GPa", "no yield stress"),
        ("fy=-1 MPa", "greater than zero"),
        ("fy=235 MPa, Et=300 GPa", "not between 0 and E"),
        ("fy=235 MPa, nu=0.7", "not between -1 and 0.5"),
        ("fy=235 MPa, colour=3", "none of fy, E"),
        ("fy=nan MPa", "finite"),
    ],
)
def test_bad_material_is_refused(text: str, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        parse_material(text)


@pytest.mark.parametrize(
    ("text", "quantity", "value"),
    [
        ("235 MPa", "stress", 235e6),
        ("6.5 m", "length", 6.5),
        ("3 kN m", "moment", 3000.0),
        ("7850 kg/m^3", "density", 7850.0),
        ("1%", "number", 0.01),
        ("0.3 %", "number", 0.003),
        ("0.01", "number", 0.01),
        ("12 deg", "angle", math.radians(12.0)),
        ("12 in", "length", 0.3048),
        (4, "length", 4.0),
    ],
)
def test_units(text: str | float, quantity: str, value: float) -> None:
    assert to_si(text, quantity, "here") == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("value", ["3 parsec", "three m", "3 kg", "3", True, "1/0 m", "inf m", "__import__('os') m"])
def test_bad_quantities_are_refused(value: str | bool) -> None:
    with pytest.raises(InputError, match="here"):
        to_si(value, "length", "here")
