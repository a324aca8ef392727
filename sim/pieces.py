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
from sim.rules import Rule
from sim.shapes import add_box

#: Share of a member's end piece that belongs to the body of a node where several members meet.
_NODE_SHARE = 0.1


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
        centre = body.local_to_world(body.center_of_gravity) + dt * body.velocity
        return np.array(centre + arm.rotated(body.angle + dt * body.angular_velocity))


class Pieces:
    """All rigid bodies of ``scene`` in ``space``, each member cut by its rule.

    Attributes
    ----------
    of : dict[str, list[Piece]]
        By member, from its start to its end.
    at_node : dict[str, pymunk.Body]
        Bodies of the nodes where members meet, or that are more than a clamp or a hinge at a member's end. Each is made
        of the first bit of each member there, and of the node's own mass.
    """

    def __init__(self, scene: Scene, rules: Mapping[str, Rule], space: pymunk.Space) -> None:
        self.scene, self.rules, self.space = scene, rules, space
        self.meeting: dict[str, list[str]] = defaultdict(list)
        for name, member in scene.members.items():
            self.meeting[member.start].append(name)
            self.meeting[member.end].append(name)
        self.at_node = {
            name: self._node_body(name, members) for name, members in self.meeting.items() if self._needs_body(name)
        }
        self.of = {name: self._cut(name) for name in scene.members}

    def bodies(self) -> list[pymunk.Body]:
        """All of them."""
        return [*self.at_node.values(), *(piece.body for pieces in self.of.values() for piece in pieces)]

    def spans(self, member: str) -> list[Span]:
        """The pieces of a member, and the bits of it that belong to its nodes."""
        first, last = self.scene.members[member].start, self.scene.members[member].end
        pieces, length = self.of[member], self.scene.axis(member)[2]
        spans = [self._span(piece.body, member, piece.start, piece.end) for piece in pieces]
        if first in self.at_node:
            spans.append(self._span(self.at_node[first], member, 0.0, pieces[0].start))
        if last in self.at_node:
            spans.append(self._span(self.at_node[last], member, pieces[-1].end, length))
        return spans

    def _span(self, body: pymunk.Body, member: str, start: float, end: float) -> Span:
        x, y = self.scene.nodes[self.scene.members[member].start].at
        c, s, _ = self.scene.axis(member)
        along = 0.5 * (start + end)
        mx, my = body.world_to_local((x + c * along, y + s * along))
        return Span(body, member, start, end, (mx, my))

    def node_points(self) -> dict[str, NodePoint]:
        """The nodes as points of the bodies that they belong to."""
        points = {}
        for name, members in self.meeting.items():
            body = self.at_node.get(name)
            if body is None:
                own = self.of[members[0]]
                body = own[0 if self.scene.members[members[0]].start == name else -1].body
            x, y = body.world_to_local(self.scene.nodes[name].at)
            points[name] = NodePoint(body, (x, y))
        return points

    def _needs_body(self, name: str) -> bool:
        node = self.scene.nodes[name]
        plain = node.support in ("free", "clamped", "pinned") and node.spring is None and node.mass == 0.0
        return len(self.meeting[name]) > 1 or not plain or node.settlement != (0.0, 0.0) or node.bearing > 0.0

    def _first_bit(self, member: str, node: str) -> tuple[float, float, float, float]:
        """What of ``member`` belongs to its ``node``: its length, the member's direction, and which way it goes on."""
        c, s, length = self.scene.axis(member)
        points = self.rules[member].points
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
        moment = mass * length**2 / 12.0
        if member.theory == "timoshenko":
            moment += member.material.density * member.section.second_moment_of_area * length
        return mass, moment

    def _add_body(self, mass: float, moment: float, x: float, y: float, angle: float) -> pymunk.Body:
        body = pymunk.Body(mass, moment)
        body.position = (x, y)
        body.angle = angle
        self.space.add(body)
        return body

    def _cut(self, name: str) -> list[Piece]:
        """Rigid pieces of one member."""
        member = self.scene.members[name]
        c, s, length = self.scene.axis(name)
        x0, y0 = self.scene.nodes[member.start].at
        stops = (self.rules[name].points * length).tolist()
        if member.start in self.at_node:
            stops[0] += self._first_bit(name, member.start)[0]
        if member.end in self.at_node:
            stops[-1] -= self._first_bit(name, member.end)[0]
        pieces = []
        for start, end in itertools.pairwise(stops):
            mass, moment = self._inertia(name, end - start)
            middle = 0.5 * (start + end)
            body = self._add_body(mass, moment, x0 + c * middle, y0 + s * middle, math.atan2(s, c))
            pieces.append(Piece(body, name, start, end))
        return pieces

    def add_shapes(self) -> None:
        """A box for each piece, and one for each member's bit of a node, as deep as the section."""
        for member in self.scene.members:
            for span in self.spans(member):
                self._add_box(span.body, member, span.start, span.end)

    def _add_box(self, body: pymunk.Body, member: str, start: float, end: float) -> None:
        x, y = self.scene.nodes[self.scene.members[member].start].at
        c, s, _ = self.scene.axis(member)
        low, high = self.scene.members[member].section.outline.extent()
        corners = [(start, low), (end, low), (end, high), (start, high)]
        add_box(body, [(x + c * u - s * v, y + s * u + c * v) for u, v in corners])

    def greatest_depth(self) -> float:
        """Of all members [m]."""
        extents = (member.section.outline.extent() for member in self.scene.members.values())
        return max(high - low for low, high in extents)
