"""Joint laws: derivative, yield, dissipation, and what the fibre law shares with the section."""

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from capacity import InputError, Interaction, capacity, parse_material, parse_section
from sim import ElasticPlastic, FibreSection, InteractionPlastic, Law, RigidPlastic
from sim.laws import elastic_plastic, fibre, interaction

SECTION, MATERIAL = parse_section("rectangle 50x100 mm"), parse_material("S235")
CAPACITY = capacity(SECTION, MATERIAL)
LENGTH = 0.1
MODULES = {
    "rigid-plastic": elastic_plastic,
    "elastic-plastic": elastic_plastic,
    "interaction": interaction,
    "fibre": fibre,
}
INTERACTION = Interaction(SECTION, MATERIAL)
FLANGED = Interaction(parse_section("IPE 300"), MATERIAL)
HOLLOW = Interaction(parse_section("RHS 100x60x3 mm"), MATERIAL)


def capped() -> ElasticPlastic:
    return ElasticPlastic.of_section(CAPACITY, LENGTH)


def fibres(hardening: float = 0.0, count: int = 12) -> FibreSection:
    return FibreSection.of_section(SECTION, parse_material(f"S235, Et={210.0 * hardening!r} GPa"), LENGTH, count)


#: Steel whose slope falls three times, as layers in parallel.
CURVED = parse_material("curve=0.001:210 0.004:260 0.02:330 MPa")


@functools.cache
def interacting(exact: Interaction = INTERACTION, count: int = 64) -> InteractionPlastic:
    return InteractionPlastic(capped().stiffness, exact.facets(count))


class Point:
    """One joint's law, its memory, and its compiled functions."""

    def __init__(self, law: Law) -> None:
        self.law, self.module = law, MODULES[law.name]
        self.parameters, self.state = law.parameters(), law.state()

    def respond(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        out, q = np.empty(9), np.ascontiguousarray(q, float)
        self.module.respond.compiled.ctypes(*(x.ctypes.data for x in (self.parameters, self.state, q, out)))
        a = out[3:]
        return out[:3], np.array([[a[0], a[1], a[2]], [a[1], a[3], a[4]], [a[2], a[4], a[5]]])

    def commit(self, q: np.ndarray) -> tuple[float, float]:
        out, q = np.empty(5), np.ascontiguousarray(q, float)
        self.module.commit.compiled.ctypes(*(x.ctypes.data for x in (self.parameters, self.state, q, out)))
        return float(out[0]), float(out[1])


ELASTIC = [capped(), fibres(), fibres(0.02), interacting()]
LAYERED = FibreSection.of_section(SECTION, CURVED, LENGTH, 12)
LAWS = [*ELASTIC, RigidPlastic.of_section(CAPACITY, LENGTH), interacting(FLANGED, 24), LAYERED]
deformations = st.tuples(st.floats(-5e-4, 5e-4), st.floats(-5e-4, 5e-4), st.floats(-0.05, 0.05)).map(np.array)


@pytest.mark.parametrize("law", ELASTIC, ids=lambda law: law.name)
def test_capacities_are_those_of_the_section(law: Law) -> None:
    expected = (CAPACITY.N_max, CAPACITY.Q_max, CAPACITY.M_max)
    assert law.capacities() == pytest.approx(expected, rel=2e-3 if law.name == "interaction" else 1e-9)


@pytest.mark.parametrize("law", ELASTIC, ids=lambda law: law.name)
def test_first_tangent_is_the_elastic_one(law: Law) -> None:
    a = law.elastic_tangent()
    expected = np.array([[a[0], a[1], a[2]], [a[1], a[3], a[4]], [a[2], a[4], a[5]]])
    _, tangent = Point(law).respond(np.zeros(3))
    np.testing.assert_allclose(tangent, expected, rtol=1e-12, atol=1e-6)
    diagonal = np.array([CAPACITY.EA, CAPACITY.GA_s, CAPACITY.EI]) / LENGTH
    np.testing.assert_allclose(np.diag(tangent), diagonal, rtol=1e-12)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
@given(path=st.lists(deformations, min_size=1, max_size=6))
def test_energy_balance_and_dissipation(law: Law, path: list[np.ndarray]) -> None:
    """Every step: ψ rises by at most the work of the final force; what is dissipated is never negative.

    Backward Euler: s·Δq ≥ Δψ + dissipated, for the stored energy is convex.
    """
    point, before, stored = Point(law), np.zeros(3), 0.0
    for q in path:
        force, _ = point.respond(q)
        energy, dissipated = point.commit(q)
        scale = 1.0 + abs(stored) + abs(energy)
        assert dissipated >= 0.0
        assert energy >= 0.0
        assert force @ (q - before) >= energy - stored + dissipated - 1e-9 * scale
        before, stored = q, energy


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
@given(path=st.lists(deformations, min_size=1, max_size=6))
def test_committed_state_gives_the_same_force_again(law: Law, path: list[np.ndarray]) -> None:
    point = Point(law)
    for q in path:
        force, _ = point.respond(q)
        point.commit(q)
        again, _ = point.respond(q)
        np.testing.assert_allclose(again, force, rtol=1e-9, atol=1e-6 * CAPACITY.N_max * 1e-3)
        assert point.commit(q)[1] <= 1e-9


@given(path=st.lists(deformations, min_size=1, max_size=6))
def test_perfectly_plastic_joints_stay_within_their_capacities(path: list[np.ndarray]) -> None:
    for law in (capped(), fibres()):
        point = Point(law)
        for q in path:
            force, _ = point.respond(q)
            limit = np.array([CAPACITY.N_max, CAPACITY.Q_max, CAPACITY.M_max])
            assert np.all(np.abs(force) <= limit * (1.0 + 1e-12))
            point.commit(q)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
@given(q=deformations)
def test_tangent_bounds_the_change_of_force(law: Law, q: np.ndarray) -> None:
    """Monotone: Δs·Δq ≥ 0, and no steeper than the elastic tangent."""
    point, step = Point(law), np.array([1e-6, 1e-6, 1e-5])
    first, tangent = point.respond(q)
    second, _ = point.respond(q + step)
    work = float((second - first) @ step)
    _, elastic = Point(law).respond(np.zeros(3))
    assert -1e-9 <= work <= step @ elastic @ step * (1.0 + 1e-9)
    assert np.linalg.eigvalsh(elastic - tangent).min() >= -1e-6 * np.abs(elastic).max()


@pytest.mark.parametrize(("ratio", "expected"), [(0.5, 1.0 / 3.0), (2.0, 11.0 / 12.0), (5.0, 1.0 - 1.0 / 75.0)])
def test_moment_of_the_fibre_joint(ratio: float, expected: float) -> None:
    """M / M_p = 1 - (κ_y / κ)² / 3 (Chakrabarty, Theory of Plasticity, 3rd ed., section 3.7)."""
    rotation = ratio * LENGTH * 2.0 * MATERIAL.yield_stress / (MATERIAL.youngs_modulus * 0.1)
    force, _ = Point(fibres(count=100)).respond(np.array([0.0, 0.0, rotation]))
    assert force[2] / CAPACITY.M_max == pytest.approx(expected, abs=3e-4)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_axial_force_reduces_the_moment_of_a_rectangle(share: float) -> None:
    """M_N / M_p = 1 - n² (reference case C4-rect)."""
    point = Point(fibres(count=100))
    rotation, low, high = 0.5, -0.5, 0.5
    for _ in range(100):  # the extension at which N has the wanted share
        u = 0.5 * (low + high)
        force, _ = point.respond(np.array([u, 0.0, rotation]))
        low, high = (u, high) if force[0] < share * CAPACITY.N_max else (low, u)
    assert force[0] / CAPACITY.N_max == pytest.approx(share, abs=0.02)
    assert force[2] / CAPACITY.M_max == pytest.approx(1.0 - (force[0] / CAPACITY.N_max) ** 2, abs=0.01)


def test_bauschinger_effect_of_kinematic_hardening() -> None:
    """After yielding to a stress σ, a fibre yields in reverse 2 fy below it."""
    point = Point(fibres(hardening=0.02))
    e, fy = MATERIAL.youngs_modulus, MATERIAL.yield_stress
    point.commit(np.array([10.0 * fy / e * LENGTH, 0.0, 0.0]))
    stress = fy * (1.0 + 0.02 * 9.0)
    u = LENGTH * (10.0 * fy / e - 2.0 * fy / e)
    for change, stiff in ((+1e-3, 1.0), (-1e-3, 0.02)):
        force, tangent = point.respond(np.array([u * (1.0 + change), 0.0, 0.0]))
        assert tangent[0, 0] == pytest.approx(stiff * CAPACITY.EA / LENGTH, rel=1e-9)
    force, _ = point.respond(np.array([u, 0.0, 0.0]))
    assert force[0] / SECTION.area == pytest.approx(stress - 2.0 * fy, rel=1e-9)


def nearest_by_search(law: InteractionPlastic, trial: np.ndarray) -> np.ndarray:
    """The point of the yield surface nearest to a trial force in the elastic energy: all edges, all corners, all Q."""
    surface, (kN, kQ, kM) = law.surface, law.stiffness
    scale = np.sqrt([kN, kM])
    normals, target = surface.normals * scale, trial[[0, 2]] / scale

    def at(Q: float) -> tuple[float, np.ndarray]:
        limit = surface.fixed + surface.walls * np.sqrt(1.0 - (Q / surface.Q_max) ** 2)
        over = normals @ target - limit
        feet = target - (over / np.sum(normals**2, axis=1))[:, None] * normals
        i, j = np.triu_indices(len(limit), 1)
        det = normals[i, 0] * normals[j, 1] - normals[i, 1] * normals[j, 0]
        crossing = np.abs(det) > 1e-12 * np.abs(det).max()
        i, j, det = i[crossing], j[crossing], det[crossing]
        corners = np.column_stack(
            [
                (limit[i] * normals[j, 1] - limit[j] * normals[i, 1]) / det,
                (normals[i, 0] * limit[j] - normals[j, 0] * limit[i]) / det,
            ]
        )
        points = np.vstack([target[None], feet, corners])
        inside = (points @ normals.T <= limit + 1e-10).all(axis=1)
        distance = np.where(inside, np.sum((points - target) ** 2, axis=1), np.inf)
        best = int(np.argmin(distance))
        return 0.5 * float(distance[best]) + 0.5 * (Q - abs(trial[1])) ** 2 / kQ, points[best] * scale

    most = min(abs(trial[1]), surface.Q_max)
    found = minimize_scalar(lambda Q: at(Q)[0], bounds=(0.0, most), method="bounded", options={"xatol": 1e-9 * most})
    Q = min((float(found.x), most), key=lambda Q: at(Q)[0])
    N, M = at(Q)[1]
    return np.array([N, np.copysign(Q, trial[1]), M])


@pytest.mark.parametrize("exact", [INTERACTION, FLANGED], ids=["rectangle", "IPE"])
@settings(max_examples=50)
@given(trial=st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(np.array))
def test_return_to_the_surface_agrees_with_a_search_over_all_of_it(exact: Interaction, trial: np.ndarray) -> None:
    law = interacting(exact, 24)
    limit, stiffness = np.array(law.capacities()), np.array(law.stiffness)
    trial = trial * limit
    ours, _ = Point(law).respond(trial / stiffness)
    found = nearest_by_search(law, trial)
    energies = [float(np.sum((s - trial) ** 2 / stiffness)) for s in (ours, found)]
    size = float(np.sum(trial**2 / stiffness)) + 1e-30
    assert abs(energies[0] - energies[1]) <= 1e-6 * size
    # The nearest point of a convex region is unique, and the square root of the energy is its distance.
    assert float(np.sum((ours - found) ** 2 / stiffness)) <= 1e-5 * size


@pytest.mark.parametrize("exact", [INTERACTION, FLANGED], ids=["rectangle", "IPE"])
@given(path=st.lists(deformations, min_size=1, max_size=6))
def test_interacting_forces_stay_on_the_surface(exact: Interaction, path: list[np.ndarray]) -> None:
    point = Point(interacting(exact))
    for q in path:
        force, _ = point.respond(10.0 * q)
        assert float(point.law.surface.value(*force)) <= 1.0 + 1e-9  # type: ignore[attr-defined]
        point.commit(10.0 * q)


@pytest.mark.parametrize("exact", [INTERACTION, FLANGED, HOLLOW], ids=["rectangle", "IPE", "RHS"])
def test_a_force_on_the_surface_is_its_own_nearest_point(exact: Interaction) -> None:
    """It is outside by rounding or not at all: which facet it exceeds most must not be left to rounding, too."""
    generator, law = np.random.default_rng(1), interacting(exact)
    limit, k = np.array(law.capacities()), np.array(law.stiffness)
    for _ in range(2000):
        trial = generator.normal(size=3) * generator.uniform(0.5, 40.0) * limit
        force, _ = Point(law).respond(trial / k)
        again, _ = Point(law).respond(force / k)
        assert np.abs((again - force) / limit).max() <= 1e-9


def test_interacting_tangent_is_the_derivative() -> None:
    """By central differences, wherever the tangents on both sides are alike: but for edges of the surface."""
    generator, law, smooth = np.random.default_rng(5), interacting(), 0
    point, limit, k = Point(law), np.array(law.capacities()), np.array(law.stiffness)
    for _ in range(300):
        q = generator.uniform(-3.0, 3.0, 3) * limit / k
        small = 1e-6 * generator.uniform(-1.0, 1.0, 3) * q
        _, tangent = point.respond(q)
        (after, steeper), (before, flatter) = point.respond(q + small), point.respond(q - small)
        if np.abs((steeper - flatter) @ small / limit).max() <= 1e-3 * np.abs(k * small / limit).max():
            np.testing.assert_allclose(2.0 * (tangent @ small) / limit, (after - before) / limit, atol=1e-8)
            smooth += 1
    assert smooth > 250


@pytest.mark.parametrize("exact", [INTERACTION, FLANGED], ids=["rectangle", "IPE"])
@settings(max_examples=40)
@given(trial=st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(np.array))
def test_forces_that_yield_lie_on_the_exact_interaction(exact: Interaction, trial: np.ndarray) -> None:
    """Within the error that the facets state, and never beyond the section's own surface."""
    law = interacting(exact)
    point = Point(law)
    force, tangent = point.respond(trial * law.capacities() / law.stiffness)
    if np.abs(tangent - np.diag(law.stiffness)).max() > 0.0:
        assert 1.0 - 1e-9 <= exact.load_factor(*force.tolist()) <= 1.0 + law.surface.error + 1e-9


def test_a_rigid_plastic_joint_shows_nothing_until_it_yields() -> None:
    point = Point(RigidPlastic((1e6, 5e5, 3e4)))
    for share, plastic in ((0.999, False), (1.5, True)):
        before = point.state.copy()
        point.commit(share * np.array([1e-5, 1e-5, 1e-4]))
        assert (np.abs(point.state - before) > 0.0).all() == plastic
    assert RigidPlastic((np.inf, 1e5, 0.0)).stiffness == pytest.approx((1e10, 1e10, 0.0))
    with pytest.raises(ValueError, match="finite and positive"):
        RigidPlastic((np.inf, np.inf, 0.0))


def test_a_table_of_stresses_is_followed_on_first_loading_and_back() -> None:
    """Layers in parallel: the curve itself, then Masing's rule, twice the curve from the turn."""
    point, curve = Point(LAYERED), CURVED.stress_strain
    for strain in np.linspace(0.0, 0.015, 40):
        force, _ = point.respond(np.array([strain * LENGTH, 0.0, 0.0]))
        assert force[0] / SECTION.area == pytest.approx(float(curve.stress(strain)), rel=1e-9, abs=1e-3)
    point.commit(np.array([0.015 * LENGTH, 0.0, 0.0]))
    top = float(curve.stress(0.015))
    for back in np.linspace(0.0, 0.02, 40):
        force, _ = point.respond(np.array([(0.015 - back) * LENGTH, 0.0, 0.0]))
        expected = top - 2.0 * float(curve.stress(0.5 * back))
        assert force[0] / SECTION.area == pytest.approx(expected, rel=1e-9, abs=1e-3)
    steeper = parse_material("curve=0.001:210 0.004:220 0.01:330 MPa")
    with pytest.raises(InputError, match="grows steeper"):
        FibreSection.of_section(SECTION, steeper, LENGTH)
