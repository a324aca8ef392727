"""A scene's loose bodies as pymunk bodies and shapes."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import pymunk

from scene import Body, Box, Circle, Scene, Shape

#: Groups of bodies that pass through each other, numbered for Chipmunk.
_groups = itertools.count(1)


def new_group() -> int:
    """A number for bodies that pass through each other."""
    return next(_groups)


def add_bodies(scene: Scene, space: pymunk.Space) -> dict[str, pymunk.Body]:
    """The loose bodies of ``scene`` by name."""
    groups: dict[str, int] = {}
    bodies = {}
    for name, body in scene.bodies.items():
        group = 0 if body.group is None else groups.setdefault(body.group, new_group())
        bodies[name] = _add_body(body, space, group)
    return bodies


def _add_body(body: Body, space: pymunk.Space, group: int) -> pymunk.Body:
    made = solid(
        body.shapes,
        mass=body.mass,
        area_density=body.density * body.depth,
        friction=body.friction,
        restitution=body.restitution,
        group=group,
    )
    if body.fixed:
        made.body_type = pymunk.Body.STATIC
    elif body.moment_of_inertia is not None:
        made.moment = float(body.moment_of_inertia)
    place(made, body.at, float(body.angle))
    if not body.fixed:
        made.velocity, made.angular_velocity = body.velocity, body.spin
    space.add(made, *made.shapes)
    return made


def solid(
    shapes: Sequence[Shape],
    *,
    mass: float | None,
    area_density: float,
    friction: float,
    restitution: float,
    group: int = 0,
) -> pymunk.Body:
    """A dynamic body of ``shapes``, filled evenly; in no space yet, and with its centre of mass as they lie.

    Parameters
    ----------
    mass : float, optional
        [kg]; or else ``area_density`` gives it.
    area_density : float
        Mass per area seen [kg/m²].
    group : int
        Bodies of the same group, except 0, pass through each other.
    """
    # Chipmunk adds up mass, centre and moment from the shapes' densities, of a body in a space.
    weighed, scale = pymunk.Body(), pymunk.Space()
    parts = [_shape(weighed, shape) for shape in shapes]
    scale.add(weighed, *parts)
    for part in parts:
        part.density = area_density if mass is None else float(mass) / sum(p.area for p in parts)
    body = pymunk.Body(weighed.mass, weighed.moment)
    body.center_of_gravity = weighed.center_of_gravity
    for shape in shapes:
        part = _shape(body, shape)
        part.friction, part.elasticity = friction, restitution
        part.filter = pymunk.ShapeFilter(group=group)
    return body


def place(body: pymunk.Body, at: Sequence[float], angle: float) -> None:
    """Put the origin of ``body``'s coordinates to ``at`` [m], turned by ``angle`` [rad]."""
    body.position = (float(at[0]), float(at[1]))
    body.angle = angle


def _shape(body: pymunk.Body, shape: Shape) -> pymunk.Shape:
    if isinstance(shape, Circle):
        return pymunk.Circle(body, shape.radius, shape.at)
    if isinstance(shape, Box):
        (w, h), (x, y) = shape.size, shape.at
        corners = [(x - w / 2, y - h / 2), (x + w / 2, y - h / 2), (x + w / 2, y + h / 2), (x - w / 2, y + h / 2)]
        return pymunk.Poly(body, corners)
    return pymunk.Poly(body, list(shape.points))
