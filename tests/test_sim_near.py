"""Contacts that come, go and turn within a step: what is found of them, and what they must not change."""

import itertools

import numpy as np
import pymunk
import pytest

from sim import DuctileJoint, ElasticPlastic, Structure, SystemLedger
from sim.chipmunk import ARBITER_SHAPE_A, ARBITER_WORDS, address, words
from sim.contact_graph import arbiters_of
from sim.kernels import layout as at

STIFF = ElasticPlastic((1e7, 1e7, 1e4), (1e6, 1e6, 1e4))
SLOP = 1e-4


def bar(space: pymunk.Space, pieces: int = 4, held: bool = True, friction: float = 0.5) -> Structure:
    """A level bar of square pieces of 0.1 m and 8 kg, its top at y = 0.05."""
    bodies = []
    for i in range(pieces):
        body = pymunk.Body(8.0, 8.0 * 0.1**2 / 6.0)
        body.position = (0.1 * i, 0.0)
        shape = pymunk.Poly.create_box(body, (0.1, 0.1))
        shape.filter, shape.friction, shape.elasticity = pymunk.ShapeFilter(group=1), friction, 0.6
        space.add(body, shape)
        bodies.append(body)
    ends = [space.static_body, *bodies] if held else bodies
    joints = [DuctileJoint(a, b, (b.position.x - 0.05, 0.0), STIFF, direction=0.0) for a, b in itertools.pairwise(ends)]
    structure = Structure(joints)
    space.add(*joints)
    return structure


def new_space(slop: float = SLOP) -> pymunk.Space:
    space = pymunk.Space()
    space.collision_slop, space.iterations = slop, 2
    return space


def loose(space: pymunk.Space, kind: str, place: tuple[float, float], velocity: tuple[float, float]) -> pymunk.Shape:
    """A body of 5 kg of about 0.1 m."""
    body = pymunk.Body(5.0, 0.01)
    body.position, body.velocity = place, velocity
    shapes: dict[str, pymunk.Shape] = {
        "circle": pymunk.Circle(body, 0.05, (0.01, 0.0)),
        "segment": pymunk.Segment(body, (-0.06, 0.0), (0.05, 0.01), 0.02),
        "polygon": pymunk.Poly(body, [(-0.05, -0.04), (0.05, -0.05), (0.03, 0.05)]),
        "rounded": pymunk.Poly(body, [(-0.04, -0.03), (0.04, -0.03), (0.0, 0.04)], radius=0.01),
    }
    shape = shapes[kind]
    shape.friction, shape.elasticity, shape.surface_velocity = 0.4, 0.5, (0.7, 0.2)
    space.add(body, shape)
    return shape


@pytest.mark.parametrize("kind", ["circle", "segment", "polygon", "rounded"])
def test_a_contact_is_found_as_chipmunk_finds_it(kind: str) -> None:
    """Where both know it: the same points, normal, friction and surface velocity, to rounding."""
    space = new_space(0.0)
    structure = bar(space)
    shape = loose(space, kind, (0.22, 0.0), (0.0, 0.0))
    shape.body.position = (0.22, 0.0495 - shape.cache_bb().bottom)
    control, settings = structure.tables.control, structure.tables[at.SETTINGS]
    space.step(1e-9)
    count = int(control[at.CONTACTS])
    theirs, places = structure.tables[at.TOUCHES][:count].copy(), structure.tables[at.PLACES][:count].copy()
    assert count >= 1
    # Solved halfway between the two surfaces.
    theirs[:, at.ARM_A : at.ARM_A + 2] -= theirs[:, at.HALF : at.HALF + 2]
    theirs[:, at.ARM_B : at.ARM_B + 2] += theirs[:, at.HALF : at.HALF + 2]
    settings[[at.WHOLE_STEP, at.MARGIN]] = 1e-3, 0.01
    for asked in (at.GATHER, at.LOOK):
        control[at.ASKED] = asked
        if asked == at.LOOK:
            control[at.CONTACTS] += control[at.NEAR]
        structure.told()
    found = structure.tables[at.TOUCHES][count : int(control[at.CONTACTS])]
    bodies = structure.tables[at.PLACES][count : int(control[at.CONTACTS])]
    for touch, place in zip(theirs, places, strict=True):
        flipped = place[at.OWNER_A] == 0
        arms = touch[[*range(4, 6), *range(2, 4)]] if flipped else touch[2:6]
        expected = [
            *(-touch[:2] if flipped else touch[:2]),
            *arms,
            touch[at.FRICTION],
            touch[at.SURFACE],
            touch[at.GAP],
        ]
        own = place[at.BODY_B if flipped else at.BODY_A]
        rows = [row for row, of in zip(found, bodies, strict=True) if of[at.BODY_A] == own and row[at.GAP] < at.FAR]
        columns = [*range(6), at.FRICTION, at.SURFACE, at.GAP]
        assert any(row[columns] == pytest.approx(expected, abs=1e-9) for row in rows)
    control[at.ASKED] = at.DROP
    structure.told()
    control[at.ASKED], control[at.NEAR] = 0, 0


@pytest.mark.parametrize("side", [0.0, 0.1 - 1e-9, 0.35])
def test_a_ball_right_above_a_corner_is_stopped_by_it(side: float) -> None:
    """Above the end of the bar, between two pieces, and above one; Chipmunk takes the first for a touch of the end."""
    space = new_space()
    structure = bar(space)
    ball = pymunk.Body(5.0, 0.01)
    ball.position, ball.velocity = (side - 0.05, 0.05 + 0.05 + 0.3 * 4.0 / 60.0), (0.0, -4.0)
    space.add(ball, pymunk.Circle(ball, 0.05))
    for _ in range(3):
        space.step(1 / 60)
    assert ball.velocity.y > -2.0
    assert structure.energy.numerical >= 0.0


def test_what_passes_near_a_structure_under_a_blow_goes_on_to_the_last_bit() -> None:
    def fly(near: bool) -> bytes:
        space = new_space()
        space.gravity = (0.3, -9.81)
        structure = bar(space) if near else None
        loose(space, "circle", (0.3, 0.2), (0.0, -8.0))
        passing = loose(space, "polygon", (-0.5, -0.25), (9.0, 1.2)).body
        course, parts = [], 1
        for _ in range(20):
            space.step(1 / 60)
            course.append((*passing.position, passing.angle, *passing.velocity, passing.angular_velocity))
            if structure is not None and structure.tables.control[at.PARTS] > 1:
                parts += 1
        assert near == (parts > 3)
        return np.array(course).tobytes()

    assert fly(near=True) == fly(near=False)


@pytest.mark.parametrize("rate", [60, 240])
def test_what_is_struck_behind_a_bar_within_the_same_step_gets_its_momentum(rate: int) -> None:
    """A ball flies at a free bar, and another lies 2 mm behind it; as at 1/1000 s, momentum and energy kept."""

    def strike(rate: int) -> tuple[float, float]:
        space = new_space()
        structure = bar(space, held=False)
        first = loose(space, "circle", (0.02, 0.13), (0.0, -12.0)).body
        second = loose(space, "circle", (0.14, -0.102), (0.0, 0.0)).body
        ledger, bodies = SystemLedger(space), [*structure.bodies, first, second]
        start = sum((body.mass * body.velocity for body in bodies), pymunk.Vec2d.zero())
        for _ in range(round(0.1 * rate)):
            space.step(1.0 / rate)
            ledger.note()
        end = sum((body.mass * body.velocity for body in bodies), pymunk.Vec2d.zero())
        assert abs(end - start) <= 1e-12 * abs(start)
        energy = ledger.energy
        assert energy.external == pytest.approx(360.0, rel=2e-3)
        assert energy.numerical >= 0.0
        return second.velocity.y, first.velocity.y

    assert strike(rate)[0] == pytest.approx(strike(1000)[0], rel=0.1)


def test_a_handler_that_lets_bodies_pass_is_heeded_within_a_step() -> None:
    """A ghost is asked about by nobody but Chipmunk, and passes."""
    space = new_space()
    bar(space)
    loose(space, "circle", (0.3, 0.2), (0.0, -8.0))
    ghost = loose(space, "circle", (0.1, 0.11), (0.0, -1.0))
    ghost.collision_type = 7

    def pass_through(arbiter: pymunk.Arbiter, *_: object) -> None:
        arbiter.process_collision = False

    space.on_collision(7, None, begin=pass_through)
    for _ in range(20):
        space.step(1 / 60)
    assert ghost.body.velocity == (0.0, -1.0)


def test_nothing_of_a_body_is_held_when_the_step_is_over() -> None:
    space = new_space()
    structure = bar(space)
    shape = loose(space, "circle", (0.3, 0.12), (0.0, -8.0))
    space.step(1 / 60)
    space.step(1 / 60)
    assert structure.tables.control[at.PARTS] > 1
    assert structure.tables.control[at.NEAR] == 0
    touching = [int(words(a, ARBITER_WORDS, np.int64)[ARBITER_SHAPE_A]) for a in arbiters_of(shape.body)]
    assert set(touching) <= {address(one._shape) for one in space.shapes}
    surroundings = structure._surroundings
    assert not surroundings._pairs
    assert not surroundings._copies
