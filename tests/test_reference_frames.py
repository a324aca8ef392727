"""Beams and frames of the reference against closed forms and OpenSees; sources are in the reference cases."""

from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np
import pytest
from frames import (
    IPE300,
    compressed_cantilever,
    fixed_fixed,
    frame_scene,
    portal,
    propped,
    push_down,
    push_towards,
    two_spans,
)

from fem_reference import pushover
from fem_reference.frame_mesh import build_frame
from scene import Scene

Case = Callable[[str], dict[str, Any]]


M_P = 141493.1190649999


BEAMS: dict[str, tuple[Callable[[float], Scene], str]] = {
    "C2-propped-centre": (propped, "delta_m"),
    "C2-twospan-udl": (lambda d: two_spans(4.0, 6.0, True, d), "delta2_m"),
    "C2-twospan-point": (lambda d: two_spans(5.0, 5.0, False, d), "delta2_m"),
}


@pytest.mark.parametrize("name", BEAMS)
def test_indeterminate_beams_follow_the_force_method(name: str, case: Case) -> None:
    """Load at every tabulated deflection up to 0.9999 of collapse, within 0.1 % and the own estimate."""
    build, key = BEAMS[name]
    outputs = case(name)["outputs"]
    levels, deflection = outputs["distributed"]["lambda_over_collapse"], outputs["distributed"][key]
    answer = pushover(build(deflection[-1]))
    found = np.interp(deflection, answer.displacement, answer.load) / outputs["lambda_collapse"]
    assert np.abs(found / np.array(levels) - 1.0).max() <= 1e-3
    assert np.abs(found - levels).max() <= answer.error_estimate


def test_hinges_of_a_clamped_beam_form_at_both_ends_then_in_the_middle(case: Case) -> None:
    outputs = case("C2-fixedfixed-udl")["outputs"]
    distributed = outputs["distributed"]
    answer = pushover(fixed_fixed(distributed["delta_mid_m"][-1]))
    collapse = outputs["concentrated_hinge"]["w2_collapse_N_per_m"]
    found = np.interp(distributed["delta_mid_m"], answer.displacement, answer.load) / collapse
    assert np.abs(found / np.array(distributed["w_over_wp"]) - 1.0).max() <= 1e-3
    assert [hinge.node for hinge in answer.hinges[:2]] in (["A", "B"], ["B", "A"])
    assert answer.hinges[2].node == "C"
    for hinge in answer.hinges[:2]:
        assert hinge.load == pytest.approx(distributed["w_end_reaches_Mp_N_per_m"], rel=3e-3)
    assert answer.hinges[2].load == pytest.approx(collapse, rel=1e-3)
    assert answer.outcome.startswith("mechanism")


@pytest.mark.parametrize(
    ("name", "node", "ratio", "kinematics", "key"),
    [
        ("C2-portal-HV0.2", "C", 0.2, "small", "linear"),
        ("C2-portal-HV0.2", "C", 0.2, "p-delta", "PDelta"),
        ("C2-portal-HV2.0", "B", 2.0, "small", "linear"),
        ("C2-portal-HV2.0", "B", 2.0, "p-delta", "PDelta"),
        ("C2-portal-HV2.0", "B", 2.0, "large", "corotational"),
    ],
)
def test_portal_follows_opensees(name: str, node: str, ratio: float, kinematics: str, key: str, case: Case) -> None:
    """OpenSees fibre frames, uncertain to 0.25 %; collapse load and order of hinges as by the kinematic theorem."""
    outputs = case(name)["outputs"]
    answer = pushover(portal(4.0, 6.0, ratio, node, 0.2, kinematics), 1e-3)
    found = np.interp(outputs["disp_m"], answer.displacement, answer.load)
    assert np.abs(found / np.array(outputs[f"V_fibre_{key}_N"]) - 1.0).max() <= 3e-3
    assert answer.imbalance <= 1e-5
    expected = {"C": ["C", "D", "B"], "B": ["E", "A", "D", "B"]}[node]
    assert [hinge.node for hinge in answer.hinges] == expected
    if kinematics == "small":
        assert answer.outcome.startswith("mechanism")
        assert answer.load.max() == pytest.approx(outputs["V_collapse_hinge_N"], rel=0.008)  # N–M interaction
    else:
        assert answer.outcome.startswith("limit point")


@pytest.mark.parametrize("row", range(15))
def test_ideal_hinges_form_as_in_a_table_of_portals(row: int, case: Case) -> None:
    """Collapse loads by the kinematic theorem, hinge by hinge by elastic analysis; both exact."""
    expected = case("C2-portal-table")["outputs"]["table"][row]
    node = "B" if expected["mechanism"] == "sway" else "C"
    scene = portal(expected["h"], expected["L"], expected["H_over_V"], node, 0.25)
    answer = pushover(msgspec.structs.replace(scene, yielding="ideal-hinges"))
    assert answer.load.max() == pytest.approx(expected["V_collapse_N"], rel=1e-6)
    assert answer.outcome.startswith("mechanism")
    assert [hinge.node for hinge in answer.hinges] == [where[0] for where, _ in expected["hinge_sequence"]]
    for hinge, (_, load) in zip(answer.hinges, expected["hinge_sequence"], strict=True):
        assert hinge.load == pytest.approx(load, rel=1e-6)


@pytest.mark.parametrize("row", [0, 1, 2])
def test_axial_force_lowers_the_collapse_load(row: int, case: Case) -> None:
    """P = M_pl,N / L exactly; OpenSees on the way there, to its own uncertainty."""
    outputs = case("C4-rect")["outputs"]
    values = outputs["rows"][row]
    deflection = np.array(values["delta_over_dy"]) * outputs["delta_y_m_no_axial"]
    answer = pushover(compressed_cantilever(values["n"], float(deflection[-1])))
    assert answer.load[-1] == pytest.approx(values["P_collapse_N"], rel=3e-4)
    found = np.interp(deflection, answer.displacement, answer.load)
    assert np.abs(found - values["P_N"]).max() / values["P_collapse_N"] <= 3e-3
    assert answer.members["A-B"].end_forces[-1, 0, 0] == pytest.approx(-values["n"] * 1175e3, rel=1e-9)


def test_elastic_p_delta_of_a_column_is_the_closed_form() -> None:
    """u = P (tan kL - kL) / (N k), k² = N / EI (Timoshenko & Gere, Theory of Elastic Stability, section 1.2)."""
    answer = pushover(compressed_cantilever(0.2, 1e-3, "p-delta"))
    force = 0.2 * 1175e3
    k = np.sqrt(force / 875e3)
    assert answer.load[-1] == pytest.approx(force * k * 1e-3 / (np.tan(k) - k), rel=2e-4)


@pytest.mark.parametrize(
    ("name", "section", "length"), [("C3-rect", "rectangle 50x100 mm", 1.0), ("C3-ipe300", IPE300, 3.0)]
)
def test_cycles_follow_the_masing_rule(name: str, section: str, length: float, case: Case) -> None:
    outputs = case(name)["outputs"]
    stops = [a * outputs["delta_y_m"] for a in (2, -2, 2, 4, -4, 4, 6, -6, 6)]
    push = f'[push]\nnode = "B"\ndirection = [0, -1]\nturning_points = {stops}\nunload = true'
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (length, 0.0, "free")}
    answer = pushover(frame_scene(nodes, [("A", "B")], push, section=section))
    ends = [100 * (i + 1) for i in range(9)]
    for i, expected in enumerate(outputs["loop_energy_J"]):
        loop = slice(ends[3 * i], ends[3 * i + 2] + 1)
        area = np.trapezoid(answer.load[loop], answer.displacement[loop])
        assert area == pytest.approx(expected, rel=1e-3)
        assert answer.load[ends[3 * i]] == pytest.approx(outputs["peak_P_N"][i], rel=1e-4)
    assert answer.residual / outputs["delta_y_m"] == pytest.approx(
        outputs["residual_over_dy_after_unloading_from_plus_a"][-1], abs=1e-4
    )
    assert answer.energy.external[ends[-1]] == pytest.approx(outputs["total_energy_0_to_last_peak_J"], rel=1e-3)
    balance = answer.energy.external - answer.energy.elastic - answer.energy.plastic
    assert np.abs(balance).max() <= 1e-6 * answer.energy.external[-1]


def test_plastic_cantilever_bent_to_half_its_length(case: Case) -> None:
    outputs = case("C5-epp-corot")["outputs"]
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (2.0, 0.0, "free")}
    answer = pushover(
        frame_scene(nodes, [("A", "B")], push_down("B", 1.0), section="rectangle 50x100 mm", kinematics="large")
    )
    found = np.interp(2.0 * np.array(outputs["delta_over_L"]), answer.displacement, answer.load)
    assert np.abs(found / np.array(outputs["P_N"]) - 1.0).max() <= 5e-4


def test_elastica(case: Case) -> None:
    """Inextensible closed form; here A L² / I = 4.8e5, so extension counts for some 1e-4 at most."""
    outputs = case("C5-elastica")["outputs"]
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (1.0, 0.0, "free")}
    strong = "fy=1e6 MPa, E=210 GPa, rho=7850 kg/m^3"
    scene = frame_scene(
        nodes,
        [("A", "B")],
        push_down("B", 0.8106090248802965),
        section="rectangle 4x5 mm",
        material=strong,
        kinematics="large",
    )
    answer = pushover(scene, 1e-3)
    alpha = np.interp(outputs["delta_v_over_L"], answer.displacement, answer.load) / scene.capacity("A-B").EI
    assert np.abs(alpha / np.array(outputs["alpha"]) - 1.0).max() <= 2e-3
    tip = answer.members["A-B"].shape[-1]
    assert tip[0] == pytest.approx(-outputs["delta_h_over_L"][-1], rel=2e-3)


@pytest.mark.parametrize("kinematics", ["p-delta", "large"])
def test_tangent_is_the_derivative_of_the_forces(kinematics: str) -> None:
    frame = build_frame(portal(4.0, 6.0, 1.0, "B", 0.1, kinematics), 4, 8)
    rng = np.random.default_rng(1)
    d = 1e-3 * rng.standard_normal(frame.size)
    move = rng.standard_normal(frame.size)
    ahead, behind = (frame.respond(d + s * 1e-7 * move, frame.undeformed()) for s in (1.0, -1.0))
    tangent = frame.respond(d, frame.undeformed()).matrices
    product = np.einsum("eij,ej->ei", tangent, move[frame.dofs])
    difference = (ahead.element_forces - behind.element_forces) / 2e-7
    assert np.abs(product - difference).max() <= 2e-4 * np.abs(product).max()


def test_a_frame_turned_as_a_whole_is_not_strained() -> None:
    frame = build_frame(portal(4.0, 6.0, 1.0, "B", 0.1, "large"), 4, 8)
    turn = 2.5
    d = np.zeros(frame.size)
    c, s = np.cos(turn), np.sin(turn)
    origin = _starts(frame)
    for columns, place in (((0, 1, 2), origin), ((3, 4, 5), origin + frame.chords.span)):
        moved = place @ np.array([[c, s], [-s, c]]) - place
        d[frame.dofs[:, columns[0]]], d[frame.dofs[:, columns[1]]] = moved.T
        d[frame.dofs[:, columns[2]]] = turn
    assert np.abs(frame.respond(d, frame.undeformed()).internal).max() <= 1e-3  # N, beside forces of 1e5


def _starts(frame: Any) -> np.ndarray:
    ends = {"A": (0.0, 0.0), "B": (0.0, 4.0), "C": (3.0, 4.0), "D": (6.0, 4.0), "E": (6.0, 0.0)}
    rows = []
    first = 0
    for name, mesh in frame.meshes.items():
        spans = frame.chords.span[first : first + len(mesh.weights)]
        first += len(mesh.weights)
        rows.append(np.array(ends[name[0]]) + np.vstack([np.zeros(2), np.cumsum(spans, axis=0)[:-1]]))
    return np.concatenate(rows)


def test_every_quoted_number_has_an_error_estimate_that_covers_its_error() -> None:
    """Held against a model of four times the elements and fibres."""
    scene = portal(4.0, 6.0, 1.0, "B", 0.06)
    rough, fine = pushover(scene, 5e-3), pushover(scene, 1e-4)
    assert fine.elements >= 4 * rough.elements
    for name, member in rough.members.items():
        errors, exact = rough.member_errors[name], fine.members[name]
        ends = np.abs(member.end_forces[-1] - exact.end_forces[-1]).max(axis=0)
        assert np.all(ends <= errors.end_forces + 1e-6 * np.abs(exact.end_forces).max())
        shape = [np.interp(member.point, exact.point, exact.shape[:, i]) for i in (0, 1)]
        assert np.abs(member.shape.T - shape).max() <= 1.5 * errors.shape
        moment = np.interp(member.station, exact.station, exact.moment)
        assert np.abs(member.moment - moment).max() <= 1.5 * errors.moment.max()
        curvature = np.interp(member.station, exact.station, exact.curvature)
        elastic = member.plastic_strain < 1e-9
        assert np.abs(member.curvature - curvature)[elastic].max() <= 1.5 * errors.curvature[elastic].max()
    assert (
        rough.energy.error_estimate
        >= abs(rough.energy.plastic[-1] - fine.energy.plastic[-1]) / fine.energy.external[-1]
    )
    for hinge, exact_hinge in zip(rough.hinges, fine.hinges, strict=False):
        assert hinge.node == exact_hinge.node
        assert abs(hinge.load - exact_hinge.load) <= 2.0 * hinge.error_estimate * rough.load.max()


@pytest.mark.parametrize("kinematics", ["small", "p-delta", "large"])
def test_loads_along_a_member_come_to_its_foot_in_full(kinematics: str) -> None:
    """A column under an even load along it: N = - q L at its foot, and q L / 2 in the middle."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (0.0, 4.0, "free")}
    load = 'member = "A-B"\nper_length = [0.0, -5e4]\nkind = "dead"'
    scene = frame_scene(nodes, [("A", "B")], push_towards("B", (1, 0), 0.01), [load], kinematics=kinematics)
    member = pushover(scene, 1e-2).members["A-B"]
    assert member.end_forces[0, 0, 0] == pytest.approx(-2e5, rel=1e-6)
    middle = float(np.interp(2.0, member.station, np.asarray(member.axial_force).reshape(-1, len(member.station))[-1]))
    assert middle == pytest.approx(-1e5, rel=1e-3)
