"""Limits of plane stress curves: rates, estimates that bound the error, and halves that stand for the whole."""

from operator import attrgetter

import msgspec
import numpy as np
import pytest
from cantilevers import cantilever
from plane_bodies import held_body

from fem_reference import plane_push
from fem_reference.plane.beam_mesh import beam_mesh
from fem_reference.plane.bodies import plane_scene
from fem_reference.plane.extrapolation import Convergence
from fem_reference.plane.halves import whole
from fem_reference.plane.path import Trace, trace
from scene import Load, Plane, Scene
from scene.quantities import Force

LOAD = attrgetter("load")


def paths(error: dict[float, float], levels: int = 3, size: float = 0.3) -> list[Trace]:
    """Curves whose errors are sums of powers of the size of the elements, by exponent."""
    s = np.linspace(0.0, 1.0, 30)
    exact = np.tanh(3.0 * s)
    found = []
    for level in range(levels):
        h = size / 2.0**level
        wrong = sum(share * h**power * s**k for k, (power, share) in enumerate(error.items(), 1))
        found.append(Trace(displacement=s.tolist(), load=(exact * (1.0 + wrong)).tolist()))
    return found


@pytest.mark.parametrize("error", [{1.0: 0.1}, {1.0: 0.1, 2.0: -0.1}, {2.0: 0.1}, {3.0: 0.1}, {0.5: 0.1}])
def test_estimates_bound_the_error(error: dict[float, float]) -> None:
    """Linear errors go, quadratic ones are overshot, those that fall with the root are told by their slow steps."""
    made = paths(error)
    exact = np.tanh(3.0 * np.array(made[0].displacement))
    found = Convergence.of(made)
    wrong = float(np.abs(found.answer(LOAD) - exact).max()) / max(map(abs, made[-1].load))
    assert wrong <= found.error(LOAD) * (1.0 + 1e-9) + 1e-12
    assert found.extrapolated == (min(error) <= 2.0)


def test_two_meshes_and_paths_that_stop_are_not_extrapolated() -> None:
    coarse, fine, finest = paths({1.0: 0.1})
    assert not Convergence.of([coarse, fine]).extrapolated
    finest.stopped = "no equilibrium"
    assert not Convergence.of([coarse, fine, finest]).extrapolated


@pytest.mark.parametrize("root", ["clamped", "contraction-free"])
def test_half_a_body_answers_for_the_whole(root: str) -> None:
    scene = short(root)
    found = plane_scene(scene)
    assert found.half
    where = np.linspace(0.0, 1e-3, 9)[1:]
    half, full = found.body(0), held_body(beam_mesh(0.2, 0.1, 0), root)
    one, other = trace(half, [where]), trace(full, [where])
    np.testing.assert_allclose(one.load, other.load, rtol=1e-8)
    np.testing.assert_allclose(one.plastic, other.plastic, rtol=1e-6, atol=1e-9 * other.plastic[-1])
    continuum, (state,) = whole(half.continuum, [half.state])
    assert continuum.elastic_energy(state) == pytest.approx(full.continuum.elastic_energy(full.state), rel=1e-8)
    assert np.ptp(continuum.mesh.points[:, 1]) == pytest.approx(0.1)
    # In equilibrium where nothing holds or pushes: at the nodes inside.
    inside = np.setdiff1d(np.arange(len(continuum.mesh.points)), continuum.mesh.boundary)
    assert np.abs(state.internal.reshape(-1, 2)[inside]).max() <= 1e-6 * abs(half.load)


def test_what_pulls_along_the_member_needs_the_whole() -> None:
    scene = short("clamped")
    along = Load(node="tip", force=(Force(1e3), Force(0.0)), kind="dead")
    across = Load(node="tip", force=(Force(0.0), Force(1e3)), kind="dead")
    assert plane_scene(msgspec.structs.replace(scene, loads=(across,))).half
    assert not plane_scene(msgspec.structs.replace(scene, loads=(along,))).half
    heavy = msgspec.structs.replace(scene, gravity=9.81)
    assert plane_scene(heavy).half


def test_a_clamped_deep_beam_is_known_well_enough_for_three_thousandths() -> None:
    """C7-ps-Lh2, clamped: 1.0764 M_pl / L is extrapolated from 1760 and 7040 elements, made by another rule."""
    scene = msgspec.structs.replace(short("clamped"), pushed=cantilever("rectangle 50x100 mm", 0.2, 3.1e-3).pushed)
    found = plane_push(scene, 6e-4)
    assert found.error_estimate <= 6e-4
    assert "extrapolated" in found.method
    assert found.load[-1] / 146875.0 == pytest.approx(1.0764, abs=found.error_estimate)
    np.testing.assert_allclose(
        found.energy.external, found.energy.elastic + found.energy.plastic, atol=1e-9 * found.energy.external[-1]
    )


def short(root: str) -> Scene:
    """A cantilever of L/h = 2."""
    scene = cantilever("rectangle 50x100 mm", 0.2, 1e-3)
    return msgspec.structs.replace(scene, plane=Plane(root=root))
