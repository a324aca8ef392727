"""Random lives of structures: pieces, joints and balls come, go and come back between steps.

Nothing is put where something else is already; pushing the two apart would strain joints.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

import numpy as np
import pymunk

from sim import DuctileJoint, ElasticPlastic, Limits, Structure

KINDS = ("piece", "out", "back", "body", "kick", "ball")
_MOST_PIECES = 12
# How often, out of a hundred steps.
_USUAL, _ISOLATED = [8, 3, 3, 2, 3, 3, 78], [8, 5, 5, 2, 0, 0, 80]


class Life:
    """A space and what is done to it before each step.

    Parameters
    ----------
    seed : int
    scheme : (float, float)
        Time integration.
    isolated : bool
        Nothing acts from outside then: no ground, no gravity, no kicks, and pieces fly that come on their own. Nor do
        balls, which Chipmunk moves aside by what they overlap with others.
    """

    def __init__(self, seed: int, scheme: tuple[float, float], isolated: bool = False) -> None:
        self._random = draw = random.Random(seed)
        self.space = space = pymunk.Space()
        space.collision_slop, space.iterations = 1e-3, draw.choice([1, 2, 10])
        self._isolated, self._scheme = isolated, scheme
        if not isolated:
            space.gravity = (0.0, draw.choice([-9.81, -9.81, 0.0]))
            ground = pymunk.Segment(space.static_body, (-20.0, -2.0), (40.0, -2.0), 0.1)
            ground.friction = 0.6
            space.add(ground)
            if draw.random() < 0.3:
                space.sleep_time_threshold = 0.3
        k = 10.0 ** draw.uniform(5.0, 8.0)
        self._law = ElasticPlastic((k, k, 0.01 * k), (0.01 * k, 0.01 * k, 1e-4 * k))
        self._limits = Limits(rotation=0.3, elongation=0.05) if draw.random() < 0.5 else Limits()
        self.dt = draw.choice([1 / 60, 1 / 120, 1 / 240])
        self._pieces: list[pymunk.Body] = []
        self._apart: list[DuctileJoint] = []
        #: How often what was done.
        self.done = dict.fromkeys(KINDS, 0)

    def step(self) -> None:
        """Do one thing or none, and step."""
        self.change()
        self.space.step(self.dt)

    def change(self) -> None:
        """Do one thing or none."""
        kind = self._random.choices([*KINDS, ""], _ISOLATED if self._isolated else _USUAL)[0]
        if kind and getattr(self, f"_{kind}")():
            self.done[kind] += 1

    @property
    def joints(self) -> list[DuctileJoint]:
        return [c for c in self.space.constraints if isinstance(c, DuctileJoint)]

    @property
    def structures(self) -> Iterator[Structure]:
        return iter(dict.fromkeys(joint.structure for joint in self.joints if joint.structure is not None))

    @property
    def numbers(self) -> np.ndarray:
        """Where all bodies are and how fast, and what joints bear."""
        bodies = [[*b.position, b.angle, *b.velocity, b.angular_velocity] for b in self.space.bodies]
        return np.array([x for row in [*bodies, *(joint.force for joint in self.joints)] for x in row])

    @property
    def momenta(self) -> np.ndarray:
        """Momentum x, y [N s] and angular momentum about the origin [N m s] of all bodies."""
        total = np.zeros(3)
        for b in self.space.bodies:
            (x, y), p = b.position, b.mass * b.velocity
            total += [p.x, p.y, x * p.y - y * p.x + b.moment * b.angular_velocity]
        return total

    def _add(self, body: pymunk.Body, shape: pymunk.Shape) -> bool:
        """Add a body where nothing is."""
        self.space.add(body, shape)
        free = not any(found.contact_point_set.points for found in self.space.shape_query(shape))
        if not free:
            self.space.remove(body, shape)
        return free

    def _piece(self) -> bool:
        """A piece of a metre on the end of another one, or on the ground."""
        draw, ground = self._random, self.space.static_body
        if len(self._pieces) >= _MOST_PIECES:
            return False
        body = pymunk.Body(draw.uniform(0.5, 20.0), draw.uniform(0.1, 2.0))
        on = draw.choice(self._pieces) if self._pieces and draw.random() < 0.8 else ground
        at, angle = pymunk.Vec2d(draw.uniform(-3.0, 3.0), draw.uniform(0.0, 2.0)), draw.uniform(-3.0, 3.0)
        if on is not ground:
            at, angle = on.local_to_world((draw.choice([0.5, -0.5]), 0.0)), on.angle + draw.uniform(-1.0, 1.0)
        body.position, body.angle = at + pymunk.Vec2d(0.5, 0.0).rotated(angle), angle
        shape = pymunk.Poly.create_box(body, (1.0, 0.1))
        shape.friction, shape.filter = 0.5, pymunk.ShapeFilter(group=1)
        if not self._add(body, shape):
            return False
        self._pieces.append(body)
        if on is ground and self._isolated:
            body.velocity, body.angular_velocity = (
                (draw.uniform(-3.0, 3.0), draw.uniform(-3.0, 3.0)),
                draw.uniform(-5.0, 5.0),
            )
        else:
            self.space.add(DuctileJoint(on, body, at, self._law, limits=self._limits, scheme=self._scheme))
        return True

    def _out(self) -> bool:
        """Take a joint out."""
        joints = self.joints
        if joints:
            joint = self._random.choice(joints)
            self.space.remove(joint)
            self._apart.append(joint)
        return bool(joints)

    def _back(self) -> bool:
        """Put one back that was taken out, wherever its bodies are now."""
        if not self._apart:
            return False
        joint = self._apart.pop(self._random.randrange(len(self._apart)))
        there = all(body in (*self._pieces, self.space.static_body) for body in (joint.a, joint.b))
        if there:
            self.space.add(joint)
        return there

    def _body(self) -> bool:
        """Take a piece out, with its joints."""
        if len(self._pieces) < 2:
            return False
        body = self._pieces.pop(self._random.randrange(len(self._pieces)))
        self.space.remove(*(joint for joint in self.joints if body in (joint.a, joint.b)), *body.shapes, body)
        return True

    def _kick(self) -> bool:
        """Strike a piece between two steps."""
        if self._pieces:
            blow = 0.0, self._random.uniform(-30.0, 30.0)
            self._random.choice(self._pieces).apply_impulse_at_local_point(blow)
        return bool(self._pieces)

    def _ball(self) -> bool:
        """Throw a ball at it from above."""
        draw = self._random
        ball = pymunk.Body(draw.uniform(0.5, 10.0), 0.1)
        ball.position, ball.velocity = (draw.uniform(-3.0, 4.0), 4.0), (0.0, -draw.uniform(0.0, 10.0))
        circle = pymunk.Circle(ball, 0.15)
        circle.friction, circle.elasticity = 0.5, draw.choice([0.0, 0.5])
        return self._add(ball, circle)
