"""Members of several materials in the reference, against closed forms."""

import numpy as np
import pytest
from frames import frame_scene, push_down

from fem_reference import natural_modes, pushover
from scene import Scene

#: Half of it of twice the stress and the stiffness: the axes shift to the strong half.
TWO = "rectangle 50x60 mm + rectangle 50x60 mm at 0,60 mm of fy=470 MPa, E=420 GPa, rho=3925 kg/m^3"
E, FY, B, H, L = 210e9, 235e6, 0.05, 0.06, 1.0


def cantilever(section: str, distance: float, loads: tuple[str, ...] = ()) -> Scene:
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (L, 0.0, "free")}
    return frame_scene(nodes, [("A", "B")], push_down("B", distance), loads, section=section)


def test_pieces_of_one_material_are_one_section() -> None:
    whole = pushover(cantilever("rectangle 50x120 mm", 0.03))
    pieces = pushover(cantilever("rectangle 50x60 mm + rectangle 50x60 mm at 0,60 mm of S235", 0.03))
    error = whole.error_estimate + pieces.error_estimate
    largest = whole.load.max()
    apart = np.interp(whole.displacement, pieces.displacement, pieces.load) - whole.load
    assert np.abs(apart).max() <= error * largest
    assert [hinge.node for hinge in pieces.hinges] == ["A"]


def test_two_materials_bend_and_fold_as_their_closed_forms() -> None:
    centre = H * (0.5 + 2.0 * 1.5) / 3.0
    stiffness = E * B * H**3 / 12.0 * 3.0 + E * B * H * ((centre - 0.5 * H) ** 2 + 2.0 * (1.5 * H - centre) ** 2)
    x = 0.25 * H  # plastic axis above the joint: h + 2x = 2 (h - x)
    moment = FY * B * (H * (0.5 * H + x) + x**2 + (H - x) ** 2)
    found = pushover(cantilever(TWO, 0.05))
    assert found.load[1] / found.displacement[1] == pytest.approx(3.0 * stiffness / L**3, rel=1e-6)
    assert found.load[-1] == pytest.approx(moment / L, rel=1e-4)
    (hinge,) = found.hinges
    assert hinge.node == "A"
    assert hinge.load == pytest.approx(moment / L, rel=1e-3)
    # Both halves yield, each at its own stress, and nothing bears an axial force.
    member = found.members["A-B"]
    assert np.abs(member.axial_force).max() <= 1e-6 * FY * B * H
    assert found.energy.external[-1] == pytest.approx(found.energy.elastic[-1] + found.energy.plastic[-1], rel=1e-4)


def test_two_materials_under_axial_force() -> None:
    """Compressed to a half of the weak half's strength: the stress blocks in equilibrium."""
    N = -0.5 * FY * B * H
    found = pushover(cantilever(TWO, 0.05, (f'node = "B"\nforce = [{N!r}, 0.0]\nkind = "dead"',)))
    # Pushed down, the top is in tension. In units of fy b, with y above the joint where the strong half's stress
    # changes its sign: 2 (h - y) - 2 y - h = -h / 2.
    y = 3.0 * H / 8.0
    about_joint = FY * B * (H**2 - 2.0 * y**2 + 0.5 * H**2)
    centre = H * (0.5 + 2.0 * 1.5) / 3.0 - H  # of the member's axis above the joint
    expected = about_joint - N * centre
    assert found.load[-1] == pytest.approx(expected / L, rel=1e-3)


def test_frequencies_of_two_materials() -> None:
    centre = H * (0.5 + 2.0 * 1.5) / 3.0
    stiffness = E * B * H**3 / 12.0 * 3.0 + E * B * H * ((centre - 0.5 * H) ** 2 + 2.0 * (1.5 * H - centre) ** 2)
    mass = B * H * (7850.0 + 3925.0)
    modes = natural_modes(cantilever(TWO, 0.05), 1)
    expected = 1.8751040687119611**2 * np.sqrt(stiffness / mass) / (2.0 * np.pi * L**2)
    assert modes.frequency[0] == pytest.approx(expected, rel=2e-5)
