"""Bodies in a space of one's own."""

import pymunk

from sim import DuctileJoint, ElasticPlastic


def piece(space: pymunk.Space, mass: float, moment: float, x: float, y: float, angle: float = 0.0) -> pymunk.Body:
    body = pymunk.Body(mass, moment)
    body.position, body.angle = (x, y), angle
    space.add(body)
    return body


def spring(
    stiffness: float, cap: float, mass: float = 2.0, damping: float = 0.0, scheme: tuple[float, float] = (0.0, 1.0)
) -> tuple[pymunk.Space, pymunk.Body, DuctileJoint]:
    """A mass on a joint along x."""
    space, body = pymunk.Space(), pymunk.Body(mass, 1.0)
    law = ElasticPlastic((stiffness, 1e6, 1e6), (cap, 1e9, 1e9))
    joint = DuctileJoint(
        space.static_body, body, (0.0, 0.0), law, direction=0.0, damping=(damping, 0.0, 0.0), scheme=scheme
    )
    space.add(body, joint)
    return space, body, joint


def kinetic(bodies: list[pymunk.Body]) -> float:
    # pymunk's kinetic energy is m v² + I ω², without the half.
    return sum(0.5 * body.kinetic_energy for body in bodies)
