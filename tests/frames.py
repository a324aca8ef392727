"""The beams and frames of the reference cases, as scenes."""

from collections.abc import Mapping, Sequence
from typing import Any

from scene import Scene, parse_scene

STEEL = "fy=235 MPa, E=210 GPa, rho=7850 kg/m^3"
IPE300 = "I 300x150x7.1x10.7 mm"  # without root radius, as in the cases


def frame_scene(*args: Any, **options: Any) -> Scene:
    """The scene of `frame_text`."""
    return parse_scene(frame_text(*args, **options), "test")


def frame_text(
    nodes: Mapping[str, tuple[float, float, str]],
    members: Sequence[tuple[str, str]],
    push: str,
    loads: Sequence[str] = (),
    section: str = IPE300,
    material: str = STEEL,
    kinematics: str = "small",
    extra: str = "",
) -> str:
    """A weightless frame of one section; members are named "a-b" after their nodes, loads are bodies of [[loads]]."""
    lines = ['title = "test"', "gravity = 0.0", f'kinematics = "{kinematics}"']
    for name, (x, y, support) in nodes.items():
        lines += [f"[nodes.{name}]", f"at = [{x!r}, {y!r}]", f'support = "{support}"']
    for a, b in members:
        lines += [f"[members.{a}-{b}]", f'from = "{a}"', f'to = "{b}"', f'section = "{section}"']
        lines += [f'material = "{material}"', 'theory = "euler-bernoulli"']
    for load in loads:
        lines += ["[[loads]]", load]
    return "\n".join([*lines, push, extra])


def push_towards(node: str, direction: Sequence[int], distance: float) -> str:
    return f'[push]\nnode = "{node}"\ndirection = {list(direction)}\ndistance = {distance!r}'


def push_down(node: str, distance: float) -> str:
    return push_towards(node, (0, -1), distance)


def down(node: str) -> str:
    """A load of 1 N downwards."""
    return f'node = "{node}"\nforce = [0.0, -1.0]'


def spread(member: str) -> str:
    """A load of 1 N/m downwards."""
    return f'member = "{member}"\nper_length = [0.0, -1.0]'


def fixed_fixed(distance: float) -> Scene:
    """C2-fixedfixed-udl: 8 m, both ends clamped, even load; pushed at its middle C."""
    nodes = {"A": (0.0, 0.0, "clamped"), "C": (4.0, 0.0, "free"), "B": (8.0, 0.0, "clamped")}
    return frame_scene(nodes, [("A", "C"), ("C", "B")], push_down("C", distance), [spread("A-C"), spread("C-B")])


def propped(distance: float) -> Scene:
    """C2-propped-centre: 6 m, clamped and on a roller, load in the middle."""
    nodes = {"A": (0.0, 0.0, "clamped"), "C": (3.0, 0.0, "free"), "B": (6.0, 0.0, "roller-x")}
    return frame_scene(nodes, [("A", "C"), ("C", "B")], push_down("C", distance), [down("C")])


def two_spans(first: float, second: float, even: bool, distance: float) -> Scene:
    """C2-twospan-*: two spans A–B and B–D, even load or a load in the middle C of the second."""
    nodes = {
        "A": (0.0, 0.0, "pinned"),
        "M": (first / 2, 0.0, "free"),
        "B": (first, 0.0, "roller-x"),
        "C": (first + second / 2, 0.0, "free"),
        "D": (first + second, 0.0, "roller-x"),
    }
    members = [("A", "M"), ("M", "B"), ("B", "C"), ("C", "D")]
    loads = [spread(f"{a}-{b}") for a, b in members] if even else [down("C")]
    return frame_scene(nodes, members, push_down("C", distance), loads)


def portal_text(h: float, span: float, ratio: float, push: str, kinematics: str = "small") -> str:
    """C2-portal-*: fixed bases A and E, knees B and D, beam centre C; V down at C and H = ratio V at B."""
    nodes = {
        "A": (0.0, 0.0, "clamped"),
        "B": (0.0, h, "free"),
        "C": (span / 2, h, "free"),
        "D": (span, h, "free"),
        "E": (span, 0.0, "clamped"),
    }
    members = [("A", "B"), ("B", "C"), ("C", "D"), ("E", "D")]
    loads = [down("C"), f'node = "B"\nforce = [{ratio!r}, 0.0]']
    return frame_text(nodes, members, push, loads, kinematics=kinematics)


def portal(h: float, span: float, ratio: float, node: str, distance: float, kinematics: str = "small") -> Scene:
    """The scene of `portal_text`, C pushed down or another node to the right."""
    push = push_towards(node, (0, -1) if node == "C" else (1, 0), distance)
    return parse_scene(portal_text(h, span, ratio, push, kinematics), "test")


def compressed_cantilever(n: float, distance: float, kinematics: str = "small") -> Scene:
    """C4-rect: rectangle 50 × 100 mm, 1 m, axial compression of n N_pl first, then pushed at its tip."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (1.0, 0.0, "free")}
    loads = [f'node = "B"\nforce = [{-n * 1175e3!r}, 0.0]\nkind = "dead"']
    return frame_scene(
        nodes, [("A", "B")], push_down("B", distance), loads, section="rectangle 50x100 mm", kinematics=kinematics
    )
