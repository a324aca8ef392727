"""Quadratic plane elements: patch tests, rates of convergence, refinement, loads, edges."""

import numpy as np
import pytest
from plane_bodies import STEEL, free_continuum, held_body, solved_elastically, square

from capacity import InputError
from fem_reference.plane.beam_mesh import beam_mesh, tensor_mesh
from fem_reference.plane.boundary import boundary, edge_weights
from fem_reference.plane.continuum import Continuum
from fem_reference.plane.j2 import MODES
from fem_reference.plane.mesh import PlaneMesh

KINDS = ["quadrilaterals", "triangles"]


def outer_dofs(mesh: PlaneMesh) -> np.ndarray:
    nodes = np.unique(mesh.boundary)
    return np.concatenate([2 * nodes, 2 * nodes + 1])


@pytest.mark.parametrize("bend", [0.0, 0.1], ids=["straight", "curved"])
@pytest.mark.parametrize("kind", KINDS)
def test_patch(kind: str, bend: float) -> None:
    """Displacements that are linear at the boundary are linear inside, and the stress is one everywhere."""
    mesh = square(3, kind, skew=0.1, bend=bend)
    continuum = free_continuum(mesh)
    slope = 1e-4 * np.array([[3.0, 1.0], [-2.0, 5.0]])
    exact = (mesh.points @ slope.T).ravel()
    outer = outer_dofs(mesh)
    d = solved_elastically(continuum, outer, exact[outer])
    np.testing.assert_allclose(d, exact, atol=1e-12 * np.abs(exact).max() * 1e3)
    stress = continuum.respond(d, continuum.undeformed()).stress
    strain = np.array([slope[0, 0], slope[1, 1], slope[0, 1] + slope[1, 0]])
    np.testing.assert_allclose(stress, np.broadcast_to(STEEL_STIFFNESS * (MODES @ strain), stress.shape), rtol=1e-9)


STEEL_STIFFNESS = np.array([210e9 / 0.7, 210e9 / 1.3, 210e9 / 2.6])


@pytest.mark.parametrize("kind", KINDS)
def test_plastic_patch_is_at_rest(kind: str) -> None:
    """A linear displacement far beyond yield gives one stress everywhere, and no force on any node inside."""
    mesh = square(3, kind, skew=0.1, bend=0.1)
    continuum = free_continuum(mesh)
    exact = (mesh.points @ (1e-2 * np.array([[3.0, 1.0], [-2.0, 5.0]])).T).ravel()
    state = continuum.respond(exact, continuum.undeformed())
    inside = np.setdiff1d(np.arange(continuum.size), outer_dofs(mesh))
    assert np.abs(state.internal[inside]).max() <= 1e-12 * np.abs(state.internal).max()
    assert np.ptp(state.accumulated) <= 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_rates_of_convergence(kind: str) -> None:
    """Displacements in L2 with h³, energy of the error with h⁴, on skewed meshes.

    The exact field has Airy's function φ = e^x cos y, harmonic: u = -∇φ / 2G, σ11 = -σ22 = -φ, σ12 = e^x sin y.
    """
    displacement, energy = [], []
    counts = np.array([4, 8, 16])
    for count in counts:
        mesh = square(int(count), kind, skew=0.08)
        continuum = free_continuum(mesh)
        outer = outer_dofs(mesh)
        d = solved_elastically(continuum, outer, airy(mesh.points).ravel()[outer])
        at = np.einsum("qk,nkd->nqd", continuum.shape_values, mesh.points[mesh.cells])
        moved = np.einsum("qk,nkd->nqd", continuum.shape_values, continuum.nodal_displacement(d)[mesh.cells])
        displacement.append(np.sqrt(np.einsum("nq,nqd->", continuum.volume, (moved - airy(at)) ** 2)))
        stress = continuum.respond(d, continuum.undeformed()).stress @ MODES
        phi, psi = np.exp(at[..., 0]) * np.cos(at[..., 1]), np.exp(at[..., 0]) * np.sin(at[..., 1])
        wrong = (stress - np.stack([-phi, phi, psi], axis=-1)) @ MODES.T
        energy.append(np.einsum("nq,nqi,i->", continuum.volume, wrong**2, 1.0 / STEEL_STIFFNESS))
    assert -np.polyfit(np.log(counts), np.log(displacement), 1)[0] > 2.85
    assert -np.polyfit(np.log(counts), np.log(energy), 1)[0] > 3.85


def airy(at: np.ndarray) -> np.ndarray:
    x, y = at[..., 0], at[..., 1]
    gradient = np.stack([np.exp(x) * np.cos(y), -np.exp(x) * np.sin(y)], axis=-1)
    return np.asarray(-gradient / (2.0 * STEEL.shear_modulus))


@pytest.mark.parametrize("kind", KINDS)
def test_refinement_keeps_the_body(kind: str) -> None:
    mesh = square(3, kind, skew=0.1, bend=0.1)
    fine = mesh.refined()
    area = [continuum_area(m) for m in (mesh, fine)]
    assert area[1] == pytest.approx(area[0], rel=1e-12)
    assert len(fine.cells) == 4 * len(mesh.cells)
    assert len(np.unique(fine.points.round(12), axis=0)) == len(fine.points)
    for name, sides in mesh.edges.items():
        assert len(fine.edges[name]) == 2 * len(sides)
        assert edge_weights(fine, name).sum() == pytest.approx(edge_weights(mesh, name).sum(), rel=1e-12)
    assert sorted(map(tuple, np.sort(fine.boundary[:, [0, 2]], axis=1))) == sorted(
        map(tuple, np.sort(fine.with_sides().boundary[:, [0, 2]], axis=1))
    )


def continuum_area(mesh: PlaneMesh) -> float:
    return float(mesh.shape_gradients()[1].sum())


def test_a_folded_element_is_refused() -> None:
    mesh = square(2, "quadrilaterals")
    points = mesh.points.copy()
    points[mesh.cells[1, 8]] += 0.9
    with pytest.raises(ValueError, match=r"^1$"):
        free_continuum(PlaneMesh(points, mesh.cells, {}, mesh.group))


def test_body_force_is_the_weight() -> None:
    continuum = free_continuum(square(3, "triangles", skew=0.1, bend=0.1))
    loads = continuum.body_force(np.tile([0.0, -7850.0 * 9.81], (len(continuum.mesh.cells), 1)))
    area = continuum_area(continuum.mesh)
    assert loads[1::2].sum() == pytest.approx(-7850.0 * 9.81 * 0.05 * area, rel=1e-12)
    assert loads[0::2].sum() == pytest.approx(0.0, abs=1e-9)


def test_a_push_aslant_knows_no_side() -> None:
    """A push aslant: mirrored and reversed it is as stiff, and along an axis it is the push along that axis."""
    mesh = tensor_mesh(np.linspace(0.0, 0.4, 5), np.linspace(-0.05, 0.05, 3))

    def stiffness(direction: tuple[float, float]) -> float:
        body = held_body(mesh, direction=direction)
        body.move_to(1e-6)
        return body.load / 1e-6

    assert stiffness((0.3, -0.9)) == pytest.approx(stiffness((0.3, 0.9)), rel=1e-9)
    assert stiffness((0.3, -0.9)) == pytest.approx(stiffness((-0.3, 0.9)), rel=1e-9)
    assert stiffness((1e-7, -1.0)) == pytest.approx(stiffness((0.0, -1.0)), rel=1e-5)


def test_boundaries_that_leave_the_body_free_are_refused() -> None:
    mesh = tensor_mesh(np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 3))
    with pytest.raises(InputError, match="free to move"):
        boundary(mesh, {"left": "roller-y"}, "right", (1.0, 0.0), "plane.supports")
    with pytest.raises(InputError, match="share nodes"):
        boundary(mesh, {"left": "clamped"}, "top", (0.0, 1.0), "plane.supports")
    bent = PlaneMesh(mesh.points @ np.array([[1.0, 0.2], [0.0, 1.0]]), mesh.cells, mesh.edges, mesh.group)
    with pytest.raises(InputError, match="not straight"):
        boundary(bent, {"bottom": "contraction-free"}, "right", (1.0, 0.0), "plane.supports")
    found = boundary(mesh, {"left": "roller-y", "bottom": "roller-x"}, "right", (1.0, 0.0), "plane.supports")
    assert len(found.fixed) == 10


@pytest.mark.parametrize("ends", [(True, False), (False, True), (True, True)])
def test_beam_mesh_is_fine_where_it_is_held(ends: tuple[bool, bool]) -> None:
    mesh = beam_mesh(0.5, 0.1, 1, ends)
    x = np.unique(mesh.points[np.unique(mesh.cells[:, :4]), 0])
    steps = np.diff(x)
    assert mesh.points[:, 0].max() == pytest.approx(0.5)
    assert np.ptp(mesh.points[:, 1]) == pytest.approx(0.1)
    assert ((steps[0] < 0.1 / 25), (steps[-1] < 0.1 / 25)) == ends
    assert isinstance(free_continuum(mesh), Continuum)
