"""The reference cases of pushes, groups 1 to 5, run with at most eight bodies a member (sources in tests/data)."""

import itertools
from typing import Any

import numpy as np
import pytest
from conftest import CASES
from open_scenes import open_scenes

import sim
from calibration.comparable_push import push_model
from scene import Scene, parse_scene
from sim import Model

SCENES = open_scenes(CASES)
FIBRES = Model("lobatto", 9, "fibre", 16)
FINE = Model("lobatto", 9, "fibre", 24)
#: What knows no interaction of N and M, as the closed form of the collapse loads.
HINGES = Model("lobatto", 5, "elastic-plastic")


def case_of(name: str) -> dict[str, Any]:
    outputs: dict[str, Any] = CASES[max((case for case in CASES if name.startswith(case)), key=len)]["outputs"]
    return outputs


def curve(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and loads that the case gives."""
    o = case_of(name)
    if name.startswith(("C1", "C2-ss")):
        return np.array(o["delta_over_dy"]) * o["delta_y_m"], np.array(o["P_N"])
    if name == "C2-fixedfixed-udl":
        full = o["concentrated_hinge"]["w2_collapse_N_per_m"]
        return np.array(o["distributed"]["delta_mid_m"]), full * np.array(o["distributed"]["w_over_wp"])
    if name.startswith(("C2-propped", "C2-twospan")):
        key = "delta_m" if "propped" in name else "delta2_m"
        return np.array(o["distributed"][key]), o["lambda_collapse"] * np.array(
            o["distributed"]["lambda_over_collapse"]
        )
    if name.startswith("C2-portal-table"):
        row = next(r for r in o["table"] if name.endswith(f"L{r['L']:g}-HV{r['H_over_V']:g}"))
        return np.array([0.2]), np.array([row["V_collapse_N"]])
    if name.startswith("C2-portal"):
        kinds = {"small": "V_fibre_linear_N", "p-delta": "V_fibre_PDelta_N", "large": "V_fibre_corotational_N"}
        return np.array(o["disp_m"]), np.array(o[kinds[name.split("-", 3)[3]]])
    if name.startswith("C4"):
        row = next(r for r in o["rows"] if f"n{r['n']}" in name)
        loads = row["P_PDelta_N"] if "p-delta" in name else row["P_N"]
        return np.array(row["delta_over_dy"]) * o["delta_y_m_no_axial"], np.array(loads)
    if name == "C5-elastica":
        return np.array(o["delta_v_over_L"]), np.array(o["alpha"]) * 210e9 * 0.004 * 0.005**3 / 12.0
    return 2.0 * np.array(o["delta_over_L"]), np.array(o["P_N"])


def model_for(name: str) -> Model:
    if name.startswith("C2-portal-table"):
        return HINGES
    return FINE if name.startswith("C5") or name.endswith("p-delta") else FIBRES


def pushed(scene: Scene, model: Model, way: np.ndarray) -> sim.Push:
    return (push_model if scene.kinematics == "small" else sim.push_over)(scene, model, way)


@pytest.mark.parametrize("name", [name for name in SCENES if not name.startswith(("C3", "C7"))])
def test_paths_are_followed_within_one_per_cent_of_their_peak(name: str) -> None:
    """P–Δ comes of the geometry: the bodies are where they are. Cycles (C3) are below; a continuum (C7) is fitted."""
    scene = parse_scene(SCENES[name], name)
    displacements, loads = curve(name)
    way = np.linspace(0.0, displacements[-1], 401)
    push = pushed(scene, model_for(name), way)
    assert push.unconverged == 0
    assert push.bodies <= 8 * len(scene.members) + len(scene.nodes)
    found = np.interp(displacements, way, push.load_at_distances)
    assert np.abs(found - loads).max() <= 0.01 * loads.max()


@pytest.mark.parametrize("name", ["C3-rect", "C3-ipe300"])
def test_cycles(name: str) -> None:
    """Peaks within 1 %, energy of each loop within 2 %, what stays after unloading within 0.02 δ_y."""
    scene, outputs = parse_scene(SCENES[name], name), case_of(name)
    dy, amplitudes = outputs["delta_y_m"], outputs["amplitude_over_dy"]
    legs = [np.linspace(a, b, 101)[:-1] for a, b in itertools.pairwise([0.0, *scene.push.stops()])]
    back = np.linspace(6.0 * dy, 4.0 * dy, 101)
    way = np.concatenate([*legs, back])
    load = pushed(scene, Model("lobatto", 9, "fibre", 16, dt=1 / 240), way).load_at_distances
    for i, (peak, loop) in enumerate(zip(outputs["peak_P_N"], outputs["loop_energy_J"], strict=True)):
        around = slice(100 * (3 * i + 1), 100 * (3 * i + 3) + 1)
        assert load[around.start] == pytest.approx(peak, rel=0.01)
        assert np.trapezoid(load[around], way[around]) == pytest.approx(loop, rel=0.02)
    unloading = slice(100 * (3 * len(amplitudes)), None)
    rest = float(np.interp(0.0, -load[unloading], way[unloading]))
    assert rest / dy == pytest.approx(outputs["residual_over_dy_after_unloading_from_plus_a"][-1], abs=0.02)


@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("C2-portal-table-L6")])
def test_rigid_plastic_portals_fold_at_their_collapse_load(name: str) -> None:
    """As soon as they move: after 5 mm, and in the limit of small displacements after 0.2 m; within 0.2 %."""
    scene, (_, loads) = parse_scene(SCENES[name], name), curve(name)
    model = Model("lobatto", 3, "rigid-plastic")
    near = sim.push_over(scene, model, np.linspace(0.0, 0.005, 21))
    far = push_model(scene, model, np.linspace(0.0, 0.2, 21))
    assert near.unconverged == far.unconverged == 0
    assert near.load_at_distances[-1] == pytest.approx(loads[0], rel=2e-3)
    assert far.load_at_distances[-1] == pytest.approx(loads[0], rel=2e-3)
