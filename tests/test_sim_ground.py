"""The ground is solid under its line, at its corners, too; what falls on it stays on it."""

import itertools
import math

import numpy as np
import pymunk
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from whole_runs import whole_run

from scene import Ground, builtin_names, load_scene
from sim.ground import blocks
from sim.outlines import outlines_of

LINES = st.lists(st.tuples(st.floats(0.05, 4.0), st.floats(-3.0, 3.0)), min_size=2, max_size=8)


def below(points: list[tuple[float, float]]) -> shapely.Polygon:
    """All that is under a line which is drawn from left to right, and goes on straight at both ends."""
    ends = [points[1], points[0]], points[-2:]
    first, last = ((b[0] + 50.0 * (b[0] - a[0]), b[1] + 50.0 * (b[1] - a[1])) for a, b in ends)
    deep = min(y for _, y in (first, *points, last)) - 20.0
    return shapely.Polygon([first, *points, last, (last[0], deep), (first[0], deep)])


def bent(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    return abs((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])) > 1e-9 * math.dist(a, b) * math.dist(b, c)


@given(LINES)
def test_blocks_fill_the_ground_under_their_line_and_nothing_else(steps: list[tuple[float, float]]) -> None:
    """Down to the thickness, or to half of what there is: a point a hair under the line is in a block."""
    points = [(x, y) for x, (_, y) in zip(np.cumsum([dx for dx, _ in steps]).tolist(), steps, strict=True)]
    found = [shapely.Polygon(corners) for corners in blocks(Ground(tuple(points), thickness=1.0))]
    solid = below(points).buffer(1e-9)
    bends = [
        points[0],
        *(b for a, b, c in zip(points, points[1:], points[2:], strict=False) if bent(a, b, c)),
        points[-1],
    ]
    for (a, b), block in zip(itertools.pairwise(bends), found, strict=True):
        assert block.area > 0.0
        assert shapely.difference(block, solid).area < 1e-6
        assert shapely.distance(shapely.LineString([a, b]), block.boundary) < 1e-12
        middle = shapely.Point(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) - 1e-5)
        assert block.distance(middle) < 1e-6
    for one, other in itertools.pairwise(found):
        assert shapely.intersection(one, other).area < 1e-6


def test_a_wall_is_as_thick_as_it_is_drawn() -> None:
    wall = [(0.0, 0.0), (2.0, 0.0), (2.0, 3.0), (2.3, 3.0), (2.3, 0.0), (5.0, 0.0)]
    drawn = below([(x + 1e-9 * i, y) for i, (x, y) in enumerate(wall)]).buffer(1e-6)
    for corners in blocks(Ground(tuple(wall))):
        assert shapely.difference(shapely.Polygon(corners), drawn).area < 1e-6


def test_a_line_drawn_to_the_left_has_its_ground_below_it_too() -> None:
    line = ((0.0, 1.0), (2.0, 1.5), (5.0, 0.0))
    assert blocks(Ground(line)) == blocks(Ground(line[::-1]))


def test_a_pit_is_solid_all_round() -> None:
    """Down its left wall, along its floor and up again: what is outside of it is ground."""
    pit = ((-1.0, 2.0), (-1.0, 0.0), (1.0, 0.0), (1.0, 2.0))
    left, floor, right = (shapely.Polygon(corners).bounds for corners in blocks(Ground(pit, thickness=0.5)))
    assert left == pytest.approx((-1.5, -0.5, -1.0, 2.0))
    assert floor == pytest.approx((-1.5, -0.5, 1.5, 0.0))
    assert right == pytest.approx((1.0, -0.5, 1.5, 2.0))


def test_a_box_slides_over_points_in_a_straight_line() -> None:
    """Without friction it keeps its speed; blocks with a seam at each point would stop it."""
    line = tuple((0.5 * k, 0.0) for k in range(-18, 41))
    assert len(blocks(Ground(line))) == 1
    space = pymunk.Space()
    space.gravity, space.collision_slop = (0.0, -10.0), 1e-3
    for corners in blocks(Ground(line)):
        space.add(pymunk.Poly(space.static_body, corners))
    box = pymunk.Body(10.0, 0.1)
    box.position, box.velocity = (-4.0, 0.1), (3.0, 0.0)
    space.add(box, pymunk.Poly.create_box(box, (0.4, 0.2)))
    for _ in range(180):
        space.step(1.0 / 60.0)
    assert box.position.x == pytest.approx(5.0, abs=1e-3)


def surface(points: np.ndarray, x: float, beside: float) -> float:
    """Height of the ground at ``x``, the lower one ``beside`` a wall; nothing beyond the line's ends [m]."""
    if not points[0, 0] < x < points[-1, 0]:
        return -math.inf
    return float(np.interp([x - beside, x + beside], points[:, 0], points[:, 1]).min())


def lowest(body: pymunk.Body) -> list[tuple[float, float]]:
    """Corners of a body, and lowest points of its circles."""
    corners = []
    for shape in body.shapes:
        if isinstance(shape, pymunk.Circle):
            corners.append(body.local_to_world(shape.offset) - (0.0, shape.radius))
        else:
            assert isinstance(shape, pymunk.Poly)
            corners += map(body.local_to_world, shape.get_vertices())
    return [(x, y) for x, y in corners]


@pytest.mark.parametrize("name", [name for name in builtin_names() if load_scene(name).grounds])
def test_nothing_falls_through_the_ground_at_60_hz(name: str) -> None:
    """No body's middle is under it, but for half of a step's way; in the end no corner is, but of what stands in it."""
    world, course = whole_run(name)
    points, slop = np.array(world.scene.grounds[0].points, dtype=float), world.space.collision_slop
    for x, y, speed in np.concatenate(course).tolist():
        assert y > surface(points, x, slop) - 0.5 * speed * world.dt - slop
    feet = {
        body for joint in world.labels for body in (joint.a, joint.b) if world.space.static_body in (joint.a, joint.b)
    }
    for body in set(world.space.bodies) - feet:
        for x, y in lowest(body):
            assert y > surface(points, x, 4.0 * slop) - 2.0 * slop


@pytest.mark.parametrize("speed", [20.0, 50.0])
def test_a_fast_body_stops_on_ground_twice_as_thick_as_its_way_in_a_step(speed: float) -> None:
    """A plate of 10 mm, nearer to the surface than to the underside wherever it is found."""
    space = pymunk.Space()
    space.collision_slop = 1e-3
    for corners in blocks(Ground(((-9.0, 0.0), (9.0, 0.0)), thickness=2.0 * speed / 60.0 + 0.02)):
        space.add(pymunk.Poly(space.static_body, corners))
    plate = pymunk.Body(1.0, 0.1)
    plate.position, plate.velocity = (0.0, 2.0), (0.0, -speed)
    space.add(plate, pymunk.Poly.create_box(plate, (1.0, 0.01)))
    for _ in range(240):
        space.step(1.0 / 60.0)
    assert plate.position.y == pytest.approx(0.005, abs=0.01)


def test_ground_is_recorded_without_its_seams() -> None:
    """One outline around all blocks; those around a closed pit stay, for an outline has no holes."""
    hill = ((-5.0, 0.0), (0.0, 1.0), (5.0, 0.0), (9.0, 0.0))
    pit = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 0.0))
    for line, count in ((hill, 1), (pit, 4)):
        space = pymunk.Space()
        for corners in blocks(Ground(line)):
            space.add(pymunk.Poly(space.static_body, corners))
        found = [shapely.Polygon(outline.points) for outline in outlines_of(space.static_body)]
        assert len(found) == count
        area = sum(shapely.Polygon(corners).area for corners in blocks(Ground(line)))
        assert sum(outline.area for outline in found) == pytest.approx(area, rel=1e-5)
