"""Sections and frames of other kinds than the reference cases, eight bodies a member, against fibre finite elements."""

import numpy as np
import pytest

from calibration.comparable_push import push_model
from fem_reference import pushover
from scene import parse_scene
from sim import Model

NINE = Model("graded", 9, "fibre", 16)
STEEL = "fy=235 MPa, E=210 GPa, rho=7850 kg/m^3"
HARDENING = f"{STEEL}, Et=1.05 GPa"
Place = tuple[float, float, str]


def frame(
    nodes: dict[str, Place], members: dict[str, str], push: str, loads: tuple[str, ...] = (), kinematics: str = "large"
) -> str:
    """Members are named "a-b" after their nodes; loads are bodies of [[loads]]."""
    lines = ['title = "test"', "gravity = 0.0", f'kinematics = "{kinematics}"']
    lines += [f'nodes.{name} = {{ at = [{x!r}, {y!r}], support = "{kind}" }}' for name, (x, y, kind) in nodes.items()]
    for name, properties in members.items():
        a, b = name.split("-")
        lines.append(f'members.{name} = {{ from = "{a}", to = "{b}", theory = "euler-bernoulli", {properties} }}')
    lines += [text for load in loads for text in ("[[loads]]", load)]
    return "\n".join([*lines, "[push]", push])


def of(section: str, material: str = HARDENING, more: str = "") -> str:
    return f'section = "{section}", material = "{material}"{more}'


def along(node: str, direction: str, distance: float) -> str:
    return f'node = "{node}"\ndirection = {direction}\ndistance = {distance!r}'


def cantilever(properties: str, length: float, distance: float, kinematics: str) -> str:
    nodes: dict[str, Place] = {"A": (0.0, 0.0, "clamped"), "B": (length, 0.0, "free")}
    return frame(nodes, {"A-B": properties}, along("B", "[0, -1]", distance), kinematics=kinematics)


def braced() -> str:
    """A portal whose diagonal of tube, hinged at both ends, yields all along and hardens."""
    nodes: dict[str, Place] = {
        "A": (0.0, 0.0, "clamped"),
        "B": (0.0, 3.0, "free"),
        "C": (5.0, 3.0, "free"),
        "D": (5.0, 0.0, "clamped"),
    }
    members = dict.fromkeys(("A-B", "B-C", "D-C"), of("IPE 300"))
    members["A-C"] = of("CHS 76.1x4 mm", more=', releases = ["from", "to"]')
    return frame(nodes, members, along("B", "[1, 0]", 0.08))


def unequal() -> str:
    """Columns of other lengths, sections and feet; heavy loads on both first."""
    nodes: dict[str, Place] = {
        "A": (0.0, 0.0, "clamped"),
        "B": (0.0, 5.0, "free"),
        "C": (7.0, 5.0, "free"),
        "D": (7.0, 2.0, "pinned"),
    }
    members = {"A-B": of("HEB 240", STEEL), "B-C": of("IPE 300", STEEL), "D-C": of("IPE 240", STEEL)}
    weights = tuple(f'node = "{node}"\nforce = [0.0, -3e5]\nkind = "dead"' for node in "BC")
    loads = (*weights, 'node = "B"\nforce = [1.0, 0.0]', 'member = "B-C"\nper_length = [0.0, -0.2]')
    return frame(nodes, members, along("B", "[1, 0]", 0.2), loads)


def beam_to_and_fro() -> str:
    """Clamped at both ends, its longer part yields at its clamp only as it hardens; cycles that grow."""
    nodes: dict[str, Place] = {"A": (0.0, 0.0, "clamped"), "B": (2.0, 0.0, "free"), "C": (5.0, 0.0, "clamped")}
    stops = "[0.01, -0.01, 0.02, -0.02, 0.03, -0.03]"
    push = f'node = "B"\ndirection = [0, -1]\nturning_points = {stops}'
    return frame(nodes, dict.fromkeys(("A-B", "B-C"), of("IPE 240")), push, kinematics="small")


def curve_of_stresses() -> str:
    curve = "E=200 GPa, rho=7850 kg/m^3, curve=0.00125:250 0.01:300 0.05:400 MPa"
    return cantilever(of("rectangle 60x120 mm", curve), 2.0, 0.3, "large")


def lean_to() -> str:
    """A roof of 14° between columns of other heights, one pinned; dead load along it, then sway."""
    nodes: dict[str, Place] = {
        "A": (0.0, 0.0, "pinned"),
        "B": (0.0, 3.0, "free"),
        "C": (6.0, 4.5, "free"),
        "D": (6.0, 0.0, "clamped"),
    }
    loads = ('member = "B-C"\nper_length = [0.0, -12e3]\nkind = "dead"', 'node = "B"\nforce = [-1.0, 0.0]')
    members = dict.fromkeys(("A-B", "B-C", "D-C"), of("IPE 270", STEEL))
    return frame(nodes, members, along("B", "[-1, 0]", 0.25), loads)


def pulled() -> str:
    """Half of N_pl in tension first; the cantilever then bends as a rope does."""
    nodes: dict[str, Place] = {"A": (0.0, 0.0, "clamped"), "B": (2.2, 0.0, "free")}
    pull = 'node = "B"\nforce = [9.2e5, 0.0]\nkind = "dead"'
    return frame(nodes, {"A-B": of("HEB 200")}, along("B", "[0, -1]", 0.25), (pull,))


def on_brackets() -> str:
    """A strut of 4 m, loaded through brackets that are a third as long as they are deep, up to and past its limit."""
    nodes: dict[str, Place] = {
        "A": (0.0, 0.0, "pinned"),
        "B": (0.1, 0.0, "free"),
        "C": (0.1, 2.0, "free"),
        "D": (0.1, 4.0, "free"),
        "E": (0.0, 4.0, "roller-y"),
    }
    members = {"A-B": of("HEB 300"), "B-C": of("IPE 200"), "C-D": of("IPE 200"), "D-E": of("HEB 300")}
    return frame(nodes, members, along("E", "[0, -1]", 0.05))


CASES: dict[str, str] = {
    "tee": cantilever(of("T 150x150x10x15 mm"), 1.5, 0.12, "small"),
    "polygon": cantilever(of("polygon 0,0 120,0 120,20 70,20 70,160 50,160 50,20 0,20 mm"), 2.0, 0.15, "small"),
    "curve of stresses": curve_of_stresses(),
    "braced": braced(),
    "unequal": unequal(),
    "beam to and fro": beam_to_and_fro(),
    "lean-to": lean_to(),
    "pulled": pulled(),
    "on brackets": on_brackets(),
}


@pytest.mark.parametrize("name", CASES)
def test_paths_follow_the_finite_elements(name: str) -> None:
    """Within 1 % of the peak load and the reference's own estimate, at 1/60 s."""
    scene = parse_scene(CASES[name], name)
    reference = pushover(scene, 3e-3)
    assert reference.error_estimate <= 3e-3
    push = push_model(scene, NINE, reference.displacement)
    assert push.unconverged == 0
    assert push.bodies <= 8 * len(scene.members) + len(scene.nodes)
    error = np.abs(push.load_at_distances - reference.load).max() / np.abs(reference.load).max()
    assert error <= 0.01 + reference.error_estimate
