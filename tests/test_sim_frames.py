"""Members and frames as rigid bodies against the reference cases (sources and uncertainties in tests/data)."""

import itertools

import numpy as np
import pytest
from conftest import CASES
from frames import fixed_fixed, frame_scene, portal, propped, push_down, two_spans

import sim
from capacity import Interaction
from scene import Scene
from sim import Model

FINE = Model("lobatto", 9, "fibre", 16)


def loads_at(scene: Scene, distances: np.ndarray, model: Model = FINE) -> np.ndarray:
    """Loads of the model where the pusher has come to each of ``distances``, by small steps."""
    way = np.linspace(0.0, distances[-1], 401)
    push = sim.push_over(scene, model, way)
    assert push.unconverged == 0
    return np.interp(distances, push.displacement, push.load)


def test_propped_cantilever_with_a_load_in_the_middle() -> None:
    """C2-propped-centre: hinge at the fixed end, then in the middle; within 1 % of the collapse load."""
    outputs = CASES["C2-propped-centre"]["outputs"]
    nodes = {"A": (0.0, 0.0, "clamped"), "C": (3.0, 0.0, "free"), "B": (6.0, 0.0, "roller-x")}
    curve = outputs["distributed"]
    scene = frame_scene(nodes, [("A", "C"), ("C", "B")], push_down("C", curve["delta_m"][-1]))
    loads = loads_at(scene, np.array(curve["delta_m"])) / outputs["lambda_collapse"]
    np.testing.assert_allclose(loads, curve["lambda_over_collapse"], atol=0.01)


def test_simply_supported_beam() -> None:
    """C2-ss-centre to five times the deflection at first yield; within 1 % of the collapse load."""
    outputs = CASES["C2-ss-centre"]["outputs"]
    distances = np.array(outputs["delta_over_dy"]) * outputs["delta_y_m"]
    near = distances <= 5.0 * outputs["delta_y_m"]
    nodes = {"A": (0.0, 0.0, "pinned"), "C": (3.0, 0.0, "free"), "B": (6.0, 0.0, "roller-x")}
    scene = frame_scene(nodes, [("A", "C"), ("C", "B")], push_down("C", float(distances[near][-1])))
    loads = loads_at(scene, distances[near]) / outputs["P_collapse_N"]
    np.testing.assert_allclose(loads, np.array(outputs["P_N"])[near] / outputs["P_collapse_N"], atol=0.01)


def test_cycles_dissipate_what_the_closed_form_says() -> None:
    """C3-rect: peaks within 1 %, energy of the loops within 2 %."""
    outputs = CASES["C3-rect"]["outputs"]
    dy, amplitudes = outputs["delta_y_m"], outputs["amplitude_over_dy"]
    turns = [0.0, *(s * a * dy for a in amplitudes for s in (1.0, -1.0, 1.0))]
    legs = [np.linspace(a, b, 101)[:-1] for a, b in itertools.pairwise(turns)]
    way = np.append(np.concatenate(legs), turns[-1])
    nodes = {"A": (0.0, 0.0, "clamped"), "T": (1.0, 0.0, "free")}
    scene = frame_scene(nodes, [("A", "T")], push_down("T", 6.0 * dy), section="rectangle 50x100 mm")
    push = sim.push_over(scene, Model("lobatto", 9, "fibre", 16, dt=1 / 240), way)
    load = push.load_at_distances
    for i, (peak, loop) in enumerate(zip(outputs["peak_P_N"], outputs["loop_energy_J"], strict=True)):
        at = 100 * (3 * i + 1)
        assert load[at] == pytest.approx(peak, rel=0.01)
        around = slice(at, at + 201)
        area = np.trapezoid(load[around], way[around])
        assert area == pytest.approx(loop, rel=0.02)


@pytest.mark.parametrize("row", [0, 1])
def test_axial_force_lowers_the_path_and_p_delta_follows_from_the_geometry(row: int) -> None:
    """C4-rect with n = 0.2 and 0.5, P–Δ rows: within 1 % of the largest load."""
    outputs = CASES["C4-rect"]["outputs"]
    case, dy = outputs["rows"][row], outputs["delta_y_m_no_axial"]
    distances = np.array(case["delta_over_dy"]) * dy
    nodes = {"A": (0.0, 0.0, "clamped"), "T": (1.0, 0.0, "free")}
    axial = f'node = "T"\nforce = [{-case["n"] * 1175000.0!r}, 0.0]\nkind = "dead"'
    scene = frame_scene(
        nodes, [("A", "T")], push_down("T", float(distances[-1])), [axial], section="rectangle 50x100 mm"
    )
    loads = loads_at(scene, distances, Model("lobatto", 9, "fibre", 24, dt=1 / 240))
    expected = np.array(case["P_PDelta_N"])
    np.testing.assert_allclose(loads, expected, atol=0.01 * expected.max())


@pytest.mark.parametrize("row", [0, 1, 2])
def test_interacting_hinges_fold_at_the_exact_moment_beside_an_axial_force(row: int) -> None:
    """C4-rect: M_pl,N / M_p = 1 - n², with the axial force's moment on the sunk tip; to 0.2 % of both."""
    outputs = CASES["C4-rect"]["outputs"]
    case, dy, squash = outputs["rows"][row], outputs["delta_y_m_no_axial"], 1175e3
    distance = 2.0 * dy
    nodes = {"A": (0.0, 0.0, "clamped"), "T": (1.0, 0.0, "free")}
    axial = f'node = "T"\nforce = [{-case["n"] * squash!r}, 0.0]\nkind = "dead"'
    scene = frame_scene(nodes, [("A", "T")], push_down("T", distance), [axial], section="rectangle 50x100 mm")
    push = sim.push_over(scene, Model("lobatto", 6, "interaction", dt=1 / 240), np.linspace(0.0, distance, 101))
    assert push.unconverged == 0
    reached = push.load[-1] + case["n"] * squash * push.displacement[-1]
    exact = Interaction(scene.members["A-T"].section, scene.members["A-T"].material)
    assert exact.moments_at(case["n"] * squash)[1] == pytest.approx(case["M_plN_Nm"], rel=1e-9)
    assert exact.load_factor(-case["n"] * squash, 0.0, reached) == pytest.approx(1.0, abs=2e-3)


def test_springs_releases_settlements_and_masses() -> None:
    """A beam on a spring bears k δ; a released end bears no moment; a settled support lifts its share of load."""
    nodes = {"A": (0.0, 0.0, "pinned"), "B": (4.0, 0.0, "free"), "C": (2.0, 0.0, "free")}
    members, push = [("A", "C"), ("C", "B")], push_down("C", 0.002)
    spring = "[nodes.B]\nat = [4.0, 0.0]\nspring = [0.0, 1e6, 0.0]"
    scene = frame_scene({k: v for k, v in nodes.items() if k != "B"} | {}, members, push, extra=spring)
    load = loads_at(scene, np.array([0.002]))[0]
    ei = scene.capacity("A-C").EI
    # Half of the load comes to the spring, whose end sinks by P / 2k; the middle by half of that and P L³ / 48 EI.
    assert load == pytest.approx(0.002 / (4.0**3 / (48.0 * ei) + 1.0 / (4.0 * 1e6)), rel=2e-3)


FRAMES = {
    # Curves of the reference cases: displacements, loads, what to divide by, scene to a distance.
    "C2-propped-centre": (
        lambda o: o["distributed"]["delta_m"],
        lambda o: o["distributed"]["lambda_over_collapse"],
        propped,
    ),
    "C2-twospan-udl": (
        lambda o: o["distributed"]["delta2_m"],
        lambda o: o["distributed"]["lambda_over_collapse"],
        lambda d: two_spans(4, 6, True, d),
    ),
    "C2-twospan-point": (
        lambda o: o["distributed"]["delta2_m"],
        lambda o: o["distributed"]["lambda_over_collapse"],
        lambda d: two_spans(5, 5, False, d),
    ),
    "C2-fixedfixed-udl": (
        lambda o: o["distributed"]["delta_mid_m"][:-4],
        lambda o: o["distributed"]["w_over_wp"][:-4],
        fixed_fixed,
    ),
}
COLLAPSE = {"C2-fixedfixed-udl": lambda o: o["concentrated_hinge"]["w2_collapse_N_per_m"]}


@pytest.mark.parametrize("name", FRAMES)
def test_proportional_loads_under_displacement_control(name: str) -> None:
    """Load factors along the path, within 1 % of collapse; distributed loads bear hinges inside the members."""
    outputs = CASES[name]["outputs"]
    displacements, loads, build = FRAMES[name]
    distances = np.array(displacements(outputs))
    collapse = COLLAPSE.get(name, lambda o: o["lambda_collapse"])(outputs)
    found = loads_at(build(float(distances[-1])), distances, Model("lobatto", 14, "fibre", 16)) / collapse
    np.testing.assert_allclose(found, loads(outputs), atol=0.01)


@pytest.mark.parametrize(("name", "ratio", "node"), [("C2-portal-HV0.2", 0.2, "C"), ("C2-portal-HV2.0", 2.0, "B")])
def test_portal_frames(name: str, ratio: float, node: str) -> None:
    """V and H = ratio V on a portal, to 0.2 m: corotational fibre frames of another code, within 1 % of the peak."""
    outputs = CASES[name]["outputs"]
    distances, expected = np.array(outputs["disp_m"]), np.array(outputs["V_fibre_corotational_N"])
    found = loads_at(portal(4.0, 6.0, ratio, node, float(distances[-1])), distances)
    np.testing.assert_allclose(found, expected, atol=0.01 * expected.max())
