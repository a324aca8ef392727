"""A beam of IPE 200 that is held at both ends, and boxes that fall on it."""

from __future__ import annotations

import random

import pymunk
from bodies import piece

from capacity import capacity, parse_material, parse_section
from sim import DuctileJoint, ElasticPlastic

LENGTH, DEPTH = 10.0, 0.2
_BAR, _MASS = capacity(parse_section("IPE 200"), parse_material("S235")), 22.4


def beam(space: pymunk.Space, pieces: int) -> list[DuctileJoint]:
    """The joints of a beam along y = 0 from x = 0 on, of equal pieces, clamped at both ends."""
    size, bodies = LENGTH / pieces, []
    for i in range(pieces):
        mass = _MASS * size
        body = piece(space, mass, mass * (size**2 + DEPTH**2) / 12, (i + 0.5) * size, 0.0)
        shape = pymunk.Poly.create_box(body, (size, DEPTH))
        shape.filter, shape.friction = pymunk.ShapeFilter(group=1), 0.5
        space.add(shape)
        bodies.append(body)
    ends = [space.static_body, *bodies, space.static_body]
    law = ElasticPlastic.of_section(_BAR, size)
    joints = [DuctileJoint(ends[i], ends[i + 1], (i * size, 0.0), law, direction=0.0) for i in range(pieces + 1)]
    space.add(*joints)
    return joints


def box(space: pymunk.Space, x: float, y: float, width: float, angle: float = 0.0) -> pymunk.Body:
    """A box of 300 kg/m²."""
    mass = 300.0 * width**2
    body = piece(space, mass, mass * width**2 / 6, x, y)
    body.angle = angle
    shape = pymunk.Poly.create_box(body, (width, width))
    shape.friction = 0.6
    space.add(shape)
    return body


def boxes(space: pymunk.Space, count: int, seed: int) -> list[pymunk.Body]:
    """Boxes of 0.2 to 0.5 m above the beam, at random, in layers of fourteen."""
    at_random = random.Random(seed)
    placed = []
    for k in range(count):
        width, x = at_random.uniform(0.2, 0.5), at_random.uniform(1.0, 9.0)
        y, angle = 1.0 + 0.55 * (k // 14) + at_random.uniform(0.0, 0.1), at_random.uniform(0.0, 3.0)
        placed.append(box(space, x, y, width, angle))
    return placed
