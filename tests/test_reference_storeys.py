"""Two storeys of two bays under even loads, pushed sideways: hardening, gravity first, three kinds of kinematics.

Loads by OpenSees 3.7.1: 16 force-based elements a member, 5 Lobatto points, Steel01, 112 and 80 fibres, 300 steps; with
8 elements and half the fibres they differ by up to 0.4 %, beyond a sway of 0.15 m by 0.1 %.
"""

import numpy as np
import pytest

from fem_reference import pushover
from scene import Scene, parse_scene

COLUMN, BEAM = "I 200x200x9x15 mm", "I 300x150x7.1x10.7 mm"
SWAY = np.array([0.03, 0.06, 0.10, 0.15, 0.20, 0.25, 0.30])


def storeys(kinematics: str, hardening: float) -> Scene:
    lines = ['title = "two storeys"', "gravity = 0", f'kinematics = "{kinematics}"']
    for x in range(3):
        for y in range(3):
            held = "clamped" if y == 0 else "free"
            lines += [f"[nodes.n{x}{y}]", f"at = [{6.0 * x}, {3.5 * y}]", f'support = "{held}"']
    columns = [(f"n{x}{y}", f"n{x}{y + 1}") for x in range(3) for y in range(2)]
    beams = [(f"n{x}{y}", f"n{x + 1}{y}") for x in range(2) for y in (1, 2)]
    for a, b in columns + beams:
        section = COLUMN if (a, b) in columns else BEAM
        lines += [f"[members.{a}-{b}]", f'from = "{a}"', f'to = "{b}"', f'section = "{section}"']
        lines += [f'material = "fy=235 MPa, E=210 GPa, Et={210e9 * hardening} Pa"', 'theory = "euler-bernoulli"']
    for a, b in beams:
        lines += ["[[loads]]", f'member = "{a}-{b}"', "per_length = [0.0, -20e3]", 'kind = "dead"']
    for y in (1, 2):
        lines += ["[[loads]]", f'node = "n0{y}"', f"force = [{float(y)}, 0.0]"]
    lines += ["[push]", 'node = "n02"', "direction = [1, 0]", "distance = 0.3"]
    return parse_scene("\n".join(lines), "test")


@pytest.mark.parametrize(
    ("kinematics", "hardening", "expected"),
    [
        ("small", 0.003, [29010.52, 54897.75, 70575.5, 78289.87, 82379.86, 84850.56, 86370.03]),
        ("p-delta", 0.01, [28346.13, 54022.27, 70379.02, 78150.77, 82028.11, 84089.63, 85209.19]),
        ("large", 0.02, [28347.77, 54360.97, 72145.15, 81201.91, 85994.01, 88881.87, 90810.24]),
    ],
)
def test_storeys_follow_opensees(kinematics: str, hardening: float, expected: list[float]) -> None:
    answer = pushover(storeys(kinematics, hardening), 2e-3)
    found = np.interp(SWAY, answer.displacement, answer.load)
    assert np.abs(found / np.array(expected) - 1.0).max() <= 1e-3
    assert answer.imbalance <= 1e-6
    # The lower columns' feet and the beams' far ends yield before the sway is half done.
    assert {"n10", "n20", "n11", "n21"} <= {hinge.node for hinge in answer.hinges if hinge.displacement < 0.15}
