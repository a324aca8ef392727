"""Small runs to record: a cantilever under a falling ball, with joints that bend and break."""

import itertools
import math

import pymunk

from capacity import capacity, parse_material, parse_section
from sim import DuctileJoint, ElasticPlastic, Limits
from sim.recording import Recorder, Recording

STEEL = parse_material("fy=235 MPa, E=210 GPa, rho=7850 kg/m^3")
SECTION = parse_section("rectangle 50x100 mm")
PIECES, LENGTH, DEPTH = 6, 3.0, 0.1


def cantilever(space: pymunk.Space, rotation: float = math.inf) -> list[DuctileJoint]:
    """Equal pieces along x from a wall at the origin; joints break at ``rotation``."""
    c, piece = capacity(SECTION, STEEL), LENGTH / PIECES
    mass = STEEL.density * SECTION.area * piece
    chain = [space.static_body]
    for i in range(PIECES):
        body = pymunk.Body(mass, mass * piece**2 / 12)
        body.position = ((i + 0.5) * piece, 0.0)
        shape = pymunk.Poly.create_box(body, (piece, DEPTH))
        shape.filter, shape.friction = pymunk.ShapeFilter(group=1), 0.5
        space.add(body, shape)
        chain.append(body)
    law = ElasticPlastic((c.EA / piece, c.GA_s / piece, c.EI / piece), (c.N_max, c.Q_max, c.M_max))
    joints = [
        DuctileJoint(a, b, (i * piece, 0.0), law, direction=0.0, limits=Limits(rotation=rotation))
        for i, (a, b) in enumerate(itertools.pairwise(chain))
    ]
    space.add(*joints)
    return joints


def world() -> pymunk.Space:
    """Ground 1.5 m below the beam, with a wall on either side."""
    space = pymunk.Space()
    space.gravity, space.iterations, space.collision_slop = (0.0, -9.81), 4, 1e-4
    ground = pymunk.Segment(space.static_body, (-1.5, -1.5), (4.5, -1.5), 0.02)
    wall = pymunk.Poly(space.static_body, [(-0.5, -1.5), (-0.001, -1.5), (-0.001, 0.6), (-0.5, 0.6)])
    stop = pymunk.Segment(space.static_body, (4.5, -1.5), (4.5, -0.9), 0.02)
    for shape in (ground, wall, stop):
        shape.friction = 0.6
    wall.filter = pymunk.ShapeFilter(group=1)
    space.add(ground, wall, stop)
    return space


def falling_ball(seconds: float = 3.0, dt: float = 1 / 240, every: float = 1 / 30) -> Recording:
    """A ball of 300 kg falls on the tip: the root bends until it breaks, and beam and ball lie on the ground."""
    space = world()
    cantilever(space, rotation=0.12)
    ball = pymunk.Body(300.0, 0.5 * 300.0 * 0.25**2)
    ball.position, ball.velocity = (2.4, 1.2), (0.0, -4.0)
    round_shape = pymunk.Circle(ball, 0.25)
    round_shape.friction = 0.5
    space.add(ball, round_shape)
    recorder = Recorder(space, every)
    for _ in range(round(seconds / dt)):
        space.step(dt)
        recorder.sample()
    return recorder.finish("A ball falls on a cantilever")
