"""The cantilevers of the reference cases, as scenes."""

from typing import Any

from scene import Scene, parse_scene

# Reference case: section as its inputs describe it.
SECTIONS = {
    "C1-rect": "rectangle 50x100 mm",
    "C1-ipe300": "I 300x150x7.1x10.7 mm",
    "C1-chs": "CHS 168.3x8 mm",
}


def cantilever(
    section: str,
    length: float,
    distance: float,
    gravity: float = 0.0,
    theory: str = "euler-bernoulli",
    hardening: float = 0.0,
) -> Scene:
    """A clamped steel cantilever (fy 235 MPa, E 210 GPa) along x, pushed down at its tip; SI.

    ``hardening`` is E_t / E.
    """
    return parse_scene(
        f"""
        title = "test cantilever"
        gravity = {gravity}
        [nodes.root]
        at = [0.0, 0.0]
        support = "clamped"
        [nodes.tip]
        at = [{length!r}, 0.0]
        [members.beam]
        from = "root"
        to = "tip"
        section = "{section}"
        material = "fy=235 MPa, E=210 GPa, rho=7850 kg/m^3, Et={210.0 * hardening!r} GPa"
        theory = "{theory}"
        [push]
        node = "tip"
        direction = [0, -1]
        distance = {distance!r}
        """,
        "test",
    )


def reference_cantilever(case: dict[str, Any]) -> Scene:
    """The scene of one of the cases in `SECTIONS`, pushed to ten times its deflection at first yield."""
    return cantilever(SECTIONS[case["id"]], case["inputs"]["L_m"], 10.0 * case["outputs"]["delta_y_m"])
