"""Members and frames from a scene as bodies with shapes: mass, depth, and which of them touch."""

import math

import pymunk
import pytest
from frames import frame_scene, portal

import sim
from sim import Limits, Model

STAY = "[motion]\nduration = 1.0\nvelocity = [0.0, -1.0]"
MODEL = Model("lobatto", 5, "elastic-plastic")
NODES = {"A": (0.0, 0.0, "clamped"), "B": (0.0, 4.0, "free"), "C": (3.0, 4.0, "free"), "D": (3.0, 0.0, "clamped")}


def two_columns(space: pymunk.Space | None = None, **options: object) -> sim.Assembly:
    """A portal of IPE 300 that bears nothing."""
    scene = frame_scene(NODES, [("A", "B"), ("B", "C"), ("C", "D")], STAY)
    return sim.assemble(scene, MODEL, space, **options)  # type: ignore[arg-type]


def ball(
    space: pymunk.Space, at: tuple[float, float], velocity: tuple[float, float], mass: float = 50.0
) -> pymunk.Body:
    body = pymunk.Body(mass, 0.4 * mass * 0.2**2)
    body.position, body.velocity = at, velocity
    space.add(body, pymunk.Circle(body, 0.2))
    return body


def test_masses_and_shapes_are_those_of_the_members() -> None:
    assembly = two_columns()
    bodies = [body for body in assembly.space.bodies if body.body_type == pymunk.Body.DYNAMIC]
    total = 7850.0 * 0.00518806 * 11.0  # IPE 300 without root radius, 11 m of it
    assert sum(body.mass for body in bodies) == pytest.approx(total, rel=1e-9)
    areas = sum(shape.area for body in bodies for shape in body.shapes)
    assert areas == pytest.approx(0.3 * 11.0, rel=1e-9)
    column = next(piece for piece in assembly.pieces if piece.member == "A-B")
    box = next(iter(column.body.shapes)).cache_bb()
    assert (box.left, box.right, box.bottom) == pytest.approx((-0.15, 0.15, 0.0), abs=1e-9)


def test_pieces_that_a_joint_holds_together_do_not_touch_at_rest_or_bent() -> None:
    """Corners overlap by half a depth and hinges by more as they turn: energy and forces know nothing of it."""
    free, shaped = two_columns(shapes=False), two_columns()
    for assembly in (free, shaped):
        assembly.space.gravity = (1000.0, -9.81)  # far beyond what the columns bear sideways
        for _ in range(28):
            assembly.space.step(1 / 240)
    for a, b in zip(free.pieces, shaped.pieces, strict=True):
        assert a.body.position.get_distance(b.body.position) < 1e-9
    assert abs(free.pieces[0].body.angle - math.pi / 2) > 0.5


def test_a_ball_is_stopped_by_a_column_and_gives_its_momentum_to_it() -> None:
    assembly = two_columns()
    striker = ball(assembly.space, (-0.5, 2.0), (10.0, 0.0))
    before = striker.velocity.x
    least = before
    for _ in range(480):
        assembly.space.step(1 / 240)
        least = min(least, striker.velocity.x)
        assert striker.position.x < -0.2  # 0.35 m of ball and half a column, less what that bends
    assert least < 0.0
    assert assembly.structure.unconverged == 0


def test_parts_far_from_each_other_collide() -> None:
    """A broken beam falls on the floor below it and stays there."""
    nodes = {
        "A": (0.0, 0.0, "clamped"),
        "B": (0.0, 2.0, "clamped"),
        "P": (4.0, 0.0, "clamped"),
        "Q": (3.0, 2.0, "free"),
    }
    scene = frame_scene(nodes, [("A", "P"), ("B", "Q")], STAY)
    assembly = sim.assemble(scene, MODEL, limits={"B-Q": Limits(rotation=0.0, slip=0.0, elongation=0.0)})
    space = assembly.space
    space.gravity = (0.0, -9.81)
    upper = [piece.body for piece in assembly.pieces if piece.member == "B-Q"]
    for body in upper:
        body.velocity = (0.0, -400.0 if body is upper[0] else 0.0)
    for _ in range(900):
        space.step(1 / 240)
    assert any(joint.broken for joint in assembly.joints)
    assert all(0.0 < body.position.y < 0.5 for body in upper[1:])


def test_a_frame_in_a_space_of_ones_own() -> None:
    space = pymunk.Space()
    space.gravity, space.iterations, space.collision_slop = (0.0, -1.0), 7, 1e-3
    assembly = two_columns(space)
    assert assembly.space is space
    assert (space.gravity, space.iterations) == ((0.0, -1.0), 7)
    beam = ball(space, (1.5, 5.0), (0.0, 0.0))
    for _ in range(600):
        space.step(1 / 120)
    assert beam.position.y == pytest.approx(4.35, abs=0.01)


def test_unknown_names_are_refused() -> None:
    scene = portal(4.0, 6.0, 0.2, "C", 0.1)
    with pytest.raises(ValueError, match="there is no rule"):
        sim.assemble(scene, Model("simpson", 5, "fibre"))
    with pytest.raises(ValueError, match="there is no joint law"):
        sim.assemble(scene, Model("lobatto", 5, "rubber"))
