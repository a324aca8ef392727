"""The rigid bodies of a scene: the pieces of its members, and a body for each node where members meet."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pymunk

from scene import Scene
from sim.chipmunk import next_move
from sim.rules import Rule
from sim.shapes import add_box

#: Share of a member's end piece that belongs to the body of a node where several members meet.
_NODE_SHARE = 0.1
#: Least radius of gyration of a piece, over its section's: that of one as long as half a rectangle's depth is half of
#: it. The slabs that a stub is cut into, without any to speak of, would leave the solver no digits.
_SLAB = 0.25


@dataclass(frozen=True)
class Piece:
    """A rigid piece of a member, from ``start`` to ``end`` along it [m]."""

    body: pymunk.Body
    member: str
    start: float
    end: float


@dataclass(frozen=True)
class Span:
    """A piece of a member, or the bit of it that belongs to a node: its body, its length [m], and its middle there."""

    body: pymunk.Body
    member: str
    start: float
    end: float
    middle: tuple[float, float]


@dataclass(frozen=True)
class NodePoint:
    """A node as a point of the body that it belongs to, in that body's coordinates [m]."""

    body: pymunk.Body
    point: tuple[float, float]

    def now(self) -> tuple[float, float]:
        """Where the node is [m]."""
        x, y = self.body.local_to_world(self.point)
        return x, y

    def ahead(self, dt: float) -> np.ndarray:
        """Where it will be when Chipmunk has moved the body, first thing in the next step of ``dt`` [s], (2,) [m]."""
        body = self.body
        arm = pymunk.Vec2d(*self.point) - body.center_of_gravity
        velocity, spin = next_move(body)
        centre = body.local_to_world(body.center_of_gravity) + dt * velocity
        return np.array(centre + arm.rotated(body.angle + dt * spin))


class Pieces:
    """All rigid bodies of ``scene`` in ``space``, each member cut by a rule.

    Parameters
    ----------
    scene : Scene
    rules : mapping
        By member, what it is cut by.
    space : pymunk.Space
    finest : mapping
        By member, the rule with the most joints that it will ever have; what belongs to nodes goes by that, and so they
        stay what they are.

    Attributes
    ----------
    of : dict[str, list[Piece]]
        By member, from its start to its end.
    at_node : dict[str, pymunk.Body]
        Bodies of the nodes where members meet, or that are more than a clamp or a hinge at a member's end. Each is made
        of the first bit of each member there, and of the node's own mass.
    """

    def __init__(
        self, scene: Scene, rules: Mapping[str, Rule], space: pymunk.Space, finest: Mapping[str, Rule]
    ) -> None:
        self.scene, self.space = scene, space
        self._finest = finest
        self.meeting: dict[str, list[str]] = defaultdict(list)
        for name, member in scene.members.items():
            self.meeting[member.start].append(name)
            self.meeting[member.end].append(name)
        self.at_node = {
            name: self._node_body(name, members) for name, members in self.meeting.items() if self._needs_body(name)
        }
        self._at_node_body = {name: body.world_to_local(scene.nodes[name].at) for name, body in self.at_node.items()}
        self._node_spans = {name: self._bits_of_nodes(name) for name in scene.members}
        self.of = {name: self._cut(name, rules[name]) for name in scene.members}

    def bodies(self) -> list[pymunk.Body]:
        """All of them."""
        return [*self.at_node.values(), *(piece.body for pieces in self.of.values() for piece in pieces)]

    def spans(self, member: str) -> list[Span]:
        """The pieces of a member, and the bits of it that belong to its nodes."""
        pieces = [Span(piece.body, member, piece.start, piece.end, (0.0, 0.0)) for piece in self.of[member]]
        return pieces + self._node_spans[member]

    def _bits_of_nodes(self, member: str) -> list[Span]:
        c, s, length = self.scene.axis(member)
        own = self.scene.members[member]
        x, y = self.scene.nodes[own.start].at
        start, *_, end = self.stops(member, self._finest[member])
        spans = []
        for node, first, last in ((own.start, 0.0, start), (own.end, end, length)):
            if node in self.at_node:
                body, along = self.at_node[node], 0.5 * (first + last)
                mx, my = body.world_to_local((x + c * along, y + s * along))
                spans.append(Span(body, member, first, last, (mx, my)))
        return spans

    def node_points(self) -> dict[str, NodePoint]:
        """The nodes as points of the bodies that they belong to."""
        return {name: self.node_point(name) for name in self.meeting}

    def node_point(self, name: str) -> NodePoint:
        """A node as a point of the body that it belongs to."""
        body = self.at_node.get(name)
        if body is not None:
            return NodePoint(body, self._at_node_body[name])
        member = self.meeting[name][0]
        first = self.scene.members[member].start == name
        piece = self.of[member][0 if first else -1]
        return NodePoint(piece.body, ((-0.5 if first else 0.5) * (piece.end - piece.start), 0.0))

    def _needs_body(self, name: str) -> bool:
        node = self.scene.nodes[name]
        plain = node.support in ("free", "clamped", "pinned") and node.spring is None and node.mass == 0.0
        return len(self.meeting[name]) > 1 or not plain or node.settlement != (0.0, 0.0) or node.bearing > 0.0

    def _first_bit(self, member: str, node: str) -> tuple[float, float, float, float]:
        """What of ``member`` belongs to its ``node``: its length, the member's direction, and which way it goes on."""
        c, s, length = self.scene.axis(member)
        points = self._finest[member].points
        if self.scene.members[member].start == node:
            return length * _NODE_SHARE * (points[1] - points[0]), c, s, 1.0
        return length * _NODE_SHARE * (points[-1] - points[-2]), c, s, -1.0

    def _node_body(self, name: str, members: list[str]) -> pymunk.Body:
        node = self.scene.nodes[name]
        x, y = map(float, node.at)
        parts = [(float(node.mass), 0.0, x, y)]
        for member in members:
            first, c, s, side = self._first_bit(member, name)
            mass, moment = self._inertia(member, first)
            parts.append((mass, moment, x + 0.5 * side * c * first, y + 0.5 * side * s * first))
        mass = sum(part[0] for part in parts)
        cx = sum(m * px for m, _, px, _ in parts) / mass
        cy = sum(m * py for m, _, _, py in parts) / mass
        moment = sum(i + m * ((px - cx) ** 2 + (py - cy) ** 2) for m, i, px, py in parts)
        return self._add_body(mass, moment, cx, cy, 0.0)

    def _inertia(self, name: str, length: float) -> tuple[float, float]:
        """Mass [kg] and moment of inertia [kg m²] of ``length`` of a member about its own centre."""
        member = self.scene.members[name]
        mass = member.material.density * member.section.area * length
        square = member.section.second_moment_of_area / member.section.area
        moment = mass * max(length**2 / 12.0, _SLAB**2 * square)
        if member.theory == "timoshenko":
            moment += mass * square
        return mass, moment

    def _add_body(self, mass: float, moment: float, x: float, y: float, angle: float) -> pymunk.Body:
        body = pymunk.Body(mass, moment)
        body.position = (x, y)
        body.angle = angle
        self.space.add(body)
        return body

    def stops(self, name: str, rule: Rule) -> list[float]:
        """Where the pieces of a member that is cut by ``rule`` begin and end along it [m]."""
        member = self.scene.members[name]
        stops: list[float] = (rule.points * self.scene.axis(name)[2]).tolist()
        if member.start in self.at_node:
            stops[0] += self._first_bit(name, member.start)[0]
        if member.end in self.at_node:
            stops[-1] -= self._first_bit(name, member.end)[0]
        return stops

    def inertias(self, name: str, rule: Rule) -> np.ndarray:
        """Mass [kg] and moment of inertia [kg m²] of each of these pieces, (n, 2)."""
        stops = self.stops(name, rule)
        return np.array([self._inertia(name, end - start) for start, end in itertools.pairwise(stops)])

    def _cut(self, name: str, rule: Rule) -> list[Piece]:
        """Rigid pieces of one member, along its axis."""
        c, s, _ = self.scene.axis(name)
        x0, y0 = self.scene.nodes[self.scene.members[name].start].at
        stops = np.array(self.stops(name, rule))
        middles = 0.5 * (stops[:-1] + stops[1:])
        angles = np.full(len(middles), math.atan2(s, c))
        return self.pieces_at(name, rule, np.column_stack([x0 + c * middles, y0 + s * middles, angles]))

    def pieces_at(self, name: str, rule: Rule, poses: np.ndarray) -> list[Piece]:
        """Rigid pieces of one member, new in the space, where ``poses`` (x, y, angle) (n, 3) say."""
        return [
            Piece(self._add_body(mass, moment, x, y, angle), name, start, end)
            for (start, end), (mass, moment), (x, y, angle) in zip(
                itertools.pairwise(self.stops(name, rule)),
                self.inertias(name, rule).tolist(),
                poses.tolist(),
                strict=True,
            )
        ]

    def replace(self, name: str, pieces: list[Piece]) -> None:
        """Put ``pieces`` in the place of those of a member, with shapes like theirs if they have any."""
        for piece in pieces:
            middle = 0.5 * (piece.start + piece.end)
            old = next(old for old in self.of[name] if middle <= old.end or old is self.of[name][-1])
            for like in old.body.shapes:
                shape = self._add_box(name, piece)
                shape.friction, shape.elasticity, shape.surface_velocity = (
                    like.friction,
                    like.elasticity,
                    like.surface_velocity,
                )
                shape.filter, shape.sensor, shape.collision_type = like.filter, like.sensor, like.collision_type
        for old in self.of[name]:
            self.space.remove(*old.body.shapes, old.body)
        self.of[name] = pieces

    def add_shapes(self) -> None:
        """A box for each piece, and one for each member's bit of a node, as deep as the section."""
        for member, pieces in self.of.items():
            for piece in pieces:
                self._add_box(member, piece)
            x, y = self.scene.nodes[self.scene.members[member].start].at
            c, s, _ = self.scene.axis(member)
            for span in self._node_spans[member]:
                corners = self._corners(member, span.start, span.end)
                add_box(
                    span.body, [span.body.world_to_local((x + c * u - s * v, y + s * u + c * v)) for u, v in corners]
                )

    def _corners(self, member: str, start: float, end: float) -> list[tuple[float, float]]:
        low, high = self.scene.members[member].section.outline.extent()
        return [(start, low), (end, low), (end, high), (start, high)]

    def _add_box(self, member: str, piece: Piece) -> pymunk.Shape:
        middle = 0.5 * (piece.start + piece.end)
        return add_box(piece.body, [(u - middle, v) for u, v in self._corners(member, piece.start, piece.end)])

    def greatest_depth(self) -> float:
        """Of all members [m]."""
        extents = (member.section.outline.extent() for member in self.scene.members.values())
        return max(high - low for low, high in extents)
