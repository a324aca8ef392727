"""The reference's shape, laid over a replay."""

import numpy as np
import pytest
from cantilevers import cantilever

from calibration.reference_shape import reference_shape
from capacity import InputError
from scene import parse_scene


def test_a_cantilever_s_reference_ends_where_it_was_pushed() -> None:
    """Elastic, by P at the tip: y(x) = -δ (3 L x² - x³) / 2 L³."""
    length, distance = 2.0, 0.005
    (line,) = reference_shape(cantilever("rectangle 50x100 mm", length, distance)).lines
    x, y = line.T
    assert (x[0], y[0]) == (0.0, 0.0)
    assert x[-1] == pytest.approx(length, rel=1e-9)
    np.testing.assert_allclose(y, -distance * (3 * length * x**2 - x**3) / (2 * length**3), atol=1e-6 * length)


def test_a_scene_without_a_push_has_none() -> None:
    scene = parse_scene(
        """
        title = "falls"
        [nodes.root]
        at = [0, 0]
        support = "clamped"
        [nodes.tip]
        at = [1, 0]
        mass = "5 kg"
        velocity = ["0 m/s", "-1 m/s"]
        [members.beam]
        from = "root"
        to = "tip"
        section = "rectangle 50x100 mm"
        material = "S235"
        [motion]
        duration = "0.1 s"
        """,
        "test",
    )
    with pytest.raises(InputError, match="push"):
        reference_shape(scene)
