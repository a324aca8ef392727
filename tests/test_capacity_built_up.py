"""Built-up sections, meshes, drawings and sections of sectionproperties."""

import math
from pathlib import Path

import ezdxf
import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from capacity import InputError, Interaction, Piece, built_up, capacity, parse_material, parse_section, shapes
from capacity.drawing_section import section_from_sectionproperties

STEEL = parse_material("S235")
POINTS = 1e-3 * np.array([[0, 0, 0], [50, 0, 0], [50, 100, 0], [0, 100, 0], [100, 0, 0], [100, 100, 0]])


@given(
    sizes=st.lists(st.tuples(st.floats(10.0, 200.0), st.floats(10.0, 200.0)), min_size=2, max_size=4),
    gap=st.floats(0.0, 50.0),
)
def test_union_adds_area_and_inertia(sizes: list[tuple[float, float]], gap: float) -> None:
    """A = Σ A_i, I = Σ (I_i + A_i d_i²): Steiner's theorem."""
    pieces, x = [], 0.0
    for b, h in sizes:
        pieces.append(Piece(shapes.rectangle(b * 1e-3, h * 1e-3), (x, 0.5 * h * 1e-3)))
        x += (b + gap) * 1e-3
    whole = built_up(pieces)
    areas = [p.section.area for p in pieces]
    middle = [p.at[1] + p.section.centroid[1] for p in pieces]
    centre = np.average(middle, weights=areas)
    assert whole.area == pytest.approx(sum(areas), rel=1e-12)
    assert whole.centroid[1] == pytest.approx(centre, rel=1e-12)
    second = sum(
        p.section.second_moment_of_area + a * (m - centre) ** 2 for p, a, m in zip(pieces, areas, middle, strict=True)
    )
    assert whole.second_moment_of_area == pytest.approx(second, rel=1e-10)


@pytest.mark.parametrize("text", ["rectangle 50x60 mm + rectangle 50x60 mm at 0,60 mm of S235", "rectangle 50x120 mm"])
def test_pieces_of_one_material_are_one_section(text: str) -> None:
    one, other = capacity(parse_section(text), STEEL), capacity(parse_section("rectangle 50x120 mm"), STEEL)
    for name in ("N_max", "M_max", "M_yield", "EA", "EI", "GA_s"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-9), name


def test_channels_back_to_back_are_symmetric() -> None:
    pair, one = parse_section("UPN 200 + UPN 200 mirrored"), parse_section("UPN 200")
    assert pair.area == pytest.approx(2.0 * one.area, rel=1e-12)
    assert pair.plastic_modulus == pytest.approx(2.0 * one.plastic_modulus, rel=1e-10)
    assert pair.wall_area == pytest.approx(2.0 * one.wall_area, rel=1e-12)
    assert pair.rotated(0.5 * math.pi).plastic_centroid == pytest.approx(0.0, abs=1e-12)


def test_two_materials_in_closed_form() -> None:
    """Half S235, half of twice the stress and stiffness, one above the other: the neutral axes shift to the strong."""
    section = parse_section("rectangle 50x60 mm + rectangle 50x60 mm at 0,60 mm of fy=470 MPa, E=420 GPa")
    c = capacity(section, STEEL)
    b, h, fy, e = 0.05, 0.06, 235e6, 210e9
    assert pytest.approx(3.0 * fy * b * h, rel=1e-12) == c.N_max
    assert pytest.approx(3.0 * e * b * h, rel=1e-12) == c.EA
    # Plastic axis at x above the joint: h + 2x = 2(h - x).
    x = 0.25 * h
    expected = fy * b * (h * (0.5 * h + x) + 2.0 * x * 0.5 * x + 2.0 * (h - x) * 0.5 * (h - x))
    assert pytest.approx(expected, rel=1e-10) == c.M_max
    centre = h * (0.5 + 2.0 * 1.5) / 3.0
    second = e * b * h**3 / 12.0 * 3.0 + e * b * h * ((centre - 0.5 * h) ** 2 + 2.0 * (1.5 * h - centre) ** 2)
    assert pytest.approx(second, rel=1e-10) == c.EI
    assert Interaction(section, STEEL).moments_at(0.0)[1] == pytest.approx(expected, rel=1e-10)
    assert [m.name for m, _ in section.fibres_by_material(8, STEEL)] == ["S235", "fy=470 MPa, E=420 GPa"]
    with pytest.raises(ValueError, match="several materials"):
        section.fibres(8)


def test_cover_plate_bears_no_shear_of_the_web() -> None:
    plated, plain = parse_section("IPE 300 + rectangle 200x20 mm at -25,300 mm"), parse_section("IPE 300")
    assert plated.wall_area == pytest.approx(plain.wall_area, rel=1e-12)


def _write(path: Path, cells: list[list[int]], **more: object) -> str:
    meshio.Mesh(POINTS, [("triangle", np.array(cells))], **more).write(path)
    return str(path)


def test_mesh_of_a_rectangle(tmp_path: Path) -> None:
    section = parse_section(_write(tmp_path / "a.vtk", [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]))
    assert section.area == pytest.approx(0.01, rel=1e-12)
    assert section.plastic_modulus == pytest.approx(0.1**3 / 4.0, rel=1e-10)
    assert section.second_moment_of_area == pytest.approx(0.1**4 / 12.0, rel=1e-10)
    assert section.shear_area == pytest.approx(5.0 / 6.0 * 0.01, rel=1e-9)


def test_groups_of_a_gmsh_mesh_name_materials(tmp_path: Path) -> None:
    tags = [np.array([1, 1, 2, 2])]
    mesh = meshio.Mesh(
        1e3 * POINTS,
        [("triangle", np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]))],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"S235": np.array([1, 2]), "S355": np.array([2, 2])},
    )
    mesh.write(tmp_path / "a.msh", file_format="gmsh22", binary=False)
    section = parse_section(f"{tmp_path / 'a.msh'} mm")
    assert capacity(section, STEEL).N_max == pytest.approx(0.005 * (235e6 + 355e6), rel=1e-12)
    assert capacity(section, STEEL).M_max == pytest.approx(0.05 * 0.1**2 / 4.0 * (235e6 + 355e6), rel=1e-10)


@pytest.mark.parametrize(
    ("cells", "fault"),
    [
        ([[0, 1, 2], [0, 3, 2]], r"the cell at \(0.016667, 0.066667\) is inverted"),
        ([[0, 1, 2], [4, 5, 2]], "is not connected to the others by an edge"),
        ([[0, 1, 2], [0, 2, 2]], "encloses nothing"),
        ([[0, 1, 2], [0, 1, 3]], "lies over another"),
    ],
)
def test_bad_meshes_are_refused(cells: list[list[int]], fault: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=fault):
        parse_section(_write(tmp_path / "bad.vtk", cells))


def test_a_file_that_is_no_mesh_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.msh").write_text("nothing of the kind", encoding="utf-8")
    with pytest.raises(InputError, match="cannot read"):
        parse_section(str(tmp_path / "a.msh"))


def test_drawing_with_bulges_holes_and_loose_lines(tmp_path: Path) -> None:
    drawing = ezdxf.new()
    drawing.units = 4
    space = drawing.modelspace()
    space.add_lwpolyline(
        [(0, 0, 0), (100, 0, math.tan(math.pi / 8)), (110, 10, 0), (110, 160, 0), (0, 160, 0)], format="xyb", close=True
    )
    space.add_circle((60, 105), 25)
    for a, b in (((10, 10), (20, 10)), ((20, 20), (20, 10)), ((10, 20), (20, 20))):
        space.add_line(a, b)
    space.add_line((10, 20), (10, 10))
    drawing.saveas(tmp_path / "a.dxf")
    section = parse_section(str(tmp_path / "a.dxf"))
    expected = 110 * 160 - (1.0 - math.pi / 4.0) * 100 - math.pi * 625 - 100
    assert section.area * 1e6 == pytest.approx(expected, rel=1e-12)


def test_an_open_drawing_is_refused_with_the_place(tmp_path: Path) -> None:
    drawing = ezdxf.new()
    drawing.units = 4
    drawing.modelspace().add_line((0, 0), (100, 0))
    drawing.saveas(tmp_path / "open.dxf")
    with pytest.raises(InputError, match=r"the outline is open at \((100|0), 0\) mm"):
        parse_section(str(tmp_path / "open.dxf"))
    (tmp_path / "no.dxf").write_text("nothing", encoding="utf-8")
    with pytest.raises(InputError, match="is no DXF drawing"):
        parse_section(str(tmp_path / "no.dxf"))


@settings(max_examples=5)
@given(h=st.floats(100.0, 400.0), b=st.floats(80.0, 200.0), t=st.floats(4.0, 12.0))
def test_peer_sectionproperties_agrees_on_polygons(h: float, b: float, t: float) -> None:
    """An angle with sharp corners: A, I, Ixy and plastic moduli by sectionproperties' own mesh."""
    from sectionproperties.analysis import Section as Peer
    from sectionproperties.pre.library import angle_section

    geometry = angle_section(d=h, b=b, t=t, r_r=0, r_t=0, n_r=1).create_mesh([0])
    peer = Peer(geometry)
    peer.calculate_geometric_properties()
    peer.calculate_plastic_properties()
    ixx, iyy, ixy = peer.get_ic()
    handed, ours = section_from_sectionproperties(geometry), shapes.angle(h * 1e-3, b * 1e-3, t * 1e-3)
    for section in (handed, ours):
        assert section.area * 1e6 == pytest.approx(peer.get_area(), rel=1e-9)
        np.testing.assert_allclose(1e12 * np.array(section.second_moments), [ixx, iyy, ixy], rtol=1e-8)
        assert section.plastic_modulus * 1e9 == pytest.approx(peer.get_s()[0], rel=1e-6)
        assert section.rotated(0.5 * math.pi).plastic_modulus * 1e9 == pytest.approx(peer.get_s()[1], rel=1e-6)


def test_what_is_no_section_of_sectionproperties_is_refused() -> None:
    with pytest.raises(InputError, match="no section of sectionproperties"):
        section_from_sectionproperties(3)
