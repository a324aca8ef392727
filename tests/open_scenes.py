"""Every reference case of a push, as the text of a scene file."""

from collections.abc import Mapping, Sequence
from typing import Any

from frames import IPE300, down, frame_text, portal_text, push_down, push_towards, spread

RECTANGLE = "rectangle 50x100 mm"
TUBE = "CHS 168.3x8 mm"
#: The elastica: a strip that does not yield, so slender that extension counts for some 1e-4.
STRIP, STRONG = "rectangle 4x5 mm", "fy=1e6 MPa, E=210 GPa, rho=7850 kg/m^3"
#: How far all the portals are pushed [m].
_WAY = 0.2
_CANTILEVER = [("A", "B")]
_TWO_HALVES = [("A", "C"), ("C", "B")]


def open_scenes(cases: Mapping[str, Any]) -> dict[str, str]:
    """Scene files of groups 1 to 5 and 7 by a name that begins with the case's."""
    texts: dict[str, str] = {}
    for case, section in (("C1-rect", RECTANGLE), ("C1-ipe300", IPE300), ("C1-chs", TUBE)):
        inputs, outputs = cases[case]["inputs"], cases[case]["outputs"]
        texts[case] = cantilever(inputs["L_m"], push_down("B", 10.0 * outputs["delta_y_m"]), section=section)
    texts |= _beams(cases)
    texts |= _portals(cases)
    for case, section in (("C3-rect", RECTANGLE), ("C3-ipe300", IPE300)):
        inputs, outputs = cases[case]["inputs"], cases[case]["outputs"]
        stops = [a * outputs["delta_y_m"] for a in (2, -2, 2, 4, -4, 4, 6, -6, 6)]
        push = f'[push]\nnode = "B"\ndirection = [0, -1]\nturning_points = {stops}\nunload = true'
        texts[case] = cantilever(inputs["L_m"], push, section=section)
    outputs = cases["C4-rect"]["outputs"]
    for row in outputs["rows"]:
        axial = f'node = "B"\nforce = [{-row["n"] * 1175e3!r}, 0.0]\nkind = "dead"'
        push = push_down("B", row["delta_over_dy"][-1] * outputs["delta_y_m_no_axial"])
        texts[f"C4-rect-n{row['n']}"] = cantilever(1.0, push, [axial], section=RECTANGLE)
        if row["P_PDelta_N"] is not None:
            name = f"C4-rect-n{row['n']}-p-delta"
            texts[name] = cantilever(1.0, push, [axial], section=RECTANGLE, kinematics="p-delta")
    furthest = cases["C5-elastica"]["outputs"]["delta_v_over_L"][-1]
    texts["C5-elastica"] = cantilever(
        1.0, push_down("B", furthest), [down("B")], section=STRIP, material=STRONG, kinematics="large"
    )
    texts["C5-epp-corot"] = cantilever(2.0, push_down("B", 1.0), [down("B")], section=RECTANGLE, kinematics="large")
    return texts | _continua(cases)


def _continua(cases: Mapping[str, Any]) -> dict[str, str]:
    texts = {}
    for case in ("C7-ps-Lh5", "C7-ps-Lh2"):
        furthest = cases[case]["outputs"]["delta_m"][-1]
        for root in ("clamped", "contraction-free"):
            text = cantilever(cases[case]["inputs"]["L_m"], push_down("B", furthest), section=RECTANGLE)
            text = text.replace('theory = "euler-bernoulli"', 'theory = "timoshenko"')
            texts[f"{case}-{root}"] = f'reference = "plane-stress"\n{text}\n[plane]\nroot = "{root}"'
    return texts


def cantilever(length: float, push: str, loads: Sequence[str] = (), **options: str) -> str:
    """Clamped at A, free at B."""
    return frame_text({"A": (0.0, 0.0, "clamped"), "B": (length, 0.0, "free")}, _CANTILEVER, push, loads, **options)


def _beams(cases: Mapping[str, Any]) -> dict[str, str]:
    outputs = cases["C2-ss-centre"]["outputs"]
    texts = {
        "C2-ss-centre": frame_text(
            {"A": (0.0, 0.0, "pinned"), "C": (3.0, 0.0, "free"), "B": (6.0, 0.0, "roller-x")},
            _TWO_HALVES,
            push_down("C", outputs["delta_over_dy"][-1] * outputs["delta_y_m"]),
        ),
        "C2-fixedfixed-udl": frame_text(
            {"A": (0.0, 0.0, "clamped"), "C": (4.0, 0.0, "free"), "B": (8.0, 0.0, "clamped")},
            _TWO_HALVES,
            push_down("C", cases["C2-fixedfixed-udl"]["outputs"]["distributed"]["delta_mid_m"][-1]),
            [spread("A-C"), spread("C-B")],
        ),
        "C2-propped-centre": frame_text(
            {"A": (0.0, 0.0, "clamped"), "C": (3.0, 0.0, "free"), "B": (6.0, 0.0, "roller-x")},
            _TWO_HALVES,
            push_down("C", cases["C2-propped-centre"]["outputs"]["distributed"]["delta_m"][-1]),
            [down("C")],
        ),
    }
    for case, first, second in (("C2-twospan-udl", 4.0, 6.0), ("C2-twospan-point", 5.0, 5.0)):
        nodes = {
            "A": (0.0, 0.0, "pinned"),
            "M": (first / 2, 0.0, "free"),
            "B": (first, 0.0, "roller-x"),
            "C": (first + second / 2, 0.0, "free"),
            "D": (first + second, 0.0, "roller-x"),
        }
        members = [("A", "M"), ("M", "B"), ("B", "C"), ("C", "D")]
        loads = [spread(f"{a}-{b}") for a, b in members] if case.endswith("udl") else [down("C")]
        furthest = cases[case]["outputs"]["distributed"]["delta2_m"][-1]
        texts[case] = frame_text(nodes, members, push_down("C", furthest), loads)
    return texts


def _portals(cases: Mapping[str, Any]) -> dict[str, str]:
    texts = {}
    for row in cases["C2-portal-table"]["outputs"]["table"]:
        # Pushed where its mechanism moves.
        sideways = row["mechanism"] != "beam"
        push = push_towards("B", (1, 0), _WAY) if sideways else push_down("C", _WAY)
        name = f"C2-portal-table-L{row['L']:g}-HV{row['H_over_V']:g}"
        texts[name] = portal_text(row["h"], row["L"], row["H_over_V"], push)
    for case, direction, node in (("C2-portal-HV0.2", [0, -1], "C"), ("C2-portal-HV2.0", [1, 0], "B")):
        for kinematics in ("small", "p-delta", "large"):
            push = push_towards(node, direction, _WAY)
            texts[f"{case}-{kinematics}"] = portal_text(4.0, 6.0, float(case[-3:]), push, kinematics)
    return texts
