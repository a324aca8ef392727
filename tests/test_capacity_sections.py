from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import InputError, parse_section

# Reference case (sectionproperties 3.10.2 and closed forms): text of the same section.
CATALOGUE_CASES = {
    "C8-rect-60x120": "rectangle 60x120 mm",
    "C8-circle-80": "circle 80 mm",
    "C8-chs-168.3x8": "CHS 168.3x8 mm",
    "C8-rhs-200x100x8-sharp": "RHS 200x100x8 mm",
    "C8-ipe100": "IPE 100",
    "C8-ipe300": "IPE 300",
    "C8-ipe600": "IPE 600",
}


@pytest.mark.parametrize("name", CATALOGUE_CASES)
def test_section_properties(name: str, case: Callable[[str], dict[str, Any]]) -> None:
    """A, I, W_el and W_pl against closed forms (and sectionproperties where a closed form is missing)."""
    outputs = case(name)["outputs"]
    section = parse_section(CATALOGUE_CASES[name])
    fine = outputs.get("closed_form", outputs["sectionproperties"])
    rough = outputs["sectionproperties"]
    assert section.area * 1e6 == pytest.approx(fine["A"], rel=1e-10 if "closed_form" in outputs else 1e-4)
    assert section.second_moment_of_area * 1e12 == pytest.approx(fine["Ix"], rel=1e-4)
    assert section.elastic_modulus * 1e9 == pytest.approx(rough["Welx_plus"], rel=1e-4)
    assert section.plastic_modulus * 1e9 == pytest.approx(fine.get("Wplx", rough["Wplx"]), rel=1e-4)


@pytest.mark.parametrize("name", ["C8-ipe100", "C8-ipe300", "C8-ipe600", "C8-rhs-200x100x8-sharp"])
def test_walls_along_the_load(name: str, case: Callable[[str], dict[str, Any]]) -> None:
    section = parse_section(CATALOGUE_CASES[name])
    assert section.wall_area * 1e6 == pytest.approx(case(name)["outputs"]["shear"]["Av_projected_walls_y"], rel=1e-9)


def test_elastic_shear_areas_of_solid_sections() -> None:
    """5/6 and 9/10 of the area (Gere & Goodno, Mechanics of Materials, 8th ed., section 9.10)."""
    rectangle, circle = parse_section("rectangle 50x100 mm"), parse_section("circle 80 mm")
    assert rectangle.shear_area / rectangle.area == pytest.approx(5.0 / 6.0, rel=1e-10)
    assert circle.shear_area / circle.area == pytest.approx(0.9, rel=1e-10)


def test_thin_tube_bears_shear_with_half_its_area() -> None:
    """Cowper (1966): 2(1 + ν)/(4 + 3ν) = 0.531 for a thin tube with ν = 0.3."""
    tube = parse_section("CHS 1000x1 mm")
    assert tube.shear_area / tube.area == pytest.approx(2.0 * 1.3 / 4.9, rel=1e-3)


@pytest.mark.parametrize(
    "text",
    [*CATALOGUE_CASES.values(), "UPN 200", "L 100x100x10", "T 150x150x7.1x10.7x15 mm", "MI 300x100x8x200x15x8 mm"],
)
@given(count=st.integers(4, 49))
def test_fibres_keep_area_inertia_and_plastic_modulus(text: str, count: int) -> None:
    section = parse_section(text)
    fibres = section.fibres(count)
    assert len(fibres.y) == count
    assert fibres.area.min() > 0.0
    assert fibres.area.sum() == pytest.approx(section.area, rel=1e-12)
    assert abs(fibres.area @ fibres.y) <= 1e-12 * section.area * section.depth
    assert fibres.area @ fibres.y**2 == pytest.approx(section.second_moment_of_area, rel=1e-12)
    assert fibres.area @ np.abs(fibres.y - section.plastic_centroid) == pytest.approx(section.plastic_modulus, rel=1e-9)


def test_four_fibres_are_the_least() -> None:
    with pytest.raises(ValueError, match="four are the least"):
        parse_section("IPE 300").fibres(3)


@given(factor=st.floats(0.1, 10.0), b=st.floats(5.0, 500.0), h=st.floats(5.0, 500.0))
def test_scaling(factor: float, b: float, h: float) -> None:
    one, other = (
        parse_section(f"rectangle {b!r}x{h!r} mm"),
        parse_section(f"rectangle {factor * b!r}x{factor * h!r} mm"),
    )
    assert other.area == pytest.approx(factor**2 * one.area)
    assert other.plastic_modulus == pytest.approx(factor**3 * one.plastic_modulus)
    assert other.second_moment_of_area == pytest.approx(factor**4 * one.second_moment_of_area)


def test_the_side_of_a_square_hollow_section_may_be_said_twice() -> None:
    assert parse_section("SHS 100x100x5x7.5x5 mm").area == parse_section("SHS 100x5x7.5x5 mm").area


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("IPE 305", "did you mean IPE"),
        ("rectangel 50x100 mm", "no known section"),
        ("rectangle 50x100", "no unit of length"),
        ("rectangle 50 mm", "1 dimensions instead of 2"),
        ("rectangle 50x-100 mm", "not greater than zero"),
        ("rectangle 50x100 kg", "does not fit"),
        ("rectangle 1e400x100 mm", "not a finite number"),
        ("CHS 100x60 mm", "leaves no hollow"),
        ("RHS 200x100x50 mm", "leaves no hollow"),
        ("I 300x150x7.1x10.7x200 mm", "fillet is too large"),
        ("", "no known section"),
    ],
)
def test_bad_text_is_refused_with_the_fault(text: str, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        parse_section(text, "here")
