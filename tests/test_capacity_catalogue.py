"""Catalogue data against the tables of the standards."""

import re

import pytest

from capacity import InputError, catalogue, parse_section

ALL = list(catalogue.entries().values())


def test_families_are_complete() -> None:
    families = {"IPE", "HEA", "HEB", "HEM", "UPN", "UPE", "L", "CHS", "RHS", "SHS", "W"}
    assert set(catalogue.families()) == families
    assert len(ALL) > 800


@pytest.mark.parametrize("family", ["IPE", "HEA", "HEB", "HEM", "UPN", "UPE", "L", "W"])
def test_areas_are_those_tabulated(family: str) -> None:
    """The standards' own tables, rounded to three or four digits; AISC's dimensions are rounded as well."""
    for entry in catalogue.family(family):
        area = entry.section().area
        if family == "W":
            assert area / 0.0254**2 == pytest.approx(entry.dimensions["area_in2"], rel=0.01), entry.name
        else:
            assert area * 1e4 == pytest.approx(entry.dimensions["area_cm2"], rel=6e-3), entry.name


def test_w_shapes_weigh_what_their_names_say() -> None:
    """W14x90 weighs 90 lb/ft; steel of 490 lb/ft³ (AISC)."""
    for entry in catalogue.family("W"):
        match = re.fullmatch(r"W\d+x(\d+)", entry.name)
        assert match
        assert entry.section().area / 0.3048**2 * 490.0 == pytest.approx(float(match[1]), rel=0.03), entry.name


# Name: I_y, W_el,y, W_pl,y in cm⁴, cm³ (European tables after EN 10365 and EN 10210-2).
TABULATED = {
    "IPE 80": (80.1, 20.0, 23.2),
    "IPE 200": (1943.0, 194.0, 221.0),
    "IPE 300": (8356.0, 557.0, 628.0),
    "IPE 600": (92080.0, 3069.0, 3512.0),
    "HEA 200": (3692.0, 389.0, 429.0),
    "HEA 300": (18260.0, 1260.0, 1383.0),
    "HEB 200": (5696.0, 570.0, 643.0),
    "HEB 300": (25170.0, 1678.0, 1869.0),
    "HEM 300": (59200.0, 3482.0, 4078.0),
    "UPN 200": (1910.0, 191.0, 228.0),
    "UPN 100": (206.0, 41.2, 49.0),
    "CHS 168.3x8": (1297.0, 154.0, 206.0),
    "SHS 100x5": (279.0, 55.9, 66.4),
    "RHS 200x100x8": (2234.0, 223.0, 282.0),
}


@pytest.mark.parametrize("name", TABULATED)
def test_moduli_are_those_tabulated(name: str) -> None:
    section, (i, elastic, plastic) = parse_section(name), TABULATED[name]
    assert section.second_moment_of_area * 1e8 == pytest.approx(i, rel=4e-3)
    assert section.elastic_modulus * 1e6 == pytest.approx(elastic, rel=4e-3)
    assert section.plastic_modulus * 1e6 == pytest.approx(plastic, rel=5e-3)


def test_w14x90_bends_as_the_manual_says() -> None:
    """Ix = 999 in⁴, Zx = 157 in³, Iy = 362 in⁴ (AISC Manual, 15th ed., Table 1-1)."""
    section = parse_section("W14x90")
    assert section.second_moments[0] / 0.0254**4 == pytest.approx(999.0, rel=5e-3)
    assert section.plastic_modulus / 0.0254**3 == pytest.approx(157.0, rel=1e-2)
    assert section.second_moments[1] / 0.0254**4 == pytest.approx(362.0, rel=5e-3)


def test_every_section_can_be_made_and_read_by_its_name() -> None:
    for entry in ALL:
        section = parse_section(entry.name)
        assert section.name == entry.name
        assert section.plastic_modulus > section.elastic_modulus > 0.0


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("ipe300", "IPE 300"),
        ("w14X90", "W14x90"),
        ("SHS100x5", "SHS 100x5"),
        ("HE 200 B", "HEB 200"),
        ("SHS 100x100x5 EN 10219", "SHS 100x5 EN 10219"),
    ],
)
def test_a_name_may_be_written_in_its_usual_ways(text: str, same: str) -> None:
    assert parse_section(text).name == same


def test_cold_formed_corners_are_rounder() -> None:
    """EN 10219-2: outer radius 2.0 t up to 6 mm; EN 10210-2: 1.5 t."""
    assert parse_section("SHS 100x5 EN 10219").area < parse_section("SHS 100x5").area
    assert catalogue.corner_radii("EN 10219", 0.012) == pytest.approx((0.036, 0.024))
    assert catalogue.corner_radii("EN 10219", 0.008) == pytest.approx((0.020, 0.012))


@pytest.mark.parametrize(("text", "near"), [("IPE 310", "IPE 300"), ("HEB 210", "HEB 200"), ("W14x91", "W14x90")])
def test_a_misspelt_name_is_answered_with_the_nearest(text: str, near: str) -> None:
    with pytest.raises(InputError, match=f"did you mean .*{near}"):
        parse_section(text)


def test_a_misspelt_family_is_answered_with_the_nearest() -> None:
    with pytest.raises(InputError, match=r"write one of .*UPN"):
        catalogue.family("UPNN")
