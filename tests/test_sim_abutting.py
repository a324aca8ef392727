"""Bodies that touch where they are joined, as corners of bricks do, do not collide."""

import pymunk
import pytest
from bodies import piece

from sim import DuctileJoint, ElasticPlastic, Limits
from sim.abutting import abutting_pairs

WIDE, HIGH = 0.5, 0.25
MORTAR = ElasticPlastic((2e8, 8e7, 4e6), (2e4, 2e4, 1.5e3))
Bricks = dict[tuple[int, int], pymunk.Body]


def wall(space: pymunk.Space, wide: int, high: int, gap: float = 0.0) -> tuple[Bricks, list[DuctileJoint]]:
    """Bricks by column and row, ``gap`` apart, and the joints between neighbours, the lowest row's to the ground."""
    bricks, joints = {}, []
    for i in range(wide):
        for j in range(high):
            body = piece(
                space, 50.0, 50.0 * (WIDE**2 + HIGH**2) / 12, (i + 0.5) * (WIDE + gap), (j + 0.5) * (HIGH + gap)
            )
            space.add(pymunk.Poly.create_box(body, (WIDE, HIGH)))
            bricks[i, j] = body
    for (i, j), body in bricks.items():
        beside = [bricks[at] for at in ((i + 1, j), (i, j + 1)) if at in bricks]
        if j == 0:
            beside.append(space.static_body)
        for other in beside:
            here = body.position
            at = (
                here.interpolate_to(other.position, 0.5) if other is not space.static_body else here - (0.0, 0.5 * HIGH)
            )
            joints.append(
                DuctileJoint(body, other, at, MORTAR, limits=Limits(rotation=0.05, slip=0.02, elongation=0.02))
            )
    space.add(*joints)
    return bricks, joints


def pairs(bricks: Bricks, joints: list[DuctileJoint]) -> set[frozenset[tuple[int, int]]]:
    bodies, names = list(bricks.values()), list(bricks)
    found = (divmod(int(key), len(bodies)) for key in abutting_pairs(joints, bodies))
    return {frozenset((names[i], names[j])) for i, j in found}


def test_corners_of_bricks_are_found_wherever_the_bricks_are_by_now() -> None:
    space = pymunk.Space()
    bricks, joints = wall(space, 3, 2)
    diagonals = {frozenset(((i, 0), (i + 1, 1))) for i in range(2)} | {
        frozenset(((i, 1), (i + 1, 0))) for i in range(2)
    }
    assert pairs(bricks, joints) == diagonals
    for body in bricks.values():
        body.position, body.angle = (3.0 * body.position.x, 1.0), 0.3
    assert pairs(bricks, joints) == diagonals


def test_a_corner_collides_once_no_brick_joins_it_any_more() -> None:
    space = pymunk.Space()
    bricks, joints = wall(space, 2, 2)
    through = [bricks[1, 0], bricks[0, 1]]
    left = [joint for joint in joints if not (bricks[0, 0] in (joint.a, joint.b) and {joint.a, joint.b} & set(through))]
    assert pairs(bricks, left) == {frozenset(((1, 0), (0, 1)))}


def test_what_is_apart_does_collide() -> None:
    space = pymunk.Space()
    bricks, joints = wall(space, 2, 2, gap=0.01)
    assert pairs(bricks, joints) == set()


@pytest.mark.parametrize("speed", [5.0, 10.0])
def test_a_ball_strikes_a_wall_as_if_bricks_could_not_collide(speed: float) -> None:
    """Until the first joint breaks; corner against corner the bricks stop each other and take next to nothing."""

    def taken(filtered: bool) -> tuple[float, int]:
        space = pymunk.Space()
        space.collision_slop = 1e-3
        _, joints = wall(space, 4, 4)
        for shape in space.shapes:
            shape.filter = pymunk.ShapeFilter(group=1 if filtered else 0)
        ball = piece(space, 50.0, 2.0, -1.0, 0.7)
        ball.velocity = (speed, 0.0)
        space.add(pymunk.Circle(ball, 0.3))
        before = (0.0, 0)
        for _ in range(20):
            space.step(1 / 60)
            if any(joint.broken for joint in joints):
                break
            before = sum(joint.dissipated for joint in joints), before[1] + 1
        return before

    work, steps = taken(filtered=False)
    assert (work, steps) == taken(filtered=True)
    assert work > 50.0


def test_bricks_that_have_broken_off_lie_on_those_below() -> None:
    space = pymunk.Space()
    space.gravity, space.collision_slop = (0.0, -9.81), 1e-3
    bricks, joints = wall(space, 2, 3)
    space.remove(*(joint for joint in joints if {joint.a, joint.b} & {bricks[0, 2], bricks[1, 2]}))
    for _ in range(60):
        space.step(1 / 60)
    for i in range(2):
        assert bricks[i, 2].position.y == pytest.approx(2.5 * HIGH, abs=2e-3)
