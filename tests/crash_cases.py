"""A closed frame of hollow section with an engine in it, which flies into what stands in its way."""

from __future__ import annotations

import itertools
import math

import pymunk

from capacity import parse_material, parse_section
from sim import DuctileJoint, Limits, section_law

STEEL, SECTION = parse_material("S235"), parse_section("RHS 100x60x3 mm")
LONG, HIGH, DEPTH, PIECE, ENGINE = 2.0, 0.75, 0.1, 0.25, 300.0


def frame(space: pymunk.Space, tip: float, speed: float, law: str) -> tuple[list[pymunk.Body], list[DuctileJoint]]:
    """Pieces and joints of a frame whose tip is at x = ``tip`` [m] and which flies there at ``speed`` [m/s].

    Pieces overlap at the corners, by their depth.
    """
    corners = [pymunk.Vec2d(tip - LONG, 0.0), pymunk.Vec2d(tip, 0.0), pymunk.Vec2d(tip, HIGH)]
    corners += [pymunk.Vec2d(tip - LONG, HIGH), corners[0]]
    ends = [
        a.interpolate_to(b, i / n)
        for a, b in itertools.pairwise(corners)
        for n in [round(a.get_distance(b) / PIECE)]
        for i in range(n)
    ]
    mass = STEEL.density * SECTION.area * PIECE
    pieces = []
    for start, end in itertools.pairwise([*ends, ends[0]]):
        body = pymunk.Body(mass, mass * (PIECE**2 + DEPTH**2) / 12.0)
        body.position, body.angle = start.interpolate_to(end, 0.5), (end - start).angle
        pieces.append((body, (PIECE, DEPTH)))
    engine = pymunk.Body(ENGINE, ENGINE * 0.4**2 / 6.0)
    engine.position = (tip - LONG + 0.4, 0.5 * HIGH)
    for body, size in [*pieces, (engine, (0.4, 0.4))]:
        body.velocity = (speed, 0.0)
        shape = pymunk.Poly.create_box(body, size)
        shape.friction = 0.3
        space.add(body, shape)
    bodies, bears = [body for body, _ in pieces], section_law(law, SECTION, STEEL, PIECE)
    limits = Limits(rotation=0.5, elongation=0.1)
    joints = [
        DuctileJoint(bodies[i - 1], bodies[i], ends[i], bears, direction=bodies[i].angle, limits=limits)
        for i in range(len(bodies))
    ]
    beside = [body for body in bodies if math.isclose(body.position.x, tip - LONG + 1.5 * PIECE)]
    joints += [DuctileJoint(body, engine, body.position.interpolate_to(engine.position, 0.5), bears) for body in beside]
    space.add(*joints)
    return [*bodies, engine], joints


def into_wall(rate: int, iterations: int, speed: float = 8.0, law: str = "interaction") -> tuple[float]:
    """Plastic work of a frame that flies into a wall, within 0.2 s [J]."""
    space = pymunk.Space()
    space.iterations, space.collision_slop = iterations, 1e-3
    wall = pymunk.Segment(space.static_body, (0.0, -10.0), (0.0, 10.0), 0.1)
    wall.friction = 0.3
    space.add(wall)
    _, joints = frame(space, -0.4, speed, law)
    for _ in range(round(0.2 * rate)):
        space.step(1.0 / rate)
    return (sum(joint.dissipated for joint in joints),)
