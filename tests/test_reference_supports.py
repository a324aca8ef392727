"""Supports, springs, bearings and releases of the reference, against tables of beam formulas."""

import msgspec
import pytest
from frames import (
    down,
    fixed_fixed,
    frame_scene,
    propped,
    push_down,
)

from fem_reference import pushover
from scene import Scene

# Of an IPE 300 of steel [N m²].
EI = 210e9 * 7.998986946313319e-05


def beam(support: str, extra: str = "", force: str = down("B")) -> Scene:
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (2.0, 0.0, support)}
    return frame_scene(nodes, [("A", "B")], push_down("B", 1e-4), [force], extra=extra)


@pytest.mark.parametrize(("support", "factor"), [("free", 3.0), ("guided-y", 12.0)])
def test_supports_give_the_stiffness_of_the_tables(support: str, factor: float) -> None:
    """k = 3 EI / L³ of a cantilever, 12 EI / L³ with its end guided (any table of beam formulas)."""
    answer = pushover(beam(support))
    assert answer.load[-1] / 1e-4 == pytest.approx(factor * EI / 8.0, rel=1e-6)


def test_spring_release_and_settlement() -> None:
    scene = beam("free")
    node = type(scene.nodes["B"])(at=scene.nodes["B"].at, spring=(0.0, 1e6, 0.0))
    with_spring = msgspec.structs.replace(scene, nodes={**scene.nodes, "B": node})
    assert pushover(with_spring).load[-1] / 1e-4 == pytest.approx(3.0 * EI / 8.0 + 1e6, rel=1e-6)
    settled = type(node)(at=node.at, support="pinned", settlement=(0.0, -1e-3))
    middle = type(node)(at=(1.0, 0.0))
    nodes = {"A": scene.nodes["A"], "M": middle, "B": settled}
    member = scene.members["A-B"]
    halves = {
        name: msgspec.structs.replace(member, start=a, end=b)
        for name, (a, b) in {"left": ("A", "M"), "right": ("M", "B")}.items()
    }
    push = type(scene.push)(node="M", direction=(0.0, -1.0), distance=1e-6)
    sunk = msgspec.structs.replace(scene, nodes=nodes, members=halves, pushed=push, loads=())
    answer = pushover(sunk)
    assert answer.members["left"].end_forces[0, 0, 2] == pytest.approx(-3.0 * EI * 1e-3 / 4.0, rel=1e-6)


@pytest.mark.parametrize(("direction", "factor"), [(-1, 768.0 / 7.0), (1, 24.0)])
def test_a_bearing_pushes_and_lets_go(direction: int, factor: float) -> None:
    """Stiffness at mid-span of a propped cantilever, 768 EI / 7 L³, and of one that is free beyond, 24 EI / L³."""
    scene = propped(1e-4)
    prop = type(scene.nodes["B"])(at=scene.nodes["B"].at, bearing=1e12)
    push = msgspec.structs.replace(scene.push, direction=(0.0, direction))
    answer = pushover(msgspec.structs.replace(scene, nodes={**scene.nodes, "B": prop}, pushed=push, loads=()))
    assert answer.load[-1] / 1e-4 == pytest.approx(factor * EI / 6.0**3, rel=1e-5)


def test_a_hinged_end_bears_no_moment() -> None:
    scene = propped(1e-4)
    released = dict(scene.members)
    whole = released["A-C"]
    released["A-C"] = msgspec.structs.replace(whole, releases=("from",))
    answer = pushover(msgspec.structs.replace(scene, members=released))
    assert answer.load[-1] / 1e-4 == pytest.approx(48.0 * EI / 6.0**3, rel=1e-6)
    assert abs(answer.members["A-C"].end_forces[-1, 0, 2]) <= 1e-6 * answer.load[-1]


def test_end_forces_are_those_of_statics() -> None:
    """A clamped beam under an even load w: M = -w L² / 12 and Q = ± w L / 2 at its ends."""
    answer = pushover(fixed_fixed(1e-3))
    w = answer.load[-1]
    start, end = answer.members["A-C"].end_forces[-1]
    assert start[2] == pytest.approx(-w * 64.0 / 12.0, rel=1e-6)
    assert end[2] == pytest.approx(w * 64.0 / 24.0, rel=1e-6)
    assert start[1] == pytest.approx(-w * 4.0, rel=1e-6)
    assert abs(end[1]) <= 1e-6 * w
