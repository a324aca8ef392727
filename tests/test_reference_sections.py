"""Section response of the reference against closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import parse_section
from capacity.stress_strain import StressStrain
from fem_reference.section_response import FibreSections

E, FY = 210e9, 235e6
SECTION = parse_section("rectangle 50x100 mm")


def sections_of(y: np.ndarray, area: np.ndarray, law: StressStrain) -> FibreSections:
    """One section alone, as an "element" whose degrees of freedom are its strains."""
    return FibreSections(
        np.zeros(1, int), y[None], area[None], law.slopes[:1], law.slopes[-1:], law.breaks[None], law.drops[None],
        np.ones(1),
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
