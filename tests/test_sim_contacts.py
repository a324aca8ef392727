"""Contacts of a structure's bodies, solved through the structure."""

import itertools
import math
import random

import numpy as np
import pymunk
import pytest
from hard_cases import chain, law, momenta

from capacity import capacity, parse_material, parse_section
from sim import DuctileJoint, ElasticPlastic, Limits, Structure

STEEL = parse_material("fy=235 MPa, E=200 GPa, rho=7800 kg/m^3")
SECTION = parse_section("rectangle 100x100 mm")
LENGTH, DEPTH = 2.0, 0.1


def beam(
    space: pymunk.Space, pieces: int, clamped: bool = True, x: float = 0.0, y: float = 0.0
) -> tuple[list[pymunk.Body], Structure]:
    """A steel beam 2 m long of equal pieces with shapes, clamped at its left end or free."""
    c, piece = capacity(SECTION, STEEL), LENGTH / pieces
    group = len(space.shapes) + 1
    bodies: list[pymunk.Body] = []
    for i in range(pieces):
        mass = STEEL.density * SECTION.area * piece
        body = pymunk.Body(mass, mass * piece**2 / 12)
        body.position = (x + (i + 0.5) * piece, y)
        shape = pymunk.Poly.create_box(body, (piece, DEPTH))
        shape.filter, shape.friction = pymunk.ShapeFilter(group=group), 0.5
        space.add(body, shape)
        bodies.append(body)
    ends = [space.static_body, *bodies] if clamped else bodies
    joints = []
    for a, b in itertools.pairwise(ends):
        share = 0.5 * piece if a is space.static_body else piece
        law = ElasticPlastic((c.EA / share, c.GA_s / share, c.EI / share), (c.N_max, c.Q_max, c.M_max))
        at = b.local_to_world((-0.5 * piece, 0.0))
        joints.append(DuctileJoint(a, b, at, law, direction=0.0))
    structure = Structure(joints)
    space.add(*joints)
    return bodies, structure


def world() -> pymunk.Space:
    space = pymunk.Space()
    space.gravity, space.iterations, space.collision_slop = (0.0, -9.81), 2, 1e-4
    return space


@pytest.mark.parametrize("iterations", [2, 10])
@pytest.mark.parametrize(("pieces", "dt"), [(10, 1 / 60), (10, 1 / 240), (50, 1 / 60)])
def test_a_heavy_box_on_light_pieces_bends_the_beam_as_statics_says(pieces: int, dt: float, iterations: int) -> None:
    """1000 kg on pieces of 3 to 16 kg: P a² (3L - a) / 6EI + q L⁴ / 8EI, within 1 + 1/n² of the pieces and 0.5 %."""
    space = world()
    space.iterations = iterations
    bodies, structure = beam(space, pieces)
    box = pymunk.Body(1000.0, 1000.0 * 0.2**2 / 6)
    box.position = (LENGTH - 0.3, DEPTH / 2 + 0.105)
    shape = pymunk.Poly.create_box(box, (0.2, 0.2))
    shape.friction = 0.5
    space.add(box, shape)
    # The shorter the steps, the longer it swings.
    for _ in range(300 if dt > 0.01 else 2400):
        space.step(dt)
    # It falls 5 mm, and lies where that has thrown it.
    ei, a = capacity(SECTION, STEEL).EI, box.position.x
    weight, own = 1000.0 * 9.81, STEEL.density * SECTION.area * 9.81
    exact = weight * a**2 * (3 * LENGTH - a) / (6 * ei) + own * LENGTH**4 / (8 * ei)
    tip = bodies[-1].local_to_world((LENGTH / pieces / 2, 0.0)).y
    assert -tip == pytest.approx(exact * (1.0 + 1.0 / pieces**2), rel=5e-3)
    assert abs(box.velocity) < 1e-3
    assert structure.unconverged == 0


def dropped_box(dt: float, slop: float) -> float:
    """Plastic work in a beam of ten pieces on which 1000 kg fall from 1 m [J]."""
    space = world()
    space.collision_slop = slop
    _, structure = beam(space, 10)
    box = pymunk.Body(1000.0, 1000.0 * 0.2**2 / 6)
    box.position = (LENGTH - 0.3, 0.5 * DEPTH + 1.0 + 0.1)
    shape = pymunk.Poly.create_box(box, (0.2, 0.2))
    shape.friction = 1.0
    space.add(box, shape)
    for _ in range(round(1.5 / dt)):
        space.step(dt)
    return structure.energy.plastic


@pytest.mark.parametrize("dt", [1 / 240, 1 / 1000])
def test_a_falling_box_is_stopped_where_it_touches_whatever_overlap_is_allowed(dt: float) -> None:
    """Chipmunk allows 0.1 m by default; what the box brings must not be lost on the way through it."""
    strict = dropped_box(dt, 1e-4)
    assert strict > 0.9 * 1000.0 * 9.81 * 1.0
    assert dropped_box(dt, 0.1) == pytest.approx(strict, rel=0.05)


@pytest.mark.parametrize("speed", [15.0, 30.0])
def test_a_ball_that_breaks_a_post_keeps_the_same_speed_at_any_step(speed: float) -> None:
    """Post 0.1 × 3 m, 36 kg, N = Q = 210.4 kN, M = 15.1 kN m, breaking at 0.2 rad, hit by 200 kg.

    Solved joint by joint, the ball's speed after 30 m/s is known to run from 15.5 to 25.7 m/s with the step.
    """
    kept = []
    for dt in (1 / 60, 1 / 240, 1 / 1000, 1 / 4000):
        space = pymunk.Space()
        space.collision_slop = 1e-3
        post = pymunk.Body(36.0, 36.0 * (3.0**2 + 0.1**2) / 12)
        post.position = (0.0, 1.6)
        shape = pymunk.Poly.create_box(post, (0.1, 3.0))
        rhs = capacity(parse_section("RHS 100x100x4 mm"), parse_material("fy=275 MPa"))
        law = ElasticPlastic((rhs.EA / 0.1, rhs.GA_s / 0.1, rhs.EI / 0.1), (210.4e3, 210.4e3, 15.1e3))
        limits = Limits(elongation=0.1, slip=0.1, rotation=0.2)
        joint = DuctileJoint(space.static_body, post, (0.0, 0.1), law, direction=math.pi / 2, limits=limits)
        ball = pymunk.Body(200.0, 0.5 * 200.0 * 0.5**2)
        ball.position, ball.velocity = (-0.57, 1.5), (speed, 0.0)
        space.add(post, shape, joint, ball, pymunk.Circle(ball, 0.5))
        for _ in range(round(0.35 / dt)):
            space.step(dt)
        assert joint.broken
        kept.append(ball.velocity.x)
    assert max(kept) / min(kept) <= 1.05
    # Momentum about the foot, then the work of M over the rotation limit (slip and friction left out): 22.5 m/s.
    inertia = 36.0 * 3.0**2 / 3 + 200.0 * 1.4**2
    together = 200.0 * speed * 1.4 / inertia
    free = math.sqrt(together**2 - 2.0 * 15.1e3 * 0.2 / inertia) * 1.4
    assert kept[-1] == pytest.approx(free, rel=0.1)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_a_beam_falls_on_the_ground_and_rests(dt: float) -> None:
    """Energy never rises above the start's, with velocities half a step before and after multiplied (leapfrog).

    Taking out the overlap of the landing lifts the beam again, as Chipmunk does with any body.
    """
    space = world()
    ground = pymunk.Segment(space.static_body, (-10.0, -1.0), (10.0, -1.0), 0.5)
    ground.friction = 0.5
    space.add(ground)
    bodies, structure = beam(space, 8, clamped=False, x=-1.0)
    before = [(body.velocity, body.angular_velocity) for body in bodies]
    for _ in range(round(3.0 / dt)):
        space.step(dt)
        now = float((structure.elastic_energy + structure.dissipated).sum())
        for body, (v, w) in zip(bodies, before, strict=True):
            now += 0.5 * (body.mass * body.velocity.dot(v) + body.moment * body.angular_velocity * w)
            now += 9.81 * body.mass * body.position.y
        assert now <= 1e-3
        before = [(body.velocity, body.angular_velocity) for body in bodies]
    assert max(abs(body.velocity) for body in bodies) < 1e-3
    assert all(body.position.y == pytest.approx(-0.45, abs=2e-3) for body in bodies)


@pytest.mark.parametrize("iterations", [1, 2])
def test_two_structures_rest_on_each_other(iterations: int) -> None:
    """A free beam lies across the tip of a clamped one and on the ground; nothing moves in the end."""
    space = world()
    space.iterations = iterations
    _, lower = beam(space, 6)
    bodies, upper = beam(space, 6, clamped=False, x=0.2, y=0.11)
    for _ in range(300):
        space.step(1 / 60)
    assert max(abs(body.velocity) for body in bodies) < 1e-6
    root = lower.force[0, 2]
    weight = STEEL.density * SECTION.area * 9.81
    # Both own weights act on the lower beam's root: its own at 1 m, and the upper one's at about 1.2 m.
    assert root == pytest.approx(-weight * LENGTH * (1.0 + 1.2), rel=1e-3)
    assert upper.unconverged == lower.unconverged == 0


@pytest.mark.parametrize("ratio", [1e-3, 1.0, 30.0])
def test_a_structure_heavier_or_lighter_than_the_one_it_rests_on(ratio: float) -> None:
    """Two boxes joined to each other on a beam of ten pieces of 16 kg: P a and the own weight at the root."""
    space = world()
    _, lower = beam(space, 10)
    boxes = []
    for x in (1.55, 1.75):
        mass = ratio * 15.6
        box = pymunk.Body(mass, mass * 0.2**2 / 6)
        box.position = (x, DEPTH / 2 + 0.11)
        shape = pymunk.Poly.create_box(box, (0.2, 0.2))
        shape.friction, shape.filter = 0.5, pymunk.ShapeFilter(group=99)
        space.add(box, shape)
        boxes.append(box)
    law = ElasticPlastic((1e9, 1e9, 1e8), (1e9, 1e9, 1e9))
    space.add(DuctileJoint(*boxes, (1.65, DEPTH / 2 + 0.11), law, direction=0.0))
    for _ in range(300):
        space.step(1 / 60)
    weight, own = ratio * 31.2 * 9.81, STEEL.density * SECTION.area * LENGTH * 9.81
    # They fall 10 mm, and lie where that has thrown them.
    middle = 0.5 * sum(box.position.x for box in boxes)
    assert lower.force[0, 2] == pytest.approx(-(weight * middle + own * LENGTH / 2), rel=1e-3)
    assert lower.unconverged == 0


def test_restitution_and_friction_are_those_of_the_shapes() -> None:
    """A ball dropped on a stiff plank bounces with e; a box given a push stops after v² / 2μg."""
    space = world()
    bodies, _ = beam(space, 2)
    for body in bodies:
        for shape in body.shapes:
            shape.elasticity = 1.0
    ball = pymunk.Body(0.01, 1e-6)
    ball.position = (0.5, 1.0)
    bouncy = pymunk.Circle(ball, 0.01)
    bouncy.elasticity = 0.6
    space.add(ball, bouncy)
    highest, fell = 0.0, False
    for _ in range(2000):
        space.step(1 / 2000)
        fell |= ball.velocity.y > 0.1
        if fell:
            highest = max(highest, ball.position.y - 0.06)
    assert highest == pytest.approx(0.6**2 * 0.94, rel=0.05)

    space = world()
    bodies, _ = beam(space, 4)
    box = pymunk.Body(1.0, 1e3)
    box.position, box.velocity = (0.3, DEPTH / 2 + 0.05), (1.5, 0.0)
    shape = pymunk.Poly.create_box(box, (0.1, 0.1))
    shape.friction = 0.6
    space.add(box, shape)
    for _ in range(1000):
        space.step(1 / 1000)
    assert box.position.x - 0.3 == pytest.approx(1.5**2 / (2 * 0.3 * 9.81), rel=0.05)
    assert abs(box.velocity.x) < 1e-3


@pytest.mark.parametrize("rate", [60, 240])
def test_a_wheel_lies_as_deep_on_a_beam_however_fast_it_turns(rate: int) -> None:
    """What turns about the middle of its rounding is not parted from what it touches, and keeps no overlap for that."""

    def sunk(turning: float) -> float:
        space = world()
        space.collision_slop = 5e-3
        bodies, _ = beam(space, 8)
        wheel = pymunk.Body(5.0, 0.5 * 5.0 * 0.25**2)
        wheel.position, wheel.angular_velocity = (1.9, 0.25 + 0.5 * DEPTH + 1e-3), turning
        space.add(wheel, pymunk.Circle(wheel, 0.25))
        for _ in range(60):
            space.step(1 / rate)
        return float(0.25 + 0.5 * DEPTH - bodies[-1].world_to_local(wheel.position).y)

    at_rest = sunk(0.0)
    assert 0.0 < at_rest < 2e-4
    assert sunk(80.0) == pytest.approx(at_rest, abs=1e-6)


def test_momentum_is_kept_in_a_collision_with_a_free_structure() -> None:
    space = pymunk.Space()
    space.collision_slop = 1e-4
    bodies, structure = beam(space, 6, clamped=False)
    ball = pymunk.Body(5.0, 5.0 * 0.05**2 / 2)
    ball.position, ball.velocity = (0.4, 0.4), (0.0, -20.0)
    space.add(ball, pymunk.Circle(ball, 0.05))
    everything = [*bodies, ball]

    before, _ = momenta(everything)
    for _ in range(60):
        space.step(1 / 240)
    assert ball.velocity.y > -19.0
    after, _ = momenta(everything)
    np.testing.assert_allclose(after[:2], before[:2], atol=1e-9)
    # Contact points of the two bodies lie an overlap apart, as in Chipmunk itself.
    assert after[2] == pytest.approx(before[2], abs=0.02 * abs(before[2]))
    assert structure.unconverged == 0


def volley(seed: int) -> pymunk.Space:
    """Five boxes and balls that fly at a free bar."""
    draw = random.Random(seed)
    space = chain(12, law(strength=10 ** draw.uniform(-3.0, 0.0)), clamped=False, gravity=0.0, shapes=True).space
    for k in range(5):
        mass = 10 ** draw.uniform(-1.0, 3.0)
        body = pymunk.Body(mass, 0.002 * mass)
        body.position = (draw.uniform(0.0, 0.5), 0.3 + 0.16 * k)
        body.velocity = (draw.uniform(-5.0, 5.0), -(10 ** draw.uniform(-1.0, 1.5)))
        shape = pymunk.Circle(body, 0.08) if k % 2 else pymunk.Poly.create_box(body, (0.15, 0.15))
        shape.elasticity, shape.friction = draw.choice([0.0, 0.5]), draw.random()
        space.add(body, shape)
    return space


@pytest.mark.parametrize("rate", [60, 240])
@pytest.mark.parametrize("seed", [11, 24, 34, 47, 78, 81, 120])
def test_bodies_that_collide_while_a_blow_is_on_keep_momentum_and_create_no_energy(seed: int, rate: int) -> None:
    """Volleys, in steps that are taken in parts; each body may touch others, too."""
    space = volley(seed)
    begun, size = momenta(space.bodies)
    energy = sum(body.kinetic_energy for body in space.bodies)
    for _ in range(rate // 4):
        space.step(1.0 / rate)
        assert abs(momenta(space.bodies)[0] - begun)[:2].max() < 1e-11 * size
        assert sum(body.kinetic_energy for body in space.bodies) <= (1.0 + 1e-9) * energy


@pytest.mark.parametrize("rate", [60, 240])
@pytest.mark.parametrize("seed", [11, 34, 47, 78, 81, 120])
def test_structures_and_what_strikes_them_keep_angular_momentum(seed: int, rate: int) -> None:
    """In each step, as bodies are shown.

    Among loose bodies friction and overlap are pymunk's, and taking out overlap moves bodies without momentum.
    """
    space = volley(seed)
    for shape in space.shapes:
        if not shape.body.constraints:
            shape.filter = pymunk.ShapeFilter(categories=2, mask=pymunk.ShapeFilter.ALL_MASKS() ^ 2)
    space.collision_bias = 1.0
    now, size = momenta(space.bodies)
    for _ in range(rate // 4):
        space.step(1.0 / rate)
        before, now = now, momenta(space.bodies)[0]
        assert abs(now - before).max() < 1e-14 * size
