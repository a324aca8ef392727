"""Plane bodies from mesh files: formats, orders, names, faults; and their fields on the way back."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from plane_bodies import HALVES, STEEL

from capacity import InputError
from fem_reference import field_files, plane_push
from fem_reference.plane.beam_mesh import tensor_mesh
from fem_reference.plane.bodies import plane_scene
from fem_reference.plane.mesh import PlaneMesh
from fem_reference.plane.mesh_file import body_from_mesh
from scene import Scene, load_scene, parse_scene

#: Nodes of each kind of cell, taken from a quadrilateral of 9.
KINDS = {"quad": [(0, 1, 2, 3)], "quad8": [tuple(range(8))], "quad9": [tuple(range(9))]}
KINDS |= {"triangle": [half[:3] for half in HALVES], "triangle6": list(HALVES)}


def strip() -> PlaneMesh:
    """100 × 40 with a slot, 10 × 10, in the middle of its top and of its bottom."""
    mesh = tensor_mesh(np.linspace(0.0, 100.0, 11), np.linspace(0.0, 40.0, 5))
    x, y = mesh.points[mesh.cells[:, 8]].T
    slot = (np.abs(x - 55.0) < 5.0) & ((y < 10.0) | (y > 30.0))
    return PlaneMesh(mesh.points, mesh.cells[~slot], {}, mesh.group[~slot])


def write(path: Path, kind: str, lines: bool = False, **more: Any) -> Path:
    mesh = strip()
    blocks = [(kind, mesh.cells[:, list(nodes)]) for nodes in KINDS[kind]]
    data: dict[str, Any] = {}
    if lines:
        sides = mesh.with_sides().edges
        blocks += [("line", sides[name][:, [0, 2]]) for name in ("left", "right")]
        tags = [np.full(len(cells), 3) for _, cells in blocks[:-2]] + [np.full(len(sides["left"]), 1)]
        tags.append(np.full(len(sides["right"]), 2))
        data["cell_data"] = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        data["field_data"] = {"grip": np.array([1, 1]), "jaw": np.array([2, 1]), "S235": np.array([3, 2])}
    meshio.write(path, meshio.Mesh(np.column_stack([mesh.points, 0.0 * mesh.points[:, 0]]), blocks, **data), **more)
    return path


def scene(path: Path, held: str = "left", pushed: str = "right", more: str = 'material = "S235"') -> Scene:
    return parse_scene(
        f"""
        title = "Slotted strip in tension"
        gravity = 0
        [plane]
        mesh = "{path}"
        unit = "1 mm"
        thickness = "5 mm"
        {more}
        supports = {{ {held} = "clamped" }}
        [push]
        node = "{pushed}"
        direction = [1, 0]
        distance = "0.3 mm"
        """,
        "test",
    )


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_cell_gives_the_same_body(kind: str, tmp_path: Path) -> None:
    path = write(tmp_path / "strip.vtu", kind)
    mesh, materials = body_from_mesh(path, 1e-3, STEEL)
    assert mesh.shape_gradients()[1].sum() == pytest.approx(0.1 * 0.04 - 2 * 1e-4, rel=1e-9)
    assert {name: len(sides) for name, sides in mesh.edges.items()} == {"left": 4, "right": 4, "bottom": 9, "top": 9}
    assert materials == [STEEL]
    assert mesh.cells.shape[1] == (6 if kind.startswith("triangle") else 9)


def test_a_notched_specimen_bears_its_net_section(tmp_path: Path) -> None:
    """Between fy A_net, without any constraint at the slots, and 2 / √3 of it, with all that plane stress allows."""
    found = plane_push(scene(write(tmp_path / "strip.vtu", "quad")), tolerance=1.0)
    net = 235e6 * 0.02 * 0.005
    assert net <= found.load[-1] <= 2.0 / np.sqrt(3.0) * net * 1.02
    assert found.outcome.startswith(("mechanism", "reached"))
    assert found.hinges == ()
    texts = field_files(found.fields)
    (tmp_path / "last.vtu").write_text(texts["fields-12.vtu"], encoding="utf-8")
    back = meshio.read(tmp_path / "last.vtu")
    assert {block.type for block in back.cells} == {"quad9"}
    assert len(back.cells[0].data) == found.elements == 4 * len(strip().cells)
    assert back.point_data["von_mises"].max() <= 235e6 * (1.0 + 1e-6)
    assert back.point_data["von_mises"].max() >= 235e6 * (1.0 - 1e-6)
    assert back.point_data["equivalent_plastic_strain"].min() >= 0.0
    at_right = back.points[:, 0] > 0.1 - 1e-9
    np.testing.assert_allclose(back.point_data["displacement"][at_right, 0], 3e-4, rtol=1e-6)


def test_a_plate_with_a_hole_bears_its_ligaments(tmp_path: Path) -> None:
    """P = fy (W - d) t: Gaydon & McCrum (1954), in Miller, *Limit loads of structures containing defects* (1988).

    A quarter of the plate, d / W = 0.2, of curved elements with 9 nodes; within the own estimate.
    """
    mesh = tensor_mesh(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 9))
    turn, out = 0.5 * np.pi * (1.0 - mesh.points[:, :1]), mesh.points[:, 1:] ** 1.5
    ray = np.column_stack([np.cos(turn), np.sin(turn)])
    points = 2.0 * ray * (1.0 - out) + 10.0 * ray / ray.max(axis=1, keepdims=True) * out
    path = tmp_path / "hole.vtu"
    meshio.write(path, meshio.Mesh(np.column_stack([points, 0.0 * out]), [("quad9", mesh.cells)]))
    text = f"""
        title = "Plate with a hole"
        gravity = 0
        [plane]
        mesh = "{path}"
        unit = "1 mm"
        thickness = "1 mm"
        material = "S235"
        supports = {{ left = "roller-y", bottom = "roller-x" }}
        [push]
        node = "right"
        direction = [1, 0]
        distance = "0.06 mm"
        """
    found = plane_push(parse_scene(text, "test"), tolerance=1.0)
    exact = 235e6 * 8e-3 * 1e-3
    assert found.outcome.startswith("mechanism")
    assert exact <= found.load[-1] <= exact * (1.0 + found.error_estimate)
    assert found.error_estimate <= 5e-3


def test_triangles_and_quadrilaterals_agree(tmp_path: Path) -> None:
    loads = [plane_push(scene(write(tmp_path / f"{k}.vtu", k)), 1.0) for k in ("triangle", "quad")]
    difference = abs(loads[0].load[-1] / loads[1].load[-1] - 1.0)
    assert difference <= max(found.error_estimate for found in loads)


def test_names_of_a_gmsh_file(tmp_path: Path) -> None:
    path = write(tmp_path / "strip.msh", "triangle", lines=True, file_format="gmsh22", binary=False)
    mesh, materials = body_from_mesh(path, 1e-3, None)
    assert len(mesh.edges["grip"]) == len(mesh.edges["jaw"]) == 4
    assert [material.name for material in materials] == ["S235"]
    found = plane_push(scene(path, "grip", "jaw", more=""), tolerance=1.0)
    assert found.load[-1] > 0.0


def test_sets_of_an_abaqus_file(tmp_path: Path) -> None:
    mesh = strip()
    held = np.flatnonzero(mesh.points[:, 0] == 0.0)
    path = tmp_path / "strip.inp"
    meshio.write(path, meshio.Mesh(mesh.points, [("quad", mesh.cells[:, :4])], point_sets={"grip": held}))
    found, _ = body_from_mesh(path, 1e-3, STEEL)
    assert len(found.edges["grip"]) == 4


def test_cells_of_both_kinds_become_triangles(tmp_path: Path) -> None:
    mesh = strip()
    blocks = [("quad", mesh.cells[:10, :4]), *(("triangle", mesh.cells[10:, list(half[:3])]) for half in HALVES)]
    meshio.write(tmp_path / "both.vtu", meshio.Mesh(np.column_stack([mesh.points, 0.0 * mesh.points[:, 0]]), blocks))
    found, _ = body_from_mesh(tmp_path / "both.vtu", 1e-3, STEEL)
    assert found.cells.shape == (2 * len(mesh.cells), 6)
    assert found.shape_gradients()[1].sum() == pytest.approx(0.1 * 0.04 - 2 * 1e-4, rel=1e-9)


def test_faults_are_named(tmp_path: Path) -> None:
    good = write(tmp_path / "strip.vtu", "quad")
    faults = [
        (lambda: plane_push(scene(good, "grip")), 'plane.supports.grip: the mesh has no edge "grip"; its edges are '),
        (lambda: plane_push(scene(good, "left", "rihgt")), 'push.node: the mesh has no edge "rihgt"'),
        (lambda: plane_push(scene(tmp_path / "none.vtu")), "plane.mesh: there is no file"),
        (lambda: plane_push(scene(good, more="")), "plane.material: the mesh has no material"),
        (lambda: plane_push(scene(good, "left", "top")), "share nodes"),
        (lambda: scene(good, more='material = "S235"\nroots = 1'), 'unknown key "roots"'),
    ]
    for act, message in faults:
        with pytest.raises(InputError, match=message.replace("(", r"\(")):
            act()
    mesh = strip()
    tangled = np.concatenate([mesh.cells[:5, :4], mesh.cells[5:6, [0, 3, 2, 1]], mesh.cells[6:, :4]])
    meshio.write(
        tmp_path / "tangled.vtu",
        meshio.Mesh(np.column_stack([mesh.points, 0 * mesh.points[:, 0]]), [("quad", tangled)]),
    )
    with pytest.raises(InputError, match=r"the cell at \(.*\) is inverted"):
        body_from_mesh(tmp_path / "tangled.vtu", 1.0, STEEL)
    folded = mesh.points.copy()
    folded[mesh.cells[3, 4]] += [0.0, 4.9]
    meshio.write(
        tmp_path / "folded.vtu", meshio.Mesh(np.column_stack([folded, 0 * folded[:, 0]]), [("quad9", mesh.cells)])
    )
    with pytest.raises(InputError, match="folds over itself"):
        body_from_mesh(tmp_path / "folded.vtu", 1.0, STEEL)


def test_a_mesh_is_beside_its_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scenes").mkdir()
    write(tmp_path / "scenes" / "strip.vtu", "quad")
    text = """
        title = "Slotted strip"
        [plane]
        mesh = "strip.vtu"
        unit = "1 mm"
        thickness = "5 mm"
        material = "S235"
        supports = { left = "clamped" }
        [push]
        node = "right"
        direction = [1, 0]
        distance = "1 mm"
        """
    (tmp_path / "scenes" / "strip.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert plane_scene(load_scene("scenes/strip.toml")).body(0).continuum.mesh.cells.shape == (38, 9)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('thickness = "0 mm"', "plane.thickness: it must be greater than zero"),
        ('unit = "-1 mm"', "plane.unit: it must be greater than zero"),
        ("supports = {}", "plane.supports: no edge of the mesh is held"),
        ('root = "pinned"', "plane.root"),
    ],
)
def test_faults_of_the_table_are_named(line: str, message: str) -> None:
    key = line.split(" ")[0]
    lines = {"mesh": 'mesh = "a.vtu"', "thickness": 'thickness = "5 mm"', "supports": 'supports = { left = "clamped" }'}
    table = "\n".join({**lines, key: line}.values())
    text = f'title = "x"\n[plane]\n{table}\n[push]\nnode = "right"\ndirection = [1, 0]\ndistance = "1 mm"'
    with pytest.raises(InputError, match=message):
        parse_scene(text, "test")


def test_keys_of_a_mesh_need_one() -> None:
    text = 'title = "x"\n[plane]\nthickness = "5 mm"\n[push]\nnode = "right"\ndirection = [1, 0]\ndistance = "1 mm"'
    with pytest.raises(InputError, match=r"plane.thickness: there is no mesh"):
        parse_scene(text, "test")
