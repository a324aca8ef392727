"""Structures that pymunk's own constraints hold, struck and set going, for `step_sweeps`."""

import itertools
import math

import pymunk
from sudden_cases import new_space

from capacity import Capacity, capacity, parse_material, parse_section
from sim import DuctileJoint, ElasticPlastic, Structure

STEEL = "fy=235 MPa, E=210 GPa"
#: A section's capacity, its mass over length [kg/m] and its height [m].
IPE = capacity(parse_section("IPE 100"), parse_material(STEEL)), 8.1, 0.1
BAR = capacity(parse_section("rectangle 40x40 mm"), parse_material(STEEL)), 12.5, 0.04


def member(
    space: pymunk.Space,
    start: tuple[float, float],
    end: tuple[float, float],
    count: int,
    section: tuple[Capacity, float, float] = IPE,
) -> tuple[list[pymunk.Body], list[DuctileJoint]]:
    """Pieces of a member from one point to another, and the joints between them, which are not added yet."""
    along, (own, weight, height) = pymunk.Vec2d(*end) - start, section
    piece, angle = along.length / count, along.angle
    law = ElasticPlastic((own.EA / piece, own.GA_s / piece, own.EI / piece), (own.N_max, own.Q_max, own.M_max))
    bodies = []
    for i in range(count):
        mass = weight * piece
        body = pymunk.Body(mass, mass * (piece**2 + height**2) / 12.0)
        body.position, body.angle = start + (i + 0.5) / count * along, angle
        shape = pymunk.Poly.create_box(body, (piece, height))
        shape.friction, shape.filter = 0.3, pymunk.ShapeFilter(group=9)
        space.add(body, shape)
        bodies.append(body)
    joints = [
        DuctileJoint(a, b, tuple(0.5 * (a.position + b.position)), law, direction=angle)
        for a, b in itertools.pairwise(bodies)
    ]
    return bodies, joints


def cantilever(space: pymunk.Space) -> tuple[list[pymunk.Body], list[DuctileJoint]]:
    """A metre in six pieces from a wall at the origin on."""
    bodies, joints = member(space, (0.0, 0.0), (1.0, 0.0), 6)
    joints.append(DuctileJoint(space.static_body, bodies[0], (0.0, 0.0), joints[0].law, direction=0.0))
    return bodies, joints


def beam_on_pivots(space: pymunk.Space, speed: float = 0.0) -> tuple[list[pymunk.Body], list[DuctileJoint]]:
    """A beam of 2 m in eight pieces, one end on a pivot of pymunk's and the other in a groove; all move downwards."""
    bodies, joints = member(space, (0.0, 0.0), (2.0, 0.0), 8)
    for body in bodies:
        body.velocity = (0.0, -speed)
    left = pymunk.PivotJoint(space.static_body, bodies[0], (0.0, 0.0))
    right = pymunk.GrooveJoint(space.static_body, bodies[-1], (1.5, 0.0), (2.5, 0.0), (0.125, 0.0))
    space.add(left, right, *joints)
    return bodies, joints


def ball(space: pymunk.Space, mass: float, x: float, y: float) -> pymunk.Body:
    body = pymunk.Body(mass, 0.4 * mass * 0.1**2)
    body.position = (x, y)
    shape = pymunk.Circle(body, 0.1)
    shape.friction = 0.5
    space.add(body, shape)
    return body


def lowest(space: pymunk.Space, body: pymunk.Body, rate: int, seconds: float) -> float:
    """How far down a body goes from now on [m]."""
    start, way = body.position.y, 0.0
    for _ in range(round(seconds * rate)):
        space.step(1.0 / rate)
        way = max(way, start - body.position.y)
    return way


def work(joints: list[DuctileJoint]) -> float:
    return sum(float(joint.dissipated) for joint in joints)


def struck_on_pivots(rate: int, iterations: int) -> tuple[float, float]:
    """Peak deflection [m] and plastic work [J] of a beam on a pivot and a groove that 100 kg fall on by 1 m."""
    space = new_space(iterations)
    bodies, joints = beam_on_pivots(space)
    ball(space, 100.0, 1.1, 0.05 + 0.1 + 1.0)
    return lowest(space, bodies[4], rate, 0.9), work(joints)


def thrown_on_pivots(rate: int, iterations: int) -> tuple[float, float]:
    """The same of one whose pieces are set going at 20 m/s."""
    space = new_space(iterations, 0.0)
    bodies, joints = beam_on_pivots(space, 20.0)
    return lowest(space, bodies[4], rate, 0.1), work(joints)


def gravity_on_pivots(rate: int, iterations: int) -> tuple[float, float]:
    """The same of one with 1500 kg joined to its middle when gravity begins."""
    space = new_space(iterations)
    bodies, joints = beam_on_pivots(space)
    load = pymunk.Body(1500.0, 1500.0 * 0.1**2)
    load.position = (1.0, 0.0)
    rigid = ElasticPlastic((1e9, 1e9, 1e7), (1e9, 1e9, 1e9))
    space.add(load, DuctileJoint(bodies[4], load, (1.0, 0.0), rigid, direction=0.0))
    return lowest(space, bodies[4], rate, 0.3), work(joints)


def portal_on_pivots(rate: int, iterations: int) -> tuple[float, float]:
    """How far a ball of 100 kg at 8 m/s drives the corner of a portal on pivots of pymunk's aside [m], and J."""
    space = new_space(iterations, 0.0)
    parts = [
        member(space, a, b, 6)
        for a, b in (((0.0, 0.0), (0.0, 2.0)), ((0.0, 2.0), (2.0, 2.0)), ((2.0, 0.0), (2.0, 2.0)))
    ]
    (left, one), (beam, two), (right, three) = parts
    law = one[0].law
    corners = [
        DuctileJoint(left[-1], beam[0], (0.0, 2.0), law, direction=0.0),
        DuctileJoint(right[-1], beam[-1], (2.0, 2.0), law, direction=0.0),
    ]
    joints = [*one, *two, *three, *corners]
    feet = [pymunk.PivotJoint(space.static_body, column[0], (x, 0.0)) for column, x in ((left, 0.0), (right, 2.0))]
    space.add(*feet, *joints)
    hit = ball(space, 100.0, -0.05 - 0.1 - 0.3, 1.9)
    hit.velocity = (8.0, 0.0)
    corner, furthest = beam[0], 0.0
    for _ in range(round(0.6 * rate)):
        space.step(1.0 / rate)
        furthest = max(furthest, corner.position.x - 2.0 / 12.0)
    return furthest, work(joints)


def struck_on_spring(rate: int, iterations: int) -> tuple[float, float]:
    """Peak way of the tip [m] and plastic work [J] of a cantilever on a damped spring that 100 kg fall on by 1 m."""
    space = new_space(iterations)
    bodies, joints = cantilever(space)
    tip = bodies[-1]
    spring = pymunk.DampedSpring(space.static_body, tip, (0.9, -1.0), (0.0, 0.0), 1.0, 3e4, 300.0)
    space.add(spring, *joints)
    ball(space, 100.0, 0.9, 0.05 + 0.1 + 1.0)
    return lowest(space, tip, rate, 0.8), work(joints)


def bar_on_springs(rate: int, iterations: int) -> tuple[float, float]:
    """The same of a bar on two damped springs alone, that 50 kg strike at 15 m/s."""
    space = new_space(iterations, 0.0)
    bodies, joints = member(space, (0.0, 0.0), (2.0, 0.0), 8)
    for body, x in ((bodies[0], 0.1), (bodies[-1], 1.9)):
        for dx in (-0.5, 0.5):
            anchor = (x + dx, -1.0)
            arm = (x - body.position.x, 0.0)
            space.add(pymunk.DampedSpring(space.static_body, body, anchor, arm, math.hypot(0.5, 1.0), 2e5, 2e3))
    space.add(*joints)
    ball(space, 50.0, 1.1, 0.05 + 0.1 + 0.3).velocity = (0.0, -15.0)
    return lowest(space, bodies[4], rate, 0.15), work(joints)


def kicked_on_pivot(rate: int, iterations: int) -> tuple[float, float]:
    """A body of 100 kg that a pivot hangs on a cantilever's tip is set going at 5 m/s downwards."""
    space = new_space(iterations)
    bodies, joints = cantilever(space)
    load = pymunk.Body(100.0, 1.0)
    load.position = (1.0, -0.2)
    space.add(load, pymunk.PivotJoint(bodies[-1], load, (1.0, 0.0)), *joints)
    load.velocity = (0.0, -5.0)
    return lowest(space, bodies[-1], rate, 0.3), work(joints)


def caught_by_rope(rate: int, iterations: int) -> tuple[float, float]:
    """100 kg fall by 1 m and are caught by a rope (a slide joint) at a cantilever's tip."""
    space = new_space(iterations)
    bodies, joints = cantilever(space)
    load = pymunk.Body(100.0, 1.0)
    load.position = (bodies[-1].position.x, -0.5)
    space.add(load, pymunk.SlideJoint(bodies[-1], load, (0.0, 0.0), (0.0, 0.0), 0.0, 1.5), *joints)
    return lowest(space, bodies[-1], rate, 0.9), work(joints)


def struck_together(rate: int, iterations: int) -> tuple[float]:
    """Plastic work [J] of two cantilevers whose tips one pivot holds together, on one of which 100 kg fall by 1 m."""
    space = new_space(iterations)
    one, first = member(space, (0.0, 0.0), (1.0, 0.0), 6)
    other, second = member(space, (2.0, 0.0), (1.0, 0.0), 6)
    root = DuctileJoint(space.static_body, one[0], (0.0, 0.0), first[0].law, direction=0.0)
    far = DuctileJoint(space.static_body, other[0], (2.0, 0.0), first[0].law, direction=math.pi)
    space.add(root, *first, far, *second, pymunk.PivotJoint(one[-1], other[-1], (1.0, 0.0)))
    ball(space, 100.0, 0.85, 0.05 + 0.1 + 1.0)
    lowest(space, one[-1], rate, 0.8)
    return (work([root, *first, far, *second]),)


def struck_with_load(rate: int, iterations: int) -> tuple[float, float]:
    """A cantilever from which 50 kg hang on a spring; 50 kg fall on it by 1 m."""
    space = new_space(iterations)
    bodies, joints = cantilever(space)
    load = pymunk.Body(50.0, 1.0)
    load.position = (bodies[-1].position.x, -0.5)
    space.add(load, pymunk.DampedSpring(bodies[-1], load, (0.0, 0.0), (0.0, 0.0), 0.45, 1e4, 200.0), *joints)
    ball(space, 50.0, 0.85, 0.05 + 0.1 + 1.0)
    return lowest(space, bodies[-1], rate, 0.8), work(joints)


def stopped_by_gear(rate: int, iterations: int) -> tuple[float, float]:
    """A bar that is held by a pivot and a gear of pymunk's at its foot, and that 50 kg strike at 8 m/s."""
    space = new_space(iterations, 0.0)
    bodies, joints = member(space, (0.0, 0.0), (1.0, 0.0), 6)
    foot = pymunk.PivotJoint(space.static_body, bodies[0], (0.0, 0.0))
    gear = pymunk.GearJoint(space.static_body, bodies[0], 0.0, 1.0)
    space.add(foot, gear, *joints)
    ball(space, 50.0, 0.85, 0.05 + 0.1 + 0.3).velocity = (0.0, -8.0)
    return lowest(space, bodies[-1], rate, 0.25), work(joints)


def free_with_load(rate: int, iterations: int) -> tuple[float, float]:
    """Way of its end [m] and plastic work [J] of a free bar with 60 kg pivoted to its middle, that 20 kg strike."""
    space, bodies, joints = loaded_bar(iterations)
    return lowest(space, bodies[0], rate, 0.1), work(joints)


def loaded_bar(iterations: int) -> tuple[pymunk.Space, list[pymunk.Body], list[DuctileJoint]]:
    """A free bar with 60 kg on a pivot under its middle, and 20 kg that come down on its end at 20 m/s."""
    space = new_space(iterations, 0.0)
    bodies, joints = member(space, (0.0, 0.0), (2.0, 0.0), 8)
    load = pymunk.Body(60.0, 1.0)
    load.position = (1.0, -0.2)
    space.add(load, pymunk.PivotJoint(bodies[4], load, (1.0, 0.0)), *joints)
    ball(space, 20.0, 0.1, 0.05 + 0.1 + 0.3).velocity = (0.0, -20.0)
    return space, bodies, joints


def dragged(rate: int, iterations: int, drift: float = 0.0) -> tuple[Structure, pymunk.Body]:
    """A bar on a kinematic base that starts at 5 m/s, and moves along with it sideways before, after 0.25 s."""
    space = new_space(iterations, 0.0)
    base = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    base.velocity = (drift, 0.0)
    space.add(base)
    bodies, joints = member(space, (0.0, 0.0), (1.0, 0.0), 6, BAR)
    for body in bodies:
        body.velocity = base.velocity
    joints.append(DuctileJoint(base, bodies[0], (0.0, 0.0), joints[0].law, direction=0.0))
    space.add(*joints)
    for _ in range(rate // 10):
        space.step(1.0 / rate)
    base.velocity = (drift, 5.0)
    for _ in range(rate // 4):
        space.step(1.0 / rate)
    structure = joints[0].structure
    assert structure is not None
    return structure, base


#: What each gives is a deflection [m] and plastic work [J], or the latter alone.
HELD = {
    "beam on a pivot and a groove of pymunk's that 100 kg fall on by 1 m: peak [m], plastic work [J]": struck_on_pivots,
    "the same beam set going at 20 m/s": thrown_on_pivots,
    "the same with 1500 kg joined to it when gravity begins": gravity_on_pivots,
    "portal on two pivots that 100 kg strike at 8 m/s": portal_on_pivots,
    "cantilever on a damped spring that 100 kg fall on by 1 m": struck_on_spring,
    "bar on four damped springs that 50 kg strike at 15 m/s": bar_on_springs,
    "100 kg on a pivot at a cantilever's tip are set going at 5 m/s": kicked_on_pivot,
    "100 kg fall by 1 m into a rope (a slide joint) at its tip": caught_by_rope,
    "two cantilevers on one pivot, 100 kg fall on one by 1 m: plastic work [J]": struck_together,
    "cantilever with 50 kg on a spring, 50 kg fall on it by 1 m": struck_with_load,
    "bar on a pivot and a gear that 50 kg strike at 8 m/s": stopped_by_gear,
    "free bar with 60 kg on a pivot that 20 kg strike at 20 m/s": free_with_load,
}
