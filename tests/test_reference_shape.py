"""The reference's shape, laid over a replay."""

import numpy as np
import pytest
import shapely
from cantilevers import cantilever
from rich.console import Console

from calibration.reference_shape import reference_path, shape_for_replay, way
from capacity import InputError
from scene import Scene, builtin_text, load_scene, parse_scene

LENGTH, DISTANCE = 2.0, 0.005


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Pushed at the tip by half of its deflection at first yield."""
    return cantilever("rectangle 50x100 mm", LENGTH, DISTANCE)


def test_a_cantilever_bends_as_it_is_pushed(scene: Scene) -> None:
    """Elastic, by P at the tip: y(x) = -δ (3 L x² - x³) / 2 L³."""
    path = reference_path(scene)
    (line,) = path.lines
    assert path.course[0] == 0.0
    assert path.course[-1] == pytest.approx(DISTANCE)
    for so_far, points in zip(path.course, line, strict=True):
        x, y = points.T
        assert x[-1] == pytest.approx(LENGTH, rel=1e-9)
        np.testing.assert_allclose(y, -so_far * (3 * LENGTH * x**2 - x**3) / (2 * LENGTH**3), atol=1e-6 * LENGTH)


def test_what_was_kept_is_the_same(scene: Scene) -> None:
    first, again = reference_path(scene), reference_path(scene)
    np.testing.assert_array_equal(first.course, again.course)
    np.testing.assert_array_equal(first.lines[0], again.lines[0])


def test_a_way_counts_there_and_back() -> None:
    np.testing.assert_allclose(way(np.array([0.0, 1.0, -1.0, 0.5])), [0.0, 1.0, 3.0, 4.5])


def test_the_shape_keeps_pace_with_the_run(scene: Scene) -> None:
    """A run that starts after a second, and is at half the distance at 3 s of 5, has the reference there, too."""
    push = (np.array([0.0, 1.0, 5.0]), np.array([0.0, 0.0, DISTANCE]))
    shape = shape_for_replay(scene, push, Console(), lambda share: None)
    assert shape
    assert shape.time is not None
    tip = [line[-1, 1] for line in shape.lines[0]]
    assert np.interp(3.0, shape.time, tip) == pytest.approx(-DISTANCE / 2, rel=1e-6)
    assert np.interp(5.0, shape.time, tip) == pytest.approx(-DISTANCE, rel=1e-6)


def test_a_scene_that_nothing_moves_has_none() -> None:
    still = parse_scene(
        """
        title = "still"
        [nodes.root]
        at = [0, 0]
        support = "clamped"
        [nodes.tip]
        at = [1, 0]
        [members.beam]
        from = "root"
        to = "tip"
        section = "rectangle 50x100 mm"
        material = "S235"
        [simulation]
        duration = "1 s"
        """,
        "test",
    )
    with pytest.raises(InputError):
        reference_path(still)
    messages = Console(record=True)
    assert shape_for_replay(still, None, messages, lambda share: None) is None
    assert "without the reference's shape" in messages.export_text()


def test_a_stocky_member_is_shown_by_the_outline_of_its_continuum() -> None:
    """Held along x at the left, its right end pushed down by the way so far."""
    scene = load_scene("short-cantilever")
    shape = shape_for_replay(scene, None, Console(), lambda share: None)
    assert shape
    assert shape.label == "reference (plane stress)"
    (outline,) = shape.lines
    assert shape.time is not None
    first, last = outline[0], outline[-1]
    np.testing.assert_allclose([first.min(axis=0), first.max(axis=0)], [[0.0, -0.05], [0.2, 0.05]], atol=1e-12)
    assert shapely.Polygon(first).area == pytest.approx(0.2 * 0.1)
    assert shapely.Polygon(last).is_valid
    left, right = (np.abs(first[:, 0] - x) < 1e-9 for x in (0.0, 0.2))
    moved = last - first
    np.testing.assert_allclose(moved[left][:, 0], 0.0, atol=1e-12)
    np.testing.assert_allclose(moved[right][:, 1], -shape.time[-1], rtol=1e-9)


def test_ideal_hinges_are_called_so() -> None:
    text = builtin_text("fixed-beam").replace("gravity =", 'yielding = "ideal-hinges"\ngravity =')
    shape = shape_for_replay(parse_scene(text, "test"), None, Console(), lambda share: None)
    assert shape
    assert shape.label == "reference (ideal hinges)"
    assert min(line[-1, :, 1].min() for line in shape.lines) == pytest.approx(-0.06, rel=1e-3)
