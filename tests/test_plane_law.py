"""J2 in plane stress against a scalar twin: the radial return in three dimensions with σ33 = 0 found by bisection.

Simo & Hughes, *Computational Inelasticity*, box 3.2, written for one point without any of the algebra of the law.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from capacity import Material, parse_material
from fem_reference.plane.j2 import J2, MODES, Flow, von_mises

E, NU, FY = 210e9, 0.3, 235e6
STRAINS = st.tuples(*[st.floats(-0.02, 0.02)] * 3)
HARDENING = st.sampled_from([("kinematic", 0.0), ("kinematic", 0.02), ("isotropic", 0.02)])


def steel(slope: float) -> Material:
    return parse_material(f"fy=235 MPa, E=210 GPa, Et={slope * E!r} Pa")


def law(kind: str, slope: float) -> J2:
    return J2.of([steel(slope)], np.zeros(1, dtype=int), kind)  # type: ignore[arg-type]


def respond(j2: J2, strain: np.ndarray, before: Flow | None) -> Flow:
    """One point at ``strain`` (ε11, ε22, γ12)."""
    plastic = np.zeros((1, 1, 3)) if before is None else before.plastic_strain
    alpha = np.zeros((1, 1)) if before is None else before.accumulated
    return j2.respond((MODES @ strain)[None, None], plastic, alpha)


def twin(strain: np.ndarray, plastic: np.ndarray, alpha: float, kind: str, slope: float) -> tuple[np.ndarray, ...]:
    """Stress, plastic strain (3 × 3 tensors) and α after a step to ``strain`` (ε11, ε22, γ12)."""
    modulus = E * slope / (1.0 - slope)
    shear, bulk = E / (2.0 + 2.0 * NU), E / (3.0 - 6.0 * NU)
    one = np.eye(3)

    def at(normal: float) -> tuple[np.ndarray, np.ndarray, float]:
        full = np.array([[strain[0], strain[2] / 2, 0.0], [strain[2] / 2, strain[1], 0.0], [0.0, 0.0, normal]])
        volume = np.trace(full)
        trial = 2.0 * shear * (full - volume / 3.0 * one - plastic)
        back = 2.0 / 3.0 * modulus * plastic if kind == "kinematic" else 0.0 * one
        relative = trial - back
        size = math.sqrt(float((relative**2).sum()))
        radius = math.sqrt(2.0 / 3.0) * (FY + (modulus * alpha if kind == "isotropic" else 0.0))
        gamma = max(size - radius, 0.0) / (2.0 * shear + 2.0 / 3.0 * modulus)
        flow = gamma * relative / size if gamma else 0.0 * one
        stress = trial - 2.0 * shear * flow + bulk * volume * one
        return stress, plastic + flow, alpha + math.sqrt(2.0 / 3.0) * gamma

    normal = brentq(lambda e33: at(e33)[0][2, 2], -0.2, 0.2, xtol=1e-16, rtol=1e-15)
    return at(normal)


def tensor(stress: np.ndarray) -> np.ndarray:
    s11, s22, s12 = MODES.T @ stress
    return np.array([[s11, s12, 0.0], [s12, s22, 0.0], [0.0, 0.0, 0.0]])


@given(path=st.lists(STRAINS, min_size=1, max_size=4), hardening=HARDENING)
def test_follows_its_twin_and_never_leaves_the_yield_surface(
    path: list[tuple[float, float, float]], hardening: tuple[str, float]
) -> None:
    kind, slope = hardening
    j2 = law(kind, slope)
    before: Flow | None = None
    plastic, alpha = np.zeros((3, 3)), 0.0
    for strain in path:
        found = respond(j2, np.array(strain), before)
        stress, plastic, alpha = twin(np.array(strain), plastic, alpha, kind, slope)
        np.testing.assert_allclose(tensor(found.stress[0, 0]), stress, rtol=0.0, atol=1e-8 * E * 0.02)
        assert found.accumulated[0, 0] == pytest.approx(alpha, abs=1e-9)
        # Inside the surface around the back stress.
        modulus = E * slope / (1.0 - slope)
        back = modulus * (2.0 / 3.0) / np.array([1 / 3, 1, 2]) * found.plastic_strain * (kind == "kinematic")
        bound = FY + modulus * found.accumulated[0, 0] * (kind == "isotropic")
        assert von_mises(found.stress - back)[0, 0] <= bound * (1.0 + 1e-12)
        # Dissipation: (σ - β)·Δεp, never negative.
        flow = found.plastic_strain - (0.0 if before is None else before.plastic_strain)
        assert float(((found.stress - back) * flow).sum()) >= 0.0
        before = found


@given(first=STRAINS, second=STRAINS, hardening=HARDENING)
def test_tangent_is_the_derivative_of_the_stress(
    first: tuple[float, ...], second: tuple[float, ...], hardening: tuple[str, float]
) -> None:
    j2 = law(*hardening)
    before = respond(j2, np.array(first), None)
    strain, reach = np.array(second), 1e-8
    here = respond(j2, strain, before)
    ahead = [respond(j2, strain + reach * axis, before) for axis in np.eye(3)]
    behind = [respond(j2, strain - reach * axis, before) for axis in np.eye(3)]
    if len({bool(point.flows[0, 0]) for point in (here, *ahead, *behind)}) > 1:
        return  # at first yield there is no derivative
    tangent = here.tangent[0] if here.flows[0, 0] else np.diag(j2.stiffness[0, 0])
    slopes = np.stack([(a.stress - b.stress)[0, 0] / (2 * reach) for a, b in zip(ahead, behind, strict=True)], axis=1)
    np.testing.assert_allclose(tangent @ MODES, slopes, rtol=0.0, atol=2e-6 * E)
    np.testing.assert_allclose(tangent, tangent.T)
    assert np.linalg.eigvalsh(tangent).min() >= -1e-12 * E


@pytest.mark.parametrize("kind", ["kinematic", "isotropic"])
def test_in_one_direction_it_is_bilinear(kind: str) -> None:
    """σ = fy + E_t (ε - fy / E), as for a fibre; the free strain across is found by bisection."""
    j2 = law(kind, 0.02)
    strain = 0.011
    across = brentq(
        lambda e22: float((MODES.T @ respond(j2, np.array([strain, e22, 0.0]), None).stress[0, 0])[1]),
        -0.02,
        0.02,
        xtol=1e-16,
    )
    stress = MODES.T @ respond(j2, np.array([strain, across, 0.0]), None).stress[0, 0]
    assert stress[0] == pytest.approx(FY + 0.02 * E * (strain - FY / E), rel=1e-9)


def test_pure_shear_yields_at_fy_over_root_three() -> None:
    found = respond(law("kinematic", 0.0), np.array([0.0, 0.0, 0.01]), None)
    np.testing.assert_allclose(MODES.T @ found.stress[0, 0], [0.0, 0.0, FY / math.sqrt(3.0)], atol=1e-6)


def test_a_strain_that_is_not_finite_is_refused() -> None:
    with pytest.raises(ArithmeticError, match="finite"):
        respond(law("kinematic", 0.0), np.array([np.nan, 0.0, 0.0]), None)
