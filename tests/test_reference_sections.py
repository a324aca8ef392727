"""Section response of the reference against closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import parse_material, parse_section
from capacity.moment_curvature import moment_curvature, moment_history
from capacity.stress_strain import StressStrain
from fem_reference.section_response import FibreSections

E, FY = 210e9, 235e6
SECTION = parse_section("rectangle 50x100 mm")


def sections_of(y: np.ndarray, area: np.ndarray, law: StressStrain) -> FibreSections:
    """One section alone, as an "element" whose degrees of freedom are its strains."""
    return FibreSections(
        np.zeros(1, int), y[None], area[None], np.zeros((1, len(y)), int), law.slopes[:1], law.slopes[-1:],
        law.breaks[None], law.drops[None], np.ones(1),
    )  # fmt: skip


def rectangle(fibres: int, tangent_modulus: float = 0.0) -> FibreSections:
    f = SECTION.fibres(fibres)
    return sections_of(f.y, f.area, StressStrain.bilinear(E, FY, tangent_modulus))


def response(
    sections: FibreSections, mean: float, curvature: float, slip: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(N, M), their tangent and the slips after."""
    start = sections.virgin(1) if slip is None else slip
    strains = np.array([[mean, curvature, 0.0]])
    _, _, _, force, matrix, _, after = sections.respond(strains, np.eye(3)[None, None], np.ones((1, 1)), start)
    return force[0, :2], matrix[0, :2, :2], after


def moment(sections: FibreSections, curvature: float, slip: np.ndarray | None = None) -> tuple[float, np.ndarray]:
    resultants, _, after = response(sections, 0.0, curvature, slip)
    return float(resultants[1]), after


@pytest.mark.parametrize("ratio", [0.5, 1.0, 1.3, 2.0, 5.0, 20.0])
def test_moment_curvature_of_a_rectangle(ratio: float) -> None:
    """M / M_p = 1 - (κ_y / κ)² / 3 beyond first yield (Chakrabarty, Theory of Plasticity, 3rd ed., section 3.7)."""
    plastic_moment, yield_curvature = FY * SECTION.plastic_modulus, 2.0 * FY / (E * 0.1)
    expected = ratio * 2.0 / 3.0 if ratio <= 1.0 else 1.0 - 1.0 / (3.0 * ratio**2)
    value, _ = moment(rectangle(200), ratio * yield_curvature)
    assert value / plastic_moment == pytest.approx(expected, abs=1e-4)


def test_error_falls_with_the_square_of_the_number_of_fibres() -> None:
    ratios = np.linspace(1.05, 4.0, 60)
    exact = 1.0 - 1.0 / (3.0 * ratios**2)
    counts = np.array([16, 32, 64, 128, 256])
    errors = []
    for count in counts:
        sections = rectangle(int(count))
        values = [moment(sections, r * 2.0 * FY / (E * 0.1))[0] for r in ratios]
        errors.append(np.abs(np.array(values) / (FY * SECTION.plastic_modulus) - exact).max())
    rate = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert rate > 1.7


def test_unloading_is_elastic_and_leaves_the_springback_of_masing() -> None:
    sections = rectangle(200)
    curvature = 3.0 * 2.0 * FY / (E * 0.1)
    loaded, plastic = moment(sections, curvature)
    eased, _ = moment(sections, 0.9 * curvature, plastic)
    assert loaded - eased == pytest.approx(0.1 * curvature * E * SECTION.second_moment_of_area, rel=1e-9)


@given(
    path=st.lists(st.tuples(st.floats(-0.005, 0.005), st.floats(-0.3, 0.3)), min_size=1, max_size=8),
    hardening=st.sampled_from([0.0, 0.01, 0.2]),
)
def test_never_outside_yield_and_never_negative_dissipation(path: list[tuple[float, float]], hardening: float) -> None:
    sections = rectangle(12, hardening * E)
    modulus = E * hardening / (1.0 - hardening)
    slip = sections.virgin(1)
    plastic = np.zeros(12)
    for mean, curvature in path:
        _, _, slip = response(sections, mean, curvature, slip)
        after = sections.plastic_strain(np.array([[[mean, curvature, 0.0]]]), slip)[0, 0]
        stress = E * (mean - sections.y[0] * curvature - after)
        relative = stress - modulus * after
        assert np.abs(relative).max() <= FY * (1.0 + 1e-9)
        assert (relative * (after - plastic)).min() >= -1e-9 * FY
        plastic = after


@given(mean=st.floats(-0.003, 0.003), curvature=st.floats(-0.2, 0.2))
def test_tangent_is_the_derivative(mean: float, curvature: float) -> None:
    sections = rectangle(16, 0.02 * E)

    def resultants(m: float, k: float) -> np.ndarray:
        return response(sections, m, k)[0]

    tangent = response(sections, mean, curvature)[1]
    step = np.array([1e-9, 1e-7])
    scale = np.array([E * SECTION.area, E * SECTION.area * 0.1])
    for i, (dm, dk) in enumerate([(step[0], 0.0), (0.0, step[1])]):
        # A fibre may cross its yield point between the two evaluations; one-sided slopes then bracket the tangent.
        ahead = (resultants(mean + dm, curvature + dk) - resultants(mean, curvature)) / step[i]
        behind = (resultants(mean, curvature) - resultants(mean - dm, curvature - dk)) / step[i]
        margin = 1e-4 * scale * (1.0 if i == 0 else 0.1)
        assert np.all(tangent[:, i] <= np.maximum(ahead, behind) + margin)
        assert np.all(tangent[:, i] >= np.minimum(ahead, behind) - margin)


TABLE = parse_material("curve=0.0011:231 0.004:260 0.02:320 0.15:400 MPa").stress_strain


@pytest.mark.parametrize("strain", [0.0005, 0.002, 0.01, 0.1, -0.03, 0.3])
def test_a_fibre_follows_its_table_and_twice_its_size_on_the_way_back(strain: float) -> None:
    """Masing: unloading from σ(ε) by Δ falls by 2 σ(Δ / 2)."""
    one = sections_of(np.zeros(1), np.ones(1), TABLE)
    first, _, slip = response(one, strain, 0.0)
    assert first[0] == pytest.approx(float(TABLE.stress(strain)), rel=1e-12)
    for share in (0.1, 0.6, 1.4, 2.0):
        back, _, _ = response(one, strain * (1.0 - share), 0.0, slip)
        assert first[0] - back[0] == pytest.approx(2.0 * float(TABLE.stress(0.5 * share * strain)), rel=1e-12)


def test_a_section_with_a_table_follows_moment_curvature() -> None:
    """The exact integration of `capacity`, loading and unloading, in the limit of many fibres."""
    material = parse_material("curve=0.0011:231 0.004:260 0.02:320 0.15:400 MPa")
    path = np.array([0.02, 0.1, 0.4, 0.2, -0.1, -0.5, 0.3])
    fibres = SECTION.fibres(400)
    sections = sections_of(fibres.y, fibres.area, material.stress_strain)
    slip, found = sections.virgin(1), []
    for curvature in path:
        resultants, _, slip = response(sections, 0.0, float(curvature), slip)
        found.append(resultants[1])
    exact = moment_history(SECTION, material, path, fibres=2000).moment
    assert found == pytest.approx(exact, rel=2e-4, abs=2e-4 * np.abs(exact).max())
    first = moment_curvature(SECTION, material, path[:3]).moment
    assert found[:3] == pytest.approx(first, rel=2e-4)


def test_plastic_strain_is_what_stress_does_not_explain() -> None:
    one = sections_of(np.zeros(1), np.ones(1), TABLE)
    force, _, slip = response(one, 0.03, 0.0)
    plastic = one.plastic_strain(np.array([[[0.03, 0.0, 0.0]]]), slip)
    assert plastic[0, 0, 0] == pytest.approx(0.03 - force[0] / TABLE.slopes[0], rel=1e-12)
