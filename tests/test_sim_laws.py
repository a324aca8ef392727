"""Joint laws: derivative, yield, dissipation, and what the fibre law shares with the section."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import capacity, parse_material, parse_section
from sim import ElasticPlastic, FibreSection, Law
from sim.laws import elastic_plastic, fibre

SECTION, MATERIAL = parse_section("rectangle 50x100 mm"), parse_material("S235")
CAPACITY = capacity(SECTION, MATERIAL)
LENGTH = 0.1
MODULES = {"elastic-plastic": elastic_plastic, "fibre": fibre}


def capped() -> ElasticPlastic:
    c = CAPACITY
    return ElasticPlastic((c.EA / LENGTH, c.GA_s / LENGTH, c.EI / LENGTH), (c.N_max, c.Q_max, c.M_max))


def fibres(hardening: float = 0.0, count: int = 12) -> FibreSection:
    f, e = SECTION.fibres(count), MATERIAL.youngs_modulus
    return FibreSection(
        LENGTH, f.y, f.area, e, MATERIAL.yield_stress, hardening * e, CAPACITY.GA_s / LENGTH, CAPACITY.Q_max
    )


class Point:
    """One joint's law, its memory, and its compiled functions."""

    def __init__(self, law: Law) -> None:
        self.law, self.module = law, MODULES[law.name]
        self.parameters, self.state = law.parameters(), law.state()

    def respond(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        out, q = np.empty(9), np.ascontiguousarray(q, float)
        self.module.respond.ctypes(*(x.ctypes.data for x in (self.parameters, self.state, q, out)))
        a = out[3:]
        return out[:3], np.array([[a[0], a[1], a[2]], [a[1], a[3], a[4]], [a[2], a[4], a[5]]])

    def commit(self, q: np.ndarray) -> tuple[float, float]:
        out, q = np.empty(5), np.ascontiguousarray(q, float)
        self.module.commit.ctypes(*(x.ctypes.data for x in (self.parameters, self.state, q, out)))
        return float(out[0]), float(out[1])


LAWS = [capped(), fibres(), fibres(0.02)]
deformations = st.tuples(st.floats(-5e-4, 5e-4), st.floats(-5e-4, 5e-4), st.floats(-0.05, 0.05)).map(np.array)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_capacities_are_those_of_the_section(law: Law) -> None:
    expected = (CAPACITY.N_max, CAPACITY.Q_max, CAPACITY.M_max)
    assert law.capacities() == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
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
