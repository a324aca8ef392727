"""Taking out overlap: what can move as a rigid body does, and strains no joint."""

import itertools

import pymunk
import pytest
import shapely
from bodies import kinetic, piece
from crash_cases import frame
from piles import beam

from sim import DuctileJoint, ElasticPlastic, Structure

SIZE, DEPTH = 0.25, 0.1
# Steel of 100 × 100 mm, of which ten newton metres bend a joint for good.
WEAK = ElasticPlastic((8e9, 3e9, 7e6), (1e4, 1e4, 10.0))


def bar(space: pymunk.Space, x: float, y: float, angle: float = 0.0) -> tuple[list[pymunk.Body], list[DuctileJoint]]:
    """A bar of eight pieces about (x, y) that nothing holds."""
    along, bodies = pymunk.Vec2d(1.0, 0.0).rotated(angle), []
    for i in range(8):
        at = pymunk.Vec2d(x, y) + (i - 3.5) * SIZE * along
        bodies.append(piece(space, 20.0, 20.0 * (SIZE**2 + DEPTH**2) / 12, at.x, at.y, angle))
        space.add(pymunk.Poly.create_box(bodies[-1], (SIZE, DEPTH)))
    joints = [
        DuctileJoint(a, b, a.position.interpolate_to(b.position, 0.5), WEAK) for a, b in itertools.pairwise(bodies)
    ]
    space.add(*joints)
    return bodies, joints


def space_of_little_slop() -> pymunk.Space:
    space = pymunk.Space()
    space.collision_slop = 1e-3
    return space


def overlap(bodies: list[pymunk.Body], others: list[pymunk.Body]) -> float:
    """Area in which shapes of both overlap [m²]."""
    first, second = (
        shapely.union_all(
            [
                shapely.Polygon([body.local_to_world(corner) for corner in shape.get_vertices()])
                for body in group
                for shape in body.shapes
                if isinstance(shape, pymunk.Poly)
            ]
        )
        for group in (bodies, others)
    )
    return float(first.intersection(second).area)


@pytest.mark.parametrize("x", [0.0, 0.9])
def test_a_bar_that_was_put_into_a_block_comes_out_of_it_as_a_rigid_body(x: float) -> None:
    """Under its middle it goes straight up, under its end it turns; it has lost energy in a blow before."""
    space = space_of_little_slop()
    bodies, joints = bar(space, 0.0, 0.0)
    block = pymunk.Poly(space.static_body, [(x - 0.1, -0.5), (x + 0.1, -0.5), (x + 0.1, -0.02), (x - 0.1, -0.02)])
    space.step(1 / 60)
    for body in bodies:
        body.velocity = (0.0, -0.5)
    floor = pymunk.Segment(space.static_body, (-2.0, -0.1), (2.0, -0.1), 0.04)
    space.add(floor)
    for _ in range(30):
        space.step(1 / 60)
    assert joints[0].structure is not None
    before = joints[0].structure.energy
    assert before.contact + before.numerical > 1.0
    space.remove(floor)
    space.add(block)
    assert overlap(bodies, [space.static_body]) > 0.015 * 0.1
    for _ in range(120):
        space.step(1 / 60)
    after = joints[0].structure.energy
    assert overlap(bodies, [space.static_body]) < 2e-3 * 0.2
    assert after.elastic + after.plastic < before.elastic + before.plastic + 1e-3
    assert kinetic(bodies) < 1e-3


def test_a_bar_that_lies_with_an_end_in_another_one_parts_from_it() -> None:
    space = space_of_little_slop()
    (first, one), (second, other) = bar(space, 0.0, 0.0), bar(space, 1.2, 0.36, 0.3)
    bodies = [*first, *second]
    centre = sum((body.position for body in bodies), pymunk.Vec2d.zero())
    assert overlap(first, second) > 1e-3
    for _ in range(120):
        space.step(1 / 60)
    assert overlap(first, second) < 4e-4
    for joint in (one[0], other[0]):
        assert isinstance(joint.structure, Structure)
        assert joint.structure.energy.elastic + joint.structure.energy.plastic < 1e-3
    moved = sum((body.position for body in bodies), pymunk.Vec2d.zero()) - centre
    assert moved.length < 1e-12


@pytest.mark.parametrize("law", ["elastic-plastic", "rigid-plastic", "interaction", "fibre"])
def test_frames_that_meet_take_no_more_energy_than_they_had(law: str) -> None:
    """Corners overlap, and tear; plastic work that is not in the bodies' motion would be energy from nowhere."""
    space = space_of_little_slop()
    pieces, joints = frame(space, -0.3, 8.0, law)
    others, more = frame(space, 2.3, -8.0, law)
    energy = kinetic([*pieces, *others])
    for _ in range(20):
        space.step(1 / 60)
        work = sum(joint.dissipated for joint in [*joints, *more])
        assert work + kinetic([*pieces, *others]) <= energy * (1.0 + 1e-9)


def test_joined_pieces_collide_only_if_they_are_told_to() -> None:
    """Pieces that abut bear compression and bend by their joints alone; contacts would bear a share of it."""

    def sag(shapes: bool, collide: bool) -> float:
        space = space_of_little_slop()
        space.gravity = (0.0, -200.0)
        joints = beam(space, 10)
        middle = joints[5].a
        for shape in list(space.shapes):
            shape.filter = pymunk.ShapeFilter()
            if not shapes:
                space.remove(shape)
        for joint in joints:
            joint.collide_bodies = joint.collide_bodies or collide
        for _ in range(120):
            space.step(1 / 60)
        return -middle.position.y

    expected = sag(shapes=False, collide=False)
    assert sag(shapes=True, collide=False) == expected
    assert sag(shapes=True, collide=True) < 0.97 * expected
