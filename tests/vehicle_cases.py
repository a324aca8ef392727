"""Vehicles of pymunk's own springs, grooves and motors that strike structures, for `step_sweeps`."""

import math

import pymunk
from sudden_cases import new_space

from capacity import capacity, parse_material, parse_section
from sim import DuctileJoint, ElasticPlastic, Energy, SystemLedger


def car(space: pymunk.Space, at: tuple[float, float], speed: float, torque: float = 0.0) -> list[pymunk.Body]:
    """540 kg on wheels in grooves, with damped springs, and motors of so much torque [N m]; chassis first."""
    group = pymunk.ShapeFilter(group=7)
    chassis = pymunk.Body(500.0, 500.0 * (1.6**2 + 0.4**2) / 12.0)
    shape = pymunk.Poly.create_box(chassis, (1.6, 0.4))
    shape.friction, shape.filter = 0.5, group
    bodies, parts = [chassis], [shape]
    for x in (-0.5, 0.5):
        wheel = pymunk.Body(20.0, 0.5 * 20.0 * 0.12**2)
        tyre = pymunk.Circle(wheel, 0.12)
        tyre.friction, tyre.filter = 0.8, group
        wheel.position, wheel.angular_velocity = (x, -0.32), -speed / 0.12
        groove = pymunk.GrooveJoint(chassis, wheel, (x, -0.62), (x, -0.02), (0.0, 0.0))
        spring = pymunk.DampedSpring(chassis, wheel, (x, 0.18), (0.0, 0.0), 0.5, 39.5e3, 1.88e3)
        motor = pymunk.SimpleMotor(chassis, wheel, 10.0)
        motor.max_force = torque
        bodies.append(wheel)
        parts += [tyre, groove, spring, motor]
    for one in bodies:
        one.position, one.velocity = one.position + at, (speed, 0.0)
    space.add(*bodies, *parts)
    return bodies


def post_on_the_ground(space: pymunk.Space) -> tuple[list[pymunk.Body], list[DuctileJoint]]:
    """A post RHS 100x100x4 of 2 m in eight pieces, whose joints are not added yet, beside a road at y = 0."""
    ground = pymunk.Segment(space.static_body, (-20.0, -0.5), (20.0, -0.5), 0.5)
    ground.friction, ground.filter = 0.8, pymunk.ShapeFilter(categories=2)
    space.add(ground)
    tube = capacity(parse_section("RHS 100x100x4 mm"), parse_material("fy=275 MPa"))
    law = ElasticPlastic((tube.EA / 0.25, tube.GA_s / 0.25, tube.EI / 0.25), (tube.N_max, tube.Q_max, tube.M_max))
    pieces, joints, below = [], [], space.static_body
    for i in range(8):
        piece = pymunk.Body(3.0, 3.0 * (0.25**2 + 0.1**2) / 12.0)
        piece.position = (0.0, 0.25 * i + 0.125)
        shape = pymunk.Poly.create_box(piece, (0.1, 0.25))
        shape.friction, shape.filter = 0.3, pymunk.ShapeFilter(5, mask=pymunk.ShapeFilter.ALL_MASKS() ^ 2)
        joints.append(DuctileJoint(below, piece, (0.0, 0.25 * i), law, direction=math.pi / 2.0))
        pieces.append(below := piece)
        space.add(piece, shape)
    return pieces, joints


def post_hit(
    rate: int, iterations: int, speed: float = 10.0, torque: float = 0.0, post_first: bool = False
) -> tuple[float, float, list[Energy]]:
    """How far a car bends a post aside [m], plastic work [J], and the ledger of all after each step."""
    space = new_space(iterations)
    pieces, joints = post_on_the_ground(space)
    if post_first:
        space.add(*joints)
    car(space, (-1.2, 0.44), speed, torque)
    if not post_first:
        space.add(*joints)
    ledger, furthest, entries = SystemLedger(space), 0.0, []
    for _ in range(rate // 3):
        space.step(1.0 / rate)
        ledger.note()
        furthest = max(furthest, pieces[3].position.x)
        entries.append(ledger.energy)
    return furthest, sum(joint.dissipated for joint in joints), entries
