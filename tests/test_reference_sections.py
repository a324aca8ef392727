"""Section response of the reference against closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity import parse_section
from fem_reference.section_response import FibreSections

E, FY = 210e9, 235e6
SECTION = parse_section("rectangle 50x100 mm")


def rectangle(fibres: int, tangent_modulus: float = 0.0) -> FibreSections:
    f = SECTION.fibres(fibres)
    return FibreSections(
        f.y[None, None], f.area[None, None], *(np.full((1, 1, 1), value) for value in (E, FY, tangent_modulus))
    )


def moment(sections: FibreSections, curvature: float, plastic: np.ndarray | None = None) -> tuple[float, np.ndarray]:
    start = np.zeros((1, 1, sections.y.shape[-1])) if plastic is None else plastic
    resultants, _, after = sections.respond(np.zeros((1, 1)), np.full((1, 1), curvature), start)
    return float(resultants[0, 0, 1]), after


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
    plastic = np.zeros((1, 1, 12))
    for mean, curvature in path:
        _, _, after = sections.respond(np.full((1, 1), mean), np.full((1, 1), curvature), plastic)
        stress = E * (mean - sections.y * curvature - after)
        relative = stress - modulus * after
        assert np.abs(relative).max() <= FY * (1.0 + 1e-9)
        assert (relative * (after - plastic)).min() >= -1e-9 * FY
        plastic = after


@given(mean=st.floats(-0.003, 0.003), curvature=st.floats(-0.2, 0.2))
def test_tangent_is_the_derivative(mean: float, curvature: float) -> None:
    sections = rectangle(16, 0.02 * E)
    virgin = np.zeros((1, 1, 16))

    def resultants(m: float, k: float) -> np.ndarray:
        return np.asarray(sections.respond(np.full((1, 1), m), np.full((1, 1), k), virgin)[0][0, 0])

    tangent = sections.respond(np.full((1, 1), mean), np.full((1, 1), curvature), virgin)[1][0, 0]
    step = np.array([1e-9, 1e-7])
    scale = np.array([E * SECTION.area, E * SECTION.area * 0.1])
    for i, (dm, dk) in enumerate([(step[0], 0.0), (0.0, step[1])]):
        # A fibre may cross its yield point between the two evaluations; one-sided slopes then bracket the tangent.
        ahead = (resultants(mean + dm, curvature + dk) - resultants(mean, curvature)) / step[i]
        behind = (resultants(mean, curvature) - resultants(mean - dm, curvature - dk)) / step[i]
        margin = 1e-4 * scale * (1.0 if i == 0 else 0.1)
        assert np.all(tangent[:, i] <= np.maximum(ahead, behind) + margin)
        assert np.all(tangent[:, i] >= np.minimum(ahead, behind) - margin)
