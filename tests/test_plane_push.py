"""Plane stress pushes against reference cases, closed forms, and themselves on other meshes and histories."""

from collections.abc import Callable
from operator import attrgetter
from typing import Any

import msgspec
import numpy as np
import pytest
from cantilevers import cantilever
from plane_bodies import STEEL, held_body

from capacity import InputError, parse_material
from fem_reference import NotConverged, PlanePush, field_files, plane_push, push_over, remarks, wants_plane_stress
from fem_reference.plane.beam_mesh import beam_mesh, tensor_mesh
from fem_reference.plane.bodies import plane_scene
from fem_reference.plane.extrapolation import Convergence
from fem_reference.plane.path import Trace, trace
from scene import Load, Plane, Push, Scene


def push(level: int, length: float, distances: np.ndarray, root: str = "clamped", **body: Any) -> Trace:
    path = trace(held_body(beam_mesh(length, 0.1, level), root, **body), [distances])
    assert not path.stopped
    assert path.imbalance <= 1e-8
    return path


@pytest.mark.parametrize("root", ["clamp", "free"])
@pytest.mark.parametrize("name", ["C7-ps-Lh5", "C7-ps-Lh2"])
def test_reference_cases(name: str, root: str, case: Callable[[str], dict[str, Any]]) -> None:
    """Twenty points each of a uniform Q2 mesh of its own, with CalculiX as cross-check.

    Those of a clamp are from a mesh whose own error is 0.21 % and 0.35 %, so its limit load is also held against their
    extrapolation to elements of size zero.
    """
    inputs, outputs = case(name)["inputs"], case(name)["outputs"]
    where = np.array(outputs["delta_m"])
    held = "clamped" if root == "clamp" else "contraction-free"
    found = Convergence.of([push(level, inputs["L_m"], where, held) for level in (-1, 0, 1)])
    assert found.extrapolated or root == "free"
    load, error = found.answer(attrgetter("load"))[1:], found.error(attrgetter("load"))
    assert error <= 2e-3
    expected = np.array(outputs[f"P_{root}_N"])
    uncertainty = case(name)["uncertainty"]["P_clamp_rel"]
    assert np.abs(load / expected - 1.0).max() <= uncertainty + error
    limit = outputs[f"P_limit_{root}_richardson_over_beam" if root == "free" else "P_limit_clamp_over_beam"]
    assert load[-1] / outputs["Pp_beam_N"] == pytest.approx(limit, rel=error)


@pytest.mark.parametrize("root", ["clamp", "free"])
def test_same_mesh_gives_the_same_number(root: str, case: Callable[[str], dict[str, Any]]) -> None:
    """The case's history of mesh refinement: independent assembly and solver on the same uniform mesh."""
    outputs = case("C7-ps-Lh5")["outputs"]
    mesh = tensor_mesh(np.linspace(0.0, 0.5, 41), np.linspace(-0.05, 0.05, 9))
    body = held_body(mesh, "clamped" if root == "clamp" else "contraction-free")
    path = trace(body, [np.array(outputs["delta_m"])])
    expected = outputs[f"mesh_history_{root}_P_last_over_Pp"]["8"]
    assert path.load[-1] / outputs["Pp_beam_N"] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("slender", [2.0, 5.0, 10.0])
def test_elastic_limit_of_a_contraction_free_root(slender: float) -> None:
    """δ = P L³ / 3EI + P L / (5/6 G A): Timoshenko & Goodier, *Theory of Elasticity*, art. 21, with the root's mean
    displacement weighted by its parabola of shear; its warping is held here, which stiffens it a little."""
    length, inertia, area = 0.1 * slender, 0.05 * 0.1**3 / 12.0, 0.005
    load = push(1, length, np.array([1e-6]), "contraction-free").load[1]
    flexibility = length**3 / (3.0 * 210e9 * inertia) + length / (5.0 / 6.0 * STEEL.shear_modulus * area)
    assert load * flexibility / 1e-6 == pytest.approx(1.0, abs=6e-3 / slender**2 + 1e-4)
    assert load * flexibility / 1e-6 > 1.0


def test_newton_converges_quadratically() -> None:
    """The sign of a consistent tangent: the number of right digits doubles from one iteration to the next."""
    residuals = push(0, 0.2, np.linspace(0.0, 0.003, 41)[1:]).residuals
    orders = [
        np.log(c / b) / np.log(b / a)
        for step in residuals
        for a, b, c in zip(step, step[1:], step[2:], strict=False)
        if 1e-2 > a > b > c > 3e-12
    ]
    assert len(orders) >= 15
    assert np.median(orders) > 1.8
    assert sum(map(len, residuals)) <= 5 * len(residuals)


def test_work_of_the_load_is_stored_or_dissipated() -> None:
    path = push(0, 0.2, np.concatenate([np.linspace(0.0, 1e-3, 11)[1:], np.linspace(1e-3, -1e-3, 21)[1:]]))
    external, elastic, plastic = np.array(path.external), np.array(path.elastic), np.array(path.plastic)
    np.testing.assert_allclose(external, elastic + plastic, atol=1e-9 * external.max())
    assert np.all(np.diff(plastic) >= -1e-12 * plastic.max())
    work = np.append(0.0, np.cumsum(0.5 * np.diff(path.displacement) * (np.array(path.load[1:]) + path.load[:-1])))
    np.testing.assert_allclose(external, work, rtol=1e-6, atol=1e-9 * external.max())


def test_load_control_follows_the_same_curve_and_stops_at_the_limit() -> None:
    distances = np.linspace(0.0, 4e-4, 9)[1:]
    loads = np.array(push(0, 0.2, distances).load[1:])
    body = held_body(beam_mesh(0.2, 0.1, 0))
    path = trace(body, [loads], control="load")
    np.testing.assert_allclose(path.displacement[1:], distances, rtol=1e-6)
    limit = push(0, 0.2, np.linspace(0.0, 4e-3, 25)[1:]).load[-1]
    path = trace(held_body(beam_mesh(0.2, 0.1, 0)), [np.linspace(0.0, 1.1 * limit, 12)[1:]], control="load")
    assert path.stopped.startswith("no equilibrium beyond a load of")
    assert path.load[-1] == pytest.approx(limit, rel=1e-3)
    assert np.isfinite(path.displacement).all()


def test_unloading_is_elastic_and_leaves_what_is_left() -> None:
    """Back to zero load along the elastic stiffness, as long as nothing yields the other way."""
    body = held_body(tensor_mesh(np.linspace(0.0, 1.0, 21), np.linspace(-0.05, 0.05, 5)))
    path = trace(body, [np.linspace(0.0, 0.015, 11)[1:]], unload=True)
    stiffness = path.load[1] / path.displacement[1]
    assert path.load[-1] == 0.0
    assert path.displacement[-1] == pytest.approx(0.015 - path.load[10] / stiffness, rel=1e-3)
    assert path.displacement[-1] > 1e-3


@pytest.mark.parametrize("hardening", ["kinematic", "isotropic"])
def test_hardening_agrees_with_beam_theory_on_a_slender_cantilever(hardening: str) -> None:
    """L/h = 10, E_t = E / 50, contraction-free root: fibre beams, which know no shear in yielding, within 1 %."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.03, theory="timoshenko")
    steel = parse_material("fy=235 MPa, E=210 GPa, Et=4.2 GPa")
    member = msgspec.structs.replace(scene.members["beam"], material=steel)
    beam = push_over(msgspec.structs.replace(scene, members={"beam": member}))
    where = np.linspace(0.0, 0.03, 13)[1:]
    load = push(0, 1.0, where, "contraction-free", material=steel, hardening=hardening).load[1:]
    np.testing.assert_allclose(load, np.interp(where, beam.displacement, beam.load), rtol=0.01)


def test_after_a_turn_kinematic_hardening_yields_before_isotropic() -> None:
    steel = parse_material("fy=235 MPa, E=210 GPa, Et=10 GPa")
    legs = np.concatenate([np.linspace(0.0, 0.02, 9)[1:], np.linspace(0.02, -0.02, 17)[1:]])
    kinematic, isotropic = (
        push(0, 0.5, legs, material=steel, hardening=hardening).load for hardening in ("kinematic", "isotropic")
    )
    # Monotonic loading is nearly in proportion, and then the two are nearly alike.
    np.testing.assert_allclose(kinematic[:9], isotropic[:9], rtol=5e-3)
    assert abs(isotropic[-1]) > 1.1 * abs(kinematic[-1])


def short(reference: str = "auto", length: float = 0.2, **plane: Any) -> Scene:
    scene = cantilever("rectangle 50x100 mm", length, 1e-3)
    return msgspec.structs.replace(scene, reference=reference, plane=Plane(**plane) if plane else None)


@pytest.fixture(scope="module")
def short_push() -> PlanePush:
    """L/h = 2, contraction-free root, to 1 mm, on the two coarsest meshes."""
    return plane_push(short(root="contraction-free"), tolerance=1.0)


def test_a_scene_chooses_its_reference() -> None:
    assert wants_plane_stress(short())
    assert wants_plane_stress(short(length=0.5))
    assert not wants_plane_stress(short(length=0.51))
    assert wants_plane_stress(short("plane-stress", length=2.0))
    assert not wants_plane_stress(short("beam"))
    assert "followed as a plane stress continuum" in remarks(short())[0]
    assert "it wants a plane stress continuum" in remarks(short("beam"))[0]
    assert "beam elements" in push_over(short("beam")).method


@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_a_scene_is_answered_in_plane_stress(turn: float) -> None:
    scene = short(root="contraction-free")
    if turn:  # the same member in another place, direction, and drawn the other way round
        c, s = float(np.cos(turn)), float(np.sin(turn))
        nodes = {
            "root": msgspec.structs.replace(scene.nodes["root"], at=(1.0, 2.0)),
            "tip": msgspec.structs.replace(scene.nodes["tip"], at=(1.0 + 0.2 * c, 2.0 + 0.2 * s)),
        }
        member = msgspec.structs.replace(scene.members["beam"], start="tip", end="root")
        pushed = msgspec.structs.replace(scene.push, direction=(s, -c))
        scene = msgspec.structs.replace(scene, nodes=nodes, members={"beam": member}, pushed=pushed)
    shares: list[float] = []
    found = push_over(scene, tolerance=0.01, watch=shares.append)
    assert found.method.startswith("plane stress continuum")
    assert shares[-1] == 1.0
    assert found.error_estimate <= 2e-3
    # Reference case C7-ps-Lh2 with a free root: 151810 N at 0.8535 mm, 153411 N at 0.9698 mm.
    assert np.interp(0.8534603174603174e-3, found.displacement, found.load) == pytest.approx(151810.0, rel=2e-3)
    (hinge,) = found.hinges
    assert (hinge.node, hinge.load) == ("root", pytest.approx(235e6 * 125e-6 / 0.2))
    assert hinge.position == pytest.approx(0.2 if turn else 0.0)
    assert found.energy.error_estimate <= 3e-3
    assert found.residual_error == 0.0
    # The axis: the root stays, the tip goes along the push, and x, y are the scene's.
    axis = found.axes["beam"]
    at_tip = int(np.argmin(axis.point) if turn else np.argmax(axis.point))
    np.testing.assert_allclose(axis.shape[at_tip], 1e-3 * np.array(scene.push_direction()), atol=2e-4)
    assert axis.shape[at_tip] @ scene.push_direction() == pytest.approx(1e-3, rel=1e-9)
    assert np.ptp(axis.point) == pytest.approx(0.2)
    assert 0.0 < axis.error_estimate <= 0.02 * 1e-3
    assert hinge.displacement_error is not None
    # The case has 146824 N at 0.69829 mm, where it rises by 51 N/µm to M_pl / L = 146875 N.
    assert hinge.displacement == pytest.approx(0.69929e-3, abs=hinge.displacement_error + 1e-6)
    np.testing.assert_allclose(
        found.energy.external, found.energy.elastic + found.energy.plastic, atol=1e-9 * found.energy.external[-1]
    )


def test_own_weight_and_dead_loads_come_first(short_push: PlanePush) -> None:
    """Elastic: the load at a given push is the same with and without; at collapse, weight takes its share W / 2."""
    steel = parse_material("fy=235 MPa, E=210 GPa, rho=2000000 kg/m^3")
    scene = short(root="contraction-free")
    member = msgspec.structs.replace(scene.members["beam"], material=steel)
    dead = Load(node="tip", force=(0.0, -5e3), kind="dead")
    heavy = msgspec.structs.replace(scene, members={"beam": member}, gravity=9.81, loads=(dead,))
    weight = 2e6 * 9.81 * 0.005 * 0.2
    without, under = short_push, plane_push(heavy, tolerance=1.0)
    assert under.load[1] == pytest.approx(without.load[1] / without.displacement[1] * under.displacement[1], rel=1e-6)
    assert without.load[-1] - under.load[-1] == pytest.approx(weight / 2.0 + 5e3, rel=0.05)


def test_proportional_loads_give_a_load_factor(short_push: PlanePush) -> None:
    force = Load(node="tip", force=(0.0, -1000.0))
    factor = plane_push(msgspec.structs.replace(short(root="contraction-free"), loads=(force,)), 1.0)
    np.testing.assert_allclose(1000.0 * factor.load, short_push.load)


def test_a_scene_led_by_load_gives_the_same_curve(short_push: PlanePush) -> None:
    """Up to a load that it bears, and up to the limit, which it names; its estimate is of the load, too."""
    scene = short(root="contraction-free")
    bearable, too_much = (
        msgspec.structs.replace(
            scene, pushed=Push(node="tip", direction=(0.0, -1.0), control="load", largest_load=load)
        )
        for load in (120e3, 170e3)
    )
    found = plane_push(bearable, 1.0)
    assert found.load[-1] == pytest.approx(120e3)
    there = np.interp(found.displacement, short_push.displacement, short_push.load)
    np.testing.assert_allclose(found.load, there, atol=2e-3 * 120e3)
    assert 0.0 < found.error_estimate <= 5e-3
    stopped = plane_push(too_much, 1.0)
    assert stopped.outcome.startswith("no equilibrium beyond a load of")
    # Reference case C7-ps-Lh2 with a free root: 154466 N on its finest mesh.
    assert stopped.load[-1] == pytest.approx(154466.0, rel=2e-3)
    # Points led by load are far apart where the curve is flat; straight lines between them count as error.
    assert 0.0 < stopped.error_estimate <= 1.5e-2


def test_a_guided_tip_bears_both_ends_hinges() -> None:
    """Fixed–guided: P L = 2 M_p in beam theory; the short member's clamps add a few per cent."""
    scene = cantilever("rectangle 50x100 mm", 0.5, 0.01)
    nodes = {**scene.nodes, "tip": msgspec.structs.replace(scene.nodes["tip"], support="guided-y")}
    body = plane_scene(msgspec.structs.replace(scene, nodes=nodes)).body(1)
    load = trace(body, [np.linspace(0.0, 0.01, 9)[1:]]).load
    assert load[-1] == pytest.approx(2.0 * 29375.0 / 0.5, rel=0.08)
    assert load[-1] > 2.0 * 29375.0 / 0.5


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"kinematics": "large"}, "small displacements"),
        ({"pushed": Push(node="tip", direction=(0, -1), distance=1e-3, control="arc-length")}, "displacement or load"),
        ({"loads": (Load(node="tip", moment=1.0),)}, "proportional loads"),
        ({"section": "IPE 100"}, "rectangular section"),
        ({"support": "pinned"}, "clamped at the other end"),
    ],
)
def test_what_plane_stress_cannot_follow_is_said(change: dict[str, Any], fault: str) -> None:
    scene = short("plane-stress")
    if "section" in change:
        scene = cantilever(change["section"], 0.2, 1e-3)
        change = {"reference": "plane-stress"}
    elif "support" in change:
        nodes = {**scene.nodes, "root": msgspec.structs.replace(scene.nodes["root"], support="pinned")}
        change = {"nodes": nodes}
    with pytest.raises(InputError, match=fault) as error:
        push_over(msgspec.structs.replace(scene, **change))
    assert 'write "beam"' in str(error.value)


def test_a_body_that_cannot_carry_its_weight_is_reported() -> None:
    with pytest.raises(NotConverged, match="dead loads"):
        plane_push(msgspec.structs.replace(short(), gravity=1e7))


def test_fields_stay_on_the_yield_surface_and_make_a_series(short_push: PlanePush) -> None:
    found = short_push
    texts = field_files(found.fields)
    series = [name for name in texts if name.endswith(".vtu")]
    assert len(series) == len(found.fields.states) == 13
    assert all(f'file="{name}"' in texts["fields.pvd"] for name in series)
    assert found.fields.displacement[0] == 0.0
    assert found.fields.displacement[-1] == found.displacement[-1]
