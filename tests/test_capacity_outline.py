import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from capacity.outline import Outline
from capacity.paths import arc, path

sizes = st.floats(0.01, 2.0)
fractions = st.floats(0.02, 0.98)


def test_moments_of_a_circle_are_those_of_the_closed_form() -> None:
    r, x, y = 0.3, 0.7, -0.2
    outline = Outline.from_edges(arc(x, y, r, 0.0, 2.0 * math.pi))
    a = math.pi * r * r
    expected = [a, a * x, a * y, a * (r * r / 4 + x * x), a * x * y, a * (r * r / 4 + y * y)]
    np.testing.assert_allclose(outline.moments(), expected, rtol=1e-14)


@given(radius=sizes, fraction=fractions)
def test_circular_segment_above_a_chord(radius: float, fraction: float) -> None:
    """Area r²(φ - sin φ cos φ) and first moment (2/3)(r sin φ)³ (Roark, Table A.1, case 21)."""
    outline = Outline.from_edges(arc(0.0, 0.0, radius, 0.0, 2.0 * math.pi))
    y = radius * (2.0 * fraction - 1.0)
    phi = math.acos(y / radius)
    area, _, first = outline.moments(y)[:3]
    assert area == pytest.approx(radius**2 * (phi - math.sin(phi) * math.cos(phi)), rel=1e-12, abs=1e-14)
    assert first == pytest.approx(2.0 / 3.0 * (radius * math.sin(phi)) ** 3, rel=1e-12, abs=1e-14)


@given(b=sizes, h=sizes, fraction=fractions)
def test_rectangle_above_a_line(b: float, h: float, fraction: float) -> None:
    outline = Outline.polygon([(0.0, 0.0), (b, 0.0), (b, h), (0.0, h)])
    y = fraction * h
    expected = [b * (h - y), b * b / 2 * (h - y), b * (h * h - y * y) / 2]
    np.testing.assert_allclose(outline.moments(y)[:3], expected, rtol=1e-12)
    assert outline.width(y) == pytest.approx(b)


@given(fraction=st.floats(0.01, 0.99))
def test_width_is_the_slope_of_the_area_above(fraction: float) -> None:
    outline = path([(0.0, 0.0, 0.0), (1.0, 0.0, 0.2), (1.0, 1.0, 0.3), (0.0, 1.0, 0.1)])
    y, step = fraction, 1e-6
    slope = (outline.moments(y - step)[0] - outline.moments(y + step)[0]) / (2.0 * step)
    assert outline.width(y) == pytest.approx(slope, rel=1e-5)


def test_fillet_takes_its_area_from_the_corner() -> None:
    square = path([(0.0, 0.0, 0.1), (1.0, 0.0, 0.1), (1.0, 1.0, 0.1), (0.0, 1.0, 0.1)])
    assert square.moments()[0] == pytest.approx(1.0 - (4.0 - math.pi) * 0.01, rel=1e-14)


def test_fillet_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="fillet is too large"):
        path([(0.0, 0.0, 0.6), (1.0, 0.0, 0.6), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
