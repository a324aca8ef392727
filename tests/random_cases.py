"""Structures at random, and what happens to them: chains, trees, frames with loops and rings of up to 24 pieces.

A seed says everything. Nothing is put where something else is already, for that strains joints when it is taken out.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import pymunk

from capacity import parse_material, parse_section
from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER, DuctileJoint, Limits
from sim.laws import LAWS, section_law

Point = pymunk.Vec2d
STEPS = 100
_MOST, _GROUP = 24, pymunk.ShapeFilter(group=1)
# Longest step [s], density of steel [kg/m³].
_LONGEST, _STEEL = 0.033, 7800.0


class RandomCase:
    """A space with one structure and what acts on it.

    Parameters
    ----------
    seed : int
    scheme : (float, float), optional
        Time integration; by default that of the seed, implicit Euler for two thirds of them.
    """

    def __init__(self, seed: int, scheme: tuple[float, float] | None = None) -> None:
        self._random = draw = random.Random(seed)
        own = IMPLICIT_EULER if draw.random() < 2.0 / 3.0 else AVERAGE_ACCELERATION
        self.scheme = scheme or own
        self.space = space = pymunk.Space()
        space.iterations, space.collision_slop = draw.choice([1, 2, 10]), draw.choice([1e-4, 1e-3])
        self.kind = draw.choice(["chain", "tree", "frame", "ring"])
        self.held, self.weight = draw.random() < 0.5, draw.random() < 0.5
        self._gravity = Point(0.0, -9.81 if self.weight else 0.0)
        space.gravity = self._gravity
        #: By which steel's is multiplied.
        self.stiffness = 10.0 ** draw.uniform(-3.0, 6.0)
        self.law = draw.choice(LAWS)
        self._length, self._depth = draw.uniform(0.05, 0.5), draw.choice([0.02, 0.05, 0.1])
        self._touch = draw.choice([0.0, 0.0, 0.3, 0.6, 0.9]), draw.choice([0.0, 0.5, 1.0])
        self.pieces: list[pymunk.Body] = []
        #: Bodies without joints.
        self.loose: list[pymunk.Body] = []
        self._build()
        #: Whether a constraint of pymunk's own acts, too.
        self.stock = draw.choice(["motor", "gear", "pivot", "pin", "spring"]) if draw.random() < 0.25 else ""
        if self.stock:
            self._add_stock()
        if self.weight and draw.random() < 0.5:
            self._lay_ground()
        self.dt = 10.0 ** draw.uniform(-5.0, math.log10(_LONGEST))
        self.changing = draw.random() < 0.2
        blows: list[Callable[[], None]] = [self._throw, self._throw, self._push, self._kick, self._set_going]
        self._blows = {draw.randrange(STEPS // 2): draw.choice(blows) for _ in range(draw.randint(1, 3))}
        self._pushed, self._force, self._until = self.pieces[0], Point(0.0, 0.0), 0
        self._step = 0

    def __str__(self) -> str:
        own = "implicit Euler" if self.scheme == IMPLICIT_EULER else "second order"
        held, weight = "held" if self.held else "free", "" if self.weight else ", no gravity"
        also = "".join(f", {word}" for word in (self.stock, "changing steps" if self.changing else "") if word)
        return (
            f"{self.kind} of {len(self.pieces)}, {held}{weight}, {self.law}, stiffness x {self.stiffness:.0e}, "
            f"{1e3 * self.dt:.2g} ms, {own}{also}"
        )

    @property
    def joints(self) -> list[DuctileJoint]:
        return [c for c in self.space.constraints if isinstance(c, DuctileJoint)]

    @property
    def isolated(self) -> bool:
        """Whether nothing from outside acts in the step to come."""
        to_ground = any(c.b is self.space.static_body for c in self.space.constraints)
        return not (self.held or self.weight or to_ground) and self._step >= self._until

    def act(self) -> bool:
        """What happens before a step; whether something was struck, thrown or set going."""
        blow = self._blows.get(self._step)
        if blow is not None:
            blow()
        if self._step < self._until:
            self._pushed.apply_force_at_world_point(self._force, self._pushed.local_to_world((0.3 * self._length, 0.0)))
        return blow is not None

    def step(self) -> None:
        """Step on, by a step of its own where they change."""
        h = self.dt * (10.0 ** self._random.uniform(-0.5, 0.5) if self.changing else 1.0)
        self._step += 1
        self.space.step(min(h, _LONGEST))

    def _build(self) -> None:
        draw, ground = self._random, self.space.static_body
        rows: dict[tuple[float, float], list[pymunk.Body]] = {}
        lines = getattr(self, f"_{self.kind}")()
        masses = self._masses(len(lines))
        for (p, q), mass in zip(lines, masses, strict=True):
            length = (q - p).length
            body = pymunk.Body(mass, mass * (length**2 + self._depth**2) / 12.0)
            body.position, body.angle = 0.5 * (p + q), (q - p).angle
            self._shape(body, pymunk.Poly.create_box(body, (length, self._depth)), _GROUP)
            self.pieces.append(body)
            for end in (p, q):
                rows.setdefault((round(end.x, 6), round(end.y, 6)), []).append(body)
        section = parse_section(f"rectangle {1e3 * self._depth:g}x{1e3 * self._depth:g} mm")
        strength = 235.0 * 10.0 ** draw.uniform(-2.0, 0.5)
        steel = parse_material(f"fy={strength:g} MPa, E={200.0 * self.stiffness:g} GPa, rho={_STEEL:g} kg/m^3")
        law = section_law(self.law, section, steel, self._length)
        k = [abs(law.elastic_tangent()[i]) for i in (0, 3, 5)]
        slow = draw.uniform(1e-5, 1e-3) if draw.random() < 0.2 else 0.0
        reach = 10.0 ** draw.uniform(-3.0, -1.0) if draw.random() < 0.5 else math.inf
        limits = Limits(reach * self._length, reach * self._length, reach, draw.random() < 0.5)
        feet = min(y for _, y in rows)
        for i, (at, (first, *others)) in enumerate(rows.items()):
            on_ground = at[1] < feet + 1e-6 if self.kind == "frame" else i == 0 or draw.random() < 0.1
            pairs = [(first, other) for other in others] + [(ground, first)] * (self.held and on_ground)
            for a, b in pairs:
                damping = (slow * k[0], slow * k[1], slow * k[2])
                joint = DuctileJoint(a, b, at, law, limits=limits, damping=damping, scheme=self.scheme)
                self.space.add(joint)

    def _masses(self, count: int) -> list[float]:
        """All alike; one heavy or light; or each its own."""
        draw, ratio = self._random, 10.0 ** self._random.uniform(0.0, 5.0)
        usual = _STEEL * self._depth**2 * self._length
        how = draw.choice(["alike", "heavy", "light", "each"])
        masses = [usual * (ratio ** draw.uniform(-0.5, 0.5) if how == "each" else 1.0) for _ in range(count)]
        if how in ("heavy", "light"):
            masses[draw.randrange(count)] *= ratio if how == "heavy" else 1.0 / ratio
        return masses

    def _chain(self) -> list[tuple[Point, Point]]:
        draw, angle, bend = self._random, self._random.uniform(-math.pi, math.pi), self._random.choice([0.0, 0.3])
        lines, p = [], Point(0.0, 0.0)
        for _ in range(draw.randint(2, _MOST)):
            lines.append((p, p := p + Point(self._length, 0.0).rotated(angle)))
            angle += draw.uniform(-bend, bend)
        return lines

    def _tree(self) -> list[tuple[Point, Point]]:
        draw, ends = self._random, [(Point(0.0, 0.0), 0.5 * math.pi)]
        lines = []
        for _ in range(draw.randint(3, _MOST)):
            p, angle = draw.choice(ends)
            angle += draw.uniform(-1.2, 1.2)
            lines.append((p, q := p + Point(self._length, 0.0).rotated(angle)))
            ends.append((q, angle))
        return lines

    def _ring(self) -> list[tuple[Point, Point]]:
        count = self._random.randint(3, _MOST)
        radius, turn = 0.5 * self._length / math.sin(math.pi / count), 2.0 * math.pi / count
        corners = [Point(radius, 0.0).rotated(i * turn) for i in range(count)]
        return [(corners[i], corners[(i + 1) % count]) for i in range(count)]

    def _frame(self) -> list[tuple[Point, Point]]:
        draw = self._random
        bays, storeys = draw.randint(1, 2), draw.randint(1, 3)
        columns = [((x, y), (x, y + 1)) for x in range(bays + 1) for y in range(storeys)]
        members = columns + [((x, y + 1), (x + 1, y + 1)) for x in range(bays) for y in range(storeys)]
        parts = draw.randint(1, _MOST // len(members))
        side, lines = parts * self._length, []
        for (x, y), (u, v) in members:
            p, step = Point(x * side, y * side), Point((u - x) * self._length, (v - y) * self._length)
            lines += [(p + i * step, p + (i + 1) * step) for i in range(parts)]
        return lines

    def _shape(self, body: pymunk.Body, shape: pymunk.Shape, own: pymunk.ShapeFilter | None = None) -> bool:
        """Add a body with its shape where nothing is; pieces always."""
        shape.elasticity, shape.friction = self._touch
        if own is not None:
            shape.filter = own
        self.space.add(body, shape)
        free = own is not None or not any(found.contact_point_set.points for found in self.space.shape_query(shape))
        if not free:
            self.space.remove(body, shape)
        return free

    def _add_stock(self) -> None:
        """One of pymunk's own between a piece and another one, a loose body, or the ground."""
        draw = self._random
        piece, other = draw.choice(self.pieces), draw.choice([*self.pieces, self.space.static_body])
        if other is piece or draw.random() < 0.5:
            mass = piece.mass * 10.0 ** draw.uniform(-1.0, 1.0)
            other = pymunk.Body(mass, mass * self._length**2 / 6.0)
            other.position = piece.position + Point(0.0, -2.0 * self._length)
            self.space.add(other)
            self.loose.append(other)
        at, far = piece.position, (0.5 * self._length, 0.0)
        k = piece.mass * (2.0 * math.pi * 10.0 ** draw.uniform(0.0, 2.0)) ** 2
        makes: dict[str, Callable[[], pymunk.Constraint]] = {
            "motor": lambda: pymunk.SimpleMotor(piece, other, draw.uniform(-30.0, 30.0)),
            "gear": lambda: pymunk.GearJoint(piece, other, other.angle - piece.angle, 1.0),
            "pivot": lambda: pymunk.PivotJoint(piece, other, at),
            "pin": lambda: pymunk.PinJoint(piece, other, far, (0.0, 0.0)),
            "spring": lambda: pymunk.DampedSpring(piece, other, far, (0.0, 0.0), self._length, k, 0.02 * k**0.5),
        }
        self.space.add(makes[self.stock]())

    def _lay_ground(self) -> None:
        low = min(shape.bb.bottom for shape in self.space.shapes) - self._random.uniform(0.05, 1.0)
        ground = pymunk.Segment(self.space.static_body, (-100.0, low - 1.0), (100.0, low - 1.0), 1.0)
        ground.elasticity, ground.friction = self._touch
        self.space.add(ground)

    def _throw(self) -> None:
        """Throw a ball or a box at a piece, to come within a few steps."""
        draw, target = self._random, self._random.choice(self.pieces)
        mass, size = target.mass * 10.0 ** draw.uniform(-1.0, 2.0), draw.uniform(0.3, 2.0) * self._depth
        body = pymunk.Body(mass, mass * size**2 / 6.0)
        shape = pymunk.Circle(body, size) if draw.random() < 0.5 else pymunk.Poly.create_box(body, (size, size))
        way, speed = Point(1.0, 0.0).rotated(draw.uniform(-math.pi, math.pi)), 10.0 ** draw.uniform(0.0, 2.0)
        away = self._depth + 1.5 * size + speed * self.dt * draw.uniform(0.0, 3.0)
        body.position, body.velocity, body.angle = (
            target.position - away * way,
            speed * way + target.velocity,
            way.angle,
        )
        if self._shape(body, shape):
            self.loose.append(body)

    def _push(self) -> None:
        """A force on a piece for a while, by which all of them would be this fast then."""
        draw = self._random
        self._pushed, steps = draw.choice(self.pieces), draw.randint(2, STEPS // 2)
        speed = Point(10.0 ** draw.uniform(-1.0, 1.5), 0.0).rotated(draw.uniform(-math.pi, math.pi))
        self._force = sum(body.mass for body in self.pieces) / (steps * self.dt) * speed
        self._until = self._step + steps

    def _kick(self) -> None:
        """An impulse on a piece."""
        draw, piece = self._random, self._random.choice(self.pieces)
        speed = Point(10.0 ** draw.uniform(-0.5, 1.5), 0.0).rotated(draw.uniform(-math.pi, math.pi))
        piece.apply_impulse_at_local_point(piece.mass * speed, (draw.uniform(-0.5, 0.5) * self._length, 0.0))

    def _set_going(self) -> None:
        """Every piece its own way, or all of them like one body that turns."""
        draw, each, speed = self._random, self._random.random() < 0.5, 10.0 ** self._random.uniform(-1.0, 2.0)
        spin = draw.uniform(-1.0, 1.0) * speed / (self._length * len(self.pieces))
        centre = self.pieces[0].position
        for body in self.pieces:
            if each:
                body.velocity = speed * draw.uniform(-1.0, 1.0), speed * draw.uniform(-1.0, 1.0)
                body.angular_velocity = draw.uniform(-1.0, 1.0) * speed / self._length
            else:
                body.velocity = spin * (body.position - centre).perpendicular()
                body.angular_velocity = spin
