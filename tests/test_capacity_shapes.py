"""Every section of the reference cases about both axes, and properties that hold for any shape."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import InputError, Section, parse_section, shapes

# Reference case: text of the same section.
TEXTS = {
    "C8-rect-60x120": "rectangle 60x120 mm",
    "C8-circle-80": "circle 80 mm",
    "C8-chs-168.3x8": "CHS 168.3x8 mm",
    "C8-rhs-200x100x8-sharp": "RHS 200x100x8 mm",
    "C8-rhs-200x100x8-round": "RHS 200x100x8x12x8 mm",
    "C8-ipe100": "IPE 100",
    "C8-ipe300": "IPE 300",
    "C8-ipe600": "IPE 600",
    "C8-heb200": "HEB 200",
    "C8-upn200": "UPN 200",
    "C8-l100x10": "L 100x100x10 mm",
    "C8-tee-150": "T 150x150x7.1x10.7x15 mm",
    "C8-rect-hole": "rectangle 100x160 mm - circle 50 mm at 60,105 mm",
}
POLYGONAL = {"C8-rect-60x120", "C8-rhs-200x100x8-sharp"}
ODD = ["UPN 200", "L 100x75x8x10x5 mm", "MI 300x100x8x200x15x8 mm", "T 150x100x7x10x12 mm"]


@pytest.mark.parametrize("name", TEXTS)
def test_properties_of_the_reference_cases(name: str, case: Callable[[str], dict[str, Any]]) -> None:
    """Closed forms where there are any, else finely polygonised arcs (error below 1e-6, by the case's own note)."""
    outputs = case(name)["outputs"]
    fine = outputs.get("polygon_fine_arcs", {}) | outputs.get("closed_form", {})
    fine = fine if "A" in fine else outputs["polygon_exact"]
    section = parse_section(TEXTS[name])
    across = section.rotated(0.5 * math.pi)
    (ix, iy, _), tolerance = section.second_moments, 1e-10 if name in POLYGONAL else 1e-6
    assert section.area * 1e6 == pytest.approx(fine["A"], rel=tolerance)
    assert ix * 1e12 == pytest.approx(fine["Ix"], rel=tolerance)
    assert iy * 1e12 == pytest.approx(fine["Iy"], rel=tolerance)
    assert section.plastic_modulus * 1e9 == pytest.approx(fine["Wplx"], rel=tolerance)
    assert across.plastic_modulus * 1e9 == pytest.approx(fine["Wply"], rel=tolerance)
    rough, exact = outputs["sectionproperties"], outputs["polygon_exact"]
    tolerance = 1e-10 if name in POLYGONAL else 1e-4
    moduli = (*section.elastic_moduli, *across.elastic_moduli)
    for value, key in zip(moduli, ("Welx_plus", "Welx_minus", "Wely_plus", "Wely_minus"), strict=True):
        assert value * 1e9 == pytest.approx(rough[key], rel=tolerance)
    reference = fine if "y_pc" in fine else exact
    pc = (section.centroid[0] + across.plastic_centroid, section.centroid[1] + section.plastic_centroid)
    assert pc[0] * 1e3 == pytest.approx(reference["x_pc"], abs=1e-6 * across.depth * 1e3)
    assert pc[1] * 1e3 == pytest.approx(reference["y_pc"], abs=1e-6 * section.depth * 1e3)
    assert section.centroid[0] * 1e3 == pytest.approx(reference.get("cx", exact["cx"]), abs=1e-6 * across.depth * 1e3)
    assert section.centroid[1] * 1e3 == pytest.approx(reference.get("cy", exact["cy"]), abs=1e-6 * section.depth * 1e3)


@pytest.mark.parametrize("name", TEXTS)
def test_principal_axes_of_the_reference_cases(name: str, case: Callable[[str], dict[str, Any]]) -> None:
    rough = case(name)["outputs"]["sectionproperties"]
    section = parse_section(TEXTS[name])
    i11, i22, angle = section.principal_moments
    upright = section.rotated(-angle)
    tolerance = 1e-10 if name in POLYGONAL else 1e-4
    assert i11 * 1e12 == pytest.approx(rough["I11"], rel=tolerance)
    assert i22 * 1e12 == pytest.approx(rough["I22"], rel=tolerance)
    assert upright.second_moment_of_area == pytest.approx(i11, rel=1e-12)
    assert upright.plastic_modulus * 1e9 == pytest.approx(rough["Wpl11"], rel=tolerance)
    assert upright.rotated(0.5 * math.pi).plastic_modulus * 1e9 == pytest.approx(rough["Wpl22"], rel=tolerance)
    # An axis has no direction: 45° and -135° are one.
    assert math.degrees(angle) % 180.0 == pytest.approx(rough["phi_deg"] % 180.0, abs=0.01)


@pytest.mark.parametrize("name", TEXTS)
def test_walls_along_both_directions(name: str, case: Callable[[str], dict[str, Any]]) -> None:
    shear, section = case(name)["outputs"]["shear"], parse_section(TEXTS[name])
    tolerance = 1e-5 if name == "C8-rect-hole" else 1e-12  # that case's own hole is a polygon
    assert section.wall_area * 1e6 == pytest.approx(shear["Av_projected_walls_y"], rel=tolerance)
    assert section.rotated(0.5 * math.pi).wall_area * 1e6 == pytest.approx(shear["Av_projected_walls_x"], rel=tolerance)


@pytest.mark.parametrize("text", ODD)
@given(angle=st.floats(-math.pi, math.pi))
def test_turning_changes_no_invariant(text: str, angle: float) -> None:
    section = parse_section(text)
    turned = section.rotated(angle)
    ix, iy, _ = turned.second_moments
    assert turned.area == pytest.approx(section.area, rel=1e-12)
    assert ix + iy == pytest.approx(sum(section.second_moments[:2]), rel=1e-12)
    assert turned.principal_moments[:2] == pytest.approx(section.principal_moments[:2], rel=1e-9)
    back = turned.rotated(-angle)
    assert back.plastic_modulus == pytest.approx(section.plastic_modulus, rel=1e-9)
    assert back.wall_area == pytest.approx(section.wall_area, rel=1e-9)
    # Half a turn swaps the faces.
    other = turned.rotated(math.pi)
    assert other.elastic_moduli == pytest.approx(turned.elastic_moduli[::-1], rel=1e-9)
    assert other.plastic_centroid == pytest.approx(-turned.plastic_centroid, abs=1e-9 * turned.depth)


@pytest.mark.parametrize("text", ODD)
@given(angle=st.floats(-math.pi, math.pi))
def test_a_mirror_image_bends_alike(text: str, angle: float) -> None:
    section = parse_section(text).rotated(angle)
    image = section.mirrored()
    ix, iy, ixy = section.second_moments
    np.testing.assert_allclose(image.second_moments, (ix, iy, -ixy), rtol=1e-12, atol=1e-14 * ix)
    assert image.plastic_modulus == pytest.approx(section.plastic_modulus, rel=1e-10)
    assert image.plastic_centroid == pytest.approx(section.plastic_centroid, abs=1e-10 * section.depth)
    assert image.shear_area == pytest.approx(section.shear_area, rel=1e-9)


@given(factor=st.floats(0.05, 20.0), r=st.floats(0.0, 15.0), h=st.floats(100.0, 800.0))
def test_scaling_laws(factor: float, r: float, h: float) -> None:
    one = shapes.i_section(h * 1e-3, 0.15, 0.0071, 0.0107, r * 1e-3)
    other = shapes.i_section(*(factor * v * 1e-3 for v in (h, 150.0, 7.1, 10.7, r)))
    assert other.area == pytest.approx(factor**2 * one.area, rel=1e-10)
    assert other.plastic_modulus == pytest.approx(factor**3 * one.plastic_modulus, rel=1e-10)
    assert other.second_moment_of_area == pytest.approx(factor**4 * one.second_moment_of_area, rel=1e-10)
    assert other.shear_area == pytest.approx(factor**2 * one.shear_area, rel=1e-9)


SYMMETRIC = [
    shapes.rectangle(0.03, 0.07),
    shapes.circle(0.05),
    shapes.circular_hollow(0.1, 0.004),
    shapes.rectangular_hollow(0.2, 0.1, 0.008, 0.012, 0.008),
    shapes.i_section(0.3, 0.15, 0.0071, 0.0107, 0.015),
]


@pytest.mark.parametrize("section", SYMMETRIC, ids=lambda section: section.name)
def test_symmetric_sections_are_symmetric(section: Section) -> None:
    across = section.rotated(0.5 * math.pi)
    for one in (section, across):
        assert one.plastic_centroid == 0.0
        assert one.elastic_moduli[0] == pytest.approx(one.elastic_moduli[1], rel=1e-12)
    assert abs(section.second_moments[2]) <= 1e-15 * section.second_moment_of_area


@given(
    lengths=st.lists(st.floats(0.2, 2.0), min_size=5, max_size=14),
    shift=st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
)
def test_polygons_against_the_shoelace_formula(lengths: list[float], shift: tuple[float, float]) -> None:
    """A = ½ Σ (x_i y_j - x_j y_i), I by its cubic sibling, in either sense and anywhere."""
    angles = 2.0 * math.pi * np.arange(len(lengths)) / len(lengths)
    x, y = lengths * np.cos(angles) + shift[0], lengths * np.sin(angles) + shift[1]
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area, cy = 0.5 * cross.sum(), (cross * (y + np.roll(y, -1))).sum() / (3.0 * cross.sum())
    second = (cross * (y**2 + y * np.roll(y, -1) + np.roll(y, -1) ** 2)).sum() / 12.0 - area * cy**2
    vertices = [(float(a), float(b)) for a, b in zip(x, y, strict=True)]
    for corners in (vertices, vertices[::-1]):
        section = shapes.polygon(corners)
        assert section.area == pytest.approx(area, rel=1e-10)
        assert section.second_moment_of_area == pytest.approx(second, rel=1e-8)
        above = section.outline.moments(section.plastic_centroid)[0]
        assert above == pytest.approx(0.5 * area, rel=1e-10)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("polygon 0,0 100,100 100,0 0,100 mm", r"crosses itself at \(50, 50\) mm"),
        ("polygon 0,0 100,0 200,0 mm", "encloses nothing"),
        ("polygon 0,0 100,0 mm", "three are the least"),
        ("polygon 0,0 0,0 100,0 100,100 mm", "corners 1 and 2 of the outline coincide"),
        ("polygon 0,0 9,0 9,9 0,9 hole 20,2 21,2 21,3 mm", r"hole 1 is not inside the outline, see \(20"),
        ("polygon 0,0 9,0 9,9 0,9 hole 1,1 5,1 5,5 hole 2,1.5 6,2 6,6 mm", "holes 1 and 2 meet at"),
        ("polygon 0,0 9,0 9,9 0,9", "is no polygon"),
        ("rectangle 100x160 mm - circle 50 mm at 90,80 mm", "not inside any piece"),
        ("IPE 300 + IPE 300 at 0,200 mm", "overlap at"),
        ("I 300x150x0x10.7 mm", "not greater than zero"),
        ("I 300x150x7.1x10.7x80 mm", "80 mm fillet is too large for the edges that meet at corner"),
        ("RHS 200x100x8x50x0 mm", "cuts through the wall"),
        ("U 200x75x8.5x11.5 mm slope 50 %", "taper to nothing"),
        ("U 200x75x8.5x11.5 mm steep 50 %", "goes on with"),
        ("L 100x100x100 mm", "fills the whole section"),
        ("T 100x100x7x100 mm", "fills the whole section"),
        ("rectangle 10x10 mm at nowhere", "is no place"),
        ("no/such/mesh.msh", "there is no file"),
        ("IPE 300 of S999", "no known grade"),
    ],
)
def test_bad_geometry_is_refused_with_the_fault_and_the_place(text: str, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        parse_section(text, "here")
