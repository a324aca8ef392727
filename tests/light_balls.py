"""Balls that strike bars of rigid pieces squarely: in `sim`, and by an explicit integration of its own.

`python tests/light_balls.py` prints plastic work at several steps over that in undamped steps of 1/160000 s, which
agree with the explicit integration.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pymunk

from capacity import capacity, parse_material, parse_section
from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER, DuctileJoint, ElasticPlastic, Structure

RATES = (60, 240, 1000)
RADIUS = 0.05
STEEL = parse_material("fy=235 MPa, E=200 GPa, rho=7800 kg/m^3")


@dataclass(frozen=True)
class Bar:
    """A bar cut into equal pieces, clamped or not at its left and its right end, and where a ball comes down [m]."""

    section: str
    pieces: int
    piece: float
    depth: float
    left: bool
    right: bool
    struck: float

    @property
    def mass(self) -> float:
        """Of a piece [kg]."""
        return STEEL.density * parse_section(self.section).area * self.piece

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """Of a joint [N/m, N/m, N m]."""
        c = capacity(parse_section(self.section), STEEL)
        return c.EA / self.piece, c.GA_s / self.piece, c.EI / self.piece

    @property
    def strength(self) -> tuple[float, float, float]:
        """Of a joint [N, N, N m]."""
        c = capacity(parse_section(self.section), STEEL)
        return c.N_max, c.Q_max, c.M_max


BARS = {
    "cantilever": Bar("rectangle 20x50 mm", 10, 0.1, 0.05, True, False, 0.95),
    "free": Bar("rectangle 40x20 mm", 10, 0.1, 0.02, False, False, 0.5),
    "clamped": Bar("rectangle 40x20 mm", 12, 0.125, 0.02, True, True, 0.75),
}


def simulated(
    bar: Bar,
    mass: float,
    speed: float,
    restitution: float,
    rate: int,
    scheme: tuple[float, float] = IMPLICIT_EULER,
    seconds: float = 0.1,
) -> Structure:
    """The bar ``seconds`` after a ball has struck it, without friction, at so many steps a second."""
    space = pymunk.Space()
    space.collision_slop = 1e-4
    bodies = []
    for i in range(bar.pieces):
        body = pymunk.Body(bar.mass, bar.mass * bar.piece**2 / 12.0)
        body.position = ((i + 0.5) * bar.piece, 0.0)
        shape = pymunk.Poly.create_box(body, (bar.piece, bar.depth))
        shape.filter, shape.elasticity = pymunk.ShapeFilter(group=1), 1.0
        space.add(body, shape)
        bodies.append(body)
    ends = [space.static_body] * bar.left + bodies + [space.static_body] * bar.right
    law, first = ElasticPlastic(bar.stiffness, bar.strength), 0 if bar.left else 1
    joints = [
        DuctileJoint(a, b, ((first + i) * bar.piece, 0.0), law, direction=0.0, scheme=scheme)
        for i, (a, b) in enumerate(itertools.pairwise(ends))
    ]
    structure = Structure(joints)
    ball = pymunk.Body(mass, 0.5 * mass * RADIUS**2)
    # The surfaces overlap after the second step, by 15 mm at most.
    gap = 2.0 * speed / rate - min(0.37 * speed / rate, 0.015)
    ball.position, ball.velocity = (bar.struck, 0.5 * bar.depth + RADIUS + gap), (0.0, -speed)
    circle = pymunk.Circle(ball, RADIUS)
    circle.elasticity = restitution
    space.add(*joints, ball, circle)
    for _ in range(round((seconds + gap / speed) * rate)):
        space.step(1.0 / rate)
    return structure


def integrated(
    bar: Bar, mass: float, speed: float, restitution: float, step: float = 1e-6, seconds: float = 0.1
) -> float:
    """Plastic work [J] of the same pieces, joints and ball in explicit steps; the ball strikes one piece only.

    Forces act on velocities, which move the bodies. Where surfaces would overlap after a step, an impulse leaves the
    ball and the piece without relative velocity, or with ``restitution`` times what it was.
    """
    n, piece, half = bar.pieces, bar.piece, 0.5 * bar.piece
    inertia = bar.mass * piece**2 / 12.0
    place, velocity = np.zeros((n + 2, 3)), np.zeros((n + 2, 3))
    place[:, 0] = (np.arange(n + 2) - 0.5) * piece
    first, last = (0 if bar.left else 1), (n + 1 if bar.right else n)
    stiffness, strength = np.array(bar.stiffness)[:, None], np.array(bar.strength)[:, None]
    flow, work = np.zeros((3, last - first)), 0.0
    x, y, u, v = bar.struck, 0.5 * bar.depth + RADIUS, 0.0, -speed
    struck = 1 + int(bar.struck / piece)
    lightness = np.array([1.0 / bar.mass, 1.0 / bar.mass, 1.0 / inertia])
    for _ in range(round(seconds / step)):
        arm_x, arm_y = half * np.cos(place[:, 2]), half * np.sin(place[:, 2])
        a, b = slice(first, last), slice(first + 1, last + 1)
        dx = place[b, 0] - arm_x[b] - place[a, 0] - arm_x[a]
        dy = place[b, 1] - arm_y[b] - place[a, 1] - arm_y[a]
        turn = 0.5 * (place[a, 2] + place[b, 2])
        c, s = np.cos(turn), np.sin(turn)
        q = np.array([c * dx + s * dy, c * dy - s * dx, place[b, 2] - place[a, 2]])
        trial = stiffness * (q - flow)
        force = np.clip(trial, -strength, strength)
        slip = (trial - force) / stiffness
        flow += slip
        work += float((force * slip).sum())
        px, py = c * force[0] - s * force[1], s * force[0] + c * force[1]
        couple = 0.5 * (force[0] * q[1] - force[1] * q[0])
        load = np.zeros((n + 2, 3))
        load[a] += np.stack([px, py, arm_x[a] * py - arm_y[a] * px + force[2] - couple], axis=1)
        load[b] += np.stack([-px, -py, arm_x[b] * py - arm_y[b] * px - force[2] - couple], axis=1)
        velocity[1:-1] += step * load[1:-1] * lightness
        # The nearest point of the piece's box.
        c, s = math.cos(place[struck, 2]), math.sin(place[struck, 2])
        dx, dy = x - place[struck, 0], y - place[struck, 1]
        near = min(max(c * dx + s * dy, -half), half), min(max(c * dy - s * dx, -0.5 * bar.depth), 0.5 * bar.depth)
        rx, ry = c * near[0] - s * near[1], s * near[0] + c * near[1]
        gap = math.hypot(dx - rx, dy - ry)
        nx, ny = (dx - rx) / gap, (dy - ry) / gap
        du, dv, spin = u - velocity[struck, 0], v - velocity[struck, 1], velocity[struck, 2]
        approach, arm = (du + spin * ry) * nx + (dv - spin * rx) * ny, rx * ny - ry * nx
        if gap - RADIUS + step * approach < 0.0:
            wanted = -restitution * approach if restitution > 0.0 else -max(gap - RADIUS, 0.0) / step
            impulse = max((wanted - approach) / (1.0 / mass + 1.0 / bar.mass + arm**2 / inertia), 0.0)
            u, v = u + impulse * nx / mass, v + impulse * ny / mass
            velocity[struck] -= impulse * np.array([nx, ny, arm]) * lightness
        place[1:-1] += step * velocity[1:-1]
        x, y = x + step * u, y + step * v
    return work


BLOWS = (
    ("cantilever", 0.5, 100.0),
    ("cantilever", 0.5, 30.0),
    ("cantilever", 1.0, 20.0),
    ("cantilever", 5.0, 10.0),
    ("cantilever", 20.0, 10.0),
    ("cantilever", 50.0, 5.0),
    ("free", 0.5, 100.0),
    ("free", 5.0, 20.0),
    ("free", 50.0, 5.0),
    ("clamped", 0.5, 100.0),
    ("clamped", 5.0, 20.0),
    ("clamped", 50.0, 5.0),
)


def table() -> Iterator[str]:
    """The table, line by line, in Markdown."""
    yield "| ball | bar | e | [J] | " + " | ".join(f"1/{rate} s" for rate in RATES) + " |"
    yield "|---|---|---|---|" + "---|" * len(RATES)
    for (kind, mass, speed), restitution in itertools.product(BLOWS, (0.0, 0.5)):
        blow = BARS[kind], mass, speed, restitution
        right = float(simulated(*blow, 160_000, AVERAGE_ACCELERATION).dissipated.sum())
        found = [float(simulated(*blow, rate).dissipated.sum()) / right - 1.0 for rate in RATES]
        parts = " | ".join(f"{error:+.0%}" for error in found)
        yield f"| {mass:g} kg, {speed:g} m/s | {kind} | {restitution:g} | {right:.3g} | {parts} |"


if __name__ == "__main__":
    for line in table():
        print(line, flush=True)
