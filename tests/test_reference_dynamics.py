"""Frequencies and motions of the reference against closed forms and OpenSees; sources are in the reference cases."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from frames import IPE300, frame_scene

from fem_reference.dynamics import motion
from fem_reference.modes import natural_modes
from scene import Scene

Case = Callable[[str], dict[str, Any]]
MOTION = '[motion]\nduration = {}\nwatch = "B"\ndirection = [0, -1]'


def moving(
    length: float, support: str, far: str, section: str, duration: float, extra: str = "", loads: tuple[str, ...] = ()
) -> Scene:
    nodes = {"A": (0.0, 0.0, support), "B": (length / 2 if far != "free" else length, 0.0, "free")}
    members = [("A", "B")]
    if far != "free":
        nodes["D"] = (length, 0.0, far)
        members.append(("B", "D"))
    return frame_scene(nodes, members, MOTION.format(duration), loads, section=section, extra=extra)


def with_mass(scene: Scene, mass: float, velocity: float) -> Scene:
    """``scene`` with a body at B that comes from above."""
    node = type(scene.nodes["B"])(at=scene.nodes["B"].at, mass=mass, velocity=(0.0, -velocity))
    fields = {name: getattr(scene, name) for name in scene.__struct_fields__}
    loads = () if velocity else scene.loads
    return type(scene)(**{**fields, "nodes": {**scene.nodes, "B": node}, "loads": loads})


STEP = ('node = "B"\nforce = [0.0, -1.0]\nkind = "step"',)


@pytest.mark.parametrize(
    ("name", "section", "length"),
    [("RECT 50x100", "rectangle 50x100 mm", 1.0), ("IPE 300 (no root radius)", IPE300, 3.0)],
)
def test_frequencies(name: str, section: str, length: float, case: Case) -> None:
    outputs = case("C6-freq")["outputs"][name]
    for supports, key in ((("clamped", "free"), "cantilever_Hz"), (("pinned", "roller-x"), "simply_supported_Hz")):
        found = natural_modes(moving(length, *supports, section, 1.0, loads=STEP), 6)
        bending = found.frequency[found.bending > 0.5][:3]
        np.testing.assert_allclose(bending, outputs[key], rtol=2e-5)
        assert found.error_estimate[found.bending > 0.5][:3].max() <= 2e-3


def test_frequencies_converge_with_the_fourth_power_of_the_element_size() -> None:
    scene = moving(1.0, "clamped", "free", "rectangle 50x100 mm", 1.0, loads=STEP)
    exact = 4.694091132974175**2 * np.sqrt(210e9 * 0.1**2 / 12.0 / 7850.0) / (2.0 * np.pi)
    counts = np.array([8, 16, 32])
    errors = [abs(natural_modes(scene, 2, int(n)).frequency[1] - exact) for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] > 3.5


def test_a_sudden_load_doubles_the_elastic_deflection() -> None:
    """A heavy body on a light cantilever: u_max = 2 P L³ / 3 EI at half a period (any text on vibrations)."""
    load = ('node = "B"\nforce = [0.0, -5000.0]\nkind = "step"',)
    scene = with_mass(moving(1.0, "clamped", "free", "rectangle 50x100 mm", 0.16, loads=load), 5000.0, 0.0)
    found = motion(scene, dissipation=1.0)
    stiffness = 3.0 * 875e3
    assert found.peak == pytest.approx(2.0 * 5000.0 / stiffness, rel=3e-3)
    effective = 5000.0 + 39.25 * 33.0 / 140.0  # Rayleigh's share of the beam
    assert found.peak_time == pytest.approx(np.pi * np.sqrt(effective / stiffness), rel=0.01)
    total = found.kinetic + found.elastic + found.plastic - found.external
    assert np.abs(total - total[0]).max() <= 2e-3 * found.external.max()


def test_a_struck_cantilever(case: Case) -> None:
    """OpenSees fibre frames, uncertain to 1.3 %, by Richardson's extrapolation to its zero element size."""
    reference = case("C6-parkes-mid")
    expected = reference["outputs"]["fibre_linear"]["richardson_first_order"]
    found = motion(
        with_mass(moving(1.0, "clamped", "free", "rectangle 20x50 mm", 0.06, loads=STEP), 7.85, 17.16), tolerance=0.05
    )
    bound = reference["uncertainty"]["fibre_rel"]
    assert found.error_estimate <= bound
    assert found.peak == pytest.approx(expected["u_max"], rel=bound)
    assert -found.residual["B"][1] == pytest.approx(expected["u_res"], rel=bound)
    total = found.kinetic + found.elastic + found.plastic
    assert np.abs(total - total[0]).max() <= 2e-3 * total[0]
