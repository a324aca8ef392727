"""Where joints go: quadrature, and hinges of a chosen length."""

import numpy as np
import pytest
from cantilevers import cantilever
from hypothesis import given
from hypothesis import strategies as st

import sim
from capacity import InputError
from scene import parse_scene
from sim import Model, Rule, equal, graded, lobatto, radau
from sim.moment_peaks import moment_peaks


@pytest.mark.parametrize(
    ("rule", "degree"),
    [
        (equal(9), 1),
        (lobatto(2), 1),
        (lobatto(5), 7),
        (lobatto(9), 15),
        (graded(6), 3),
        (graded(9), 7),
        (graded(9, end=False), 6),
        (graded(12, end=False), 7),
        (radau(6, 0.05), 3),
        (radau(8, 0.1), 3),
    ],
    ids=lambda value: value.name if isinstance(value, Rule) else str(value),
)
def test_rules_integrate_polynomials(rule: Rule, degree: int) -> None:
    """Gauss–Lobatto to degree 2n - 3; Radau points with Gauss points between to 3; equal pieces to 1.

    Graded points to n - 3, symmetric ones to the next odd number; to 7 at most.
    """
    for power in range(degree + 1):
        assert rule.weights @ rule.points**power == pytest.approx(1.0 / (power + 1), rel=1e-12)
    assert abs(rule.weights @ rule.points ** (degree + 1) - 1.0 / (degree + 2)) > 1e-12


@given(joints=st.integers(6, 40), start=st.booleans(), end=st.booleans())
def test_graded_points_lie_nearer_to_the_peaks(joints: int, start: bool, end: bool) -> None:
    rule, even = graded(joints, start=start, end=end), lobatto(joints)
    mirrored = graded(joints, start=end, end=start)
    assert rule.points == pytest.approx(1.0 - mirrored.points[::-1], abs=1e-13)
    assert rule.weights == pytest.approx(mirrored.weights[::-1], rel=1e-10)
    assert np.all(np.diff(rule.points) > 0.0)
    assert np.all(rule.weights > 0.0)
    for peak, i in ((start, 0), (end, -1)):
        if peak:
            assert rule.weights[i] < 0.8 * even.weights[i]
    if not (start or end):
        assert np.array_equal(rule.points, even.points)


def test_moments_peak_at_ends_that_are_held() -> None:
    """A propped beam of two members, its right half loaded along its way; a bar; a cantilever from a knee."""
    scene = parse_scene(
        """
title = "peaks"
gravity = 0.0
nodes.A = { at = ["0 m", "0 m"], support = "clamped" }
nodes.B = { at = ["3 m", "0 m"] }
nodes.C = { at = ["6 m", "0 m"], support = "roller-x" }
nodes.D = { at = ["3 m", "2 m"] }
nodes.E = { at = ["4 m", "2 m"] }
members.left = { section = "IPE 200", material = "S235", from = "A", to = "B" }
members.right = { section = "IPE 200", material = "S235", from = "B", to = "C" }
members.post = { section = "IPE 200", material = "S235", from = "B", to = "D", releases = ["from"] }
members.tip = { section = "IPE 200", material = "S235", from = "D", to = "E" }
loads = [{ member = "right", per_length = ["0 N/m", "-1 N/m"] }, { member = "tip", per_length = ["0 N/m", "-1 N/m"] }]
push = { node = "B", direction = [0, -1], distance = "1 mm" }
""",
        "peaks",
    )
    peaks = {name: moment_peaks(scene, name) for name in scene.members}
    assert peaks == {
        "left": (True, True),
        "right": (True, False),
        "post": (False, True),
        "tip": (True, False),
    }


@given(joints=st.integers(6, 12), hinge=st.floats(1e-3, 0.12))
def test_hinges_have_the_length_that_was_asked_for(joints: int, hinge: float) -> None:
    rule = radau(joints, hinge)
    assert rule.weights[[0, -1]] == pytest.approx([hinge, hinge])
    assert rule.points[[0, -1]] == pytest.approx([0.0, 1.0])
    assert list(np.flatnonzero(~rule.elastic)) == [0, joints - 1]
    assert np.all(np.diff(rule.points) > 0.0)


def test_a_hinge_that_hardens_turns_by_its_length_times_the_plastic_curvature() -> None:
    """Tip deflection P L³ / 3EI + l_p κ_p(P L) L, κ_p of a rectangle that hardens (two bilinear fibre integrals)."""
    length, hinge, hardening = 1.0, 0.08, 0.02
    distance = 0.03
    scene = cantilever("rectangle 50x100 mm", length, distance, hardening=hardening)
    push = sim.push_over(
        scene, Model("radau", 6, "fibre", 60, dt=1 / 240, hinge_length=hinge), np.linspace(0.0, distance, 31)
    )
    ei, b, h, fy, e = 875000.0, 0.05, 0.1, 235e6, 210e9

    def moment(curvature: float) -> float:
        """M = E_t I κ + (1 - E_t/E) M_epp(κ), for bilinear fibres act as an elastic and a plastic one side by side."""
        yielding = 2.0 * fy / (e * h)
        full = fy * b * h**2 / 4.0
        ratio = yielding / curvature
        perfect = full * (1.0 - ratio**2 / 3.0) if ratio < 1.0 else ei * curvature
        return hardening * ei * curvature + (1.0 - hardening) * perfect

    for displacement, load in zip(push.displacement[60::60], push.load[60::60], strict=True):
        low, high = 0.0, 10.0
        for _ in range(80):
            curvature = 0.5 * (low + high)
            low, high = (curvature, high) if moment(curvature) < load * length else (low, curvature)
        expected = load * length**3 / (3.0 * ei) + hinge * (curvature - load * length / ei) * length
        assert displacement == pytest.approx(expected, rel=5e-3)
    assert curvature > 4.0 * 2.0 * fy / (e * h)


def test_elastic_answer_of_hinges_with_radau_points_is_exact() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 1e-3)
    push = sim.push_over(scene, Model("radau", 6, "fibre"), np.linspace(0.0, 1e-3, 5))
    assert push.load[-1] / push.displacement[-1] == pytest.approx(3.0 * 875000.0, rel=1e-4)


def test_hinges_too_long_for_a_member_are_refused() -> None:
    scene = cantilever("rectangle 50x100 mm", 0.7, 0.01)
    with pytest.raises(InputError, match=r"members.beam.*too long.*shorter than 0.0875 m"):
        sim.assemble(scene, Model("radau", 6, "fibre"))
    with pytest.raises(ValueError, match="at least 6"):
        sim.assemble(scene, Model("radau", 5, "fibre", hinge_length=0.05))
    with pytest.raises(ValueError, match="between 0 and 1/8"):
        radau(6, 0.125)
    with pytest.raises(ValueError, match="at least 6"):
        graded(5)
    for rule in (lobatto, equal):
        with pytest.raises(ValueError, match="at least 2"):
            rule(1)
