"""The joints of a scene's members, and those that support its nodes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import pymunk

from scene import MemberEnd, Node, Scene
from sim.joint import DuctileJoint
from sim.laws import Bearing, ElasticPlastic, Law
from sim.limits import NO_LIMITS, Limits
from sim.member_laws import MemberLaws
from sim.model import Model
from sim.pieces import Pieces
from sim.rules import Rule

#: A spring that counts as rigid is this much stiffer than the members it is tied to.
RIGID = 1e4


@dataclass(frozen=True)
class JointPlace:
    """Where a joint sits: ``position`` along ``member`` [m], standing for ``length`` of it [m]."""

    member: str
    position: float
    length: float


@dataclass(frozen=True)
class Settlement:
    """What a support that settles is fixed to, a body that starts at the origin, and how far that goes [m]."""

    body: pymunk.Body
    way: tuple[float, float]


#: The joint at each point of a member's rule, and where it is; None at a free end.
Joined = list[tuple[DuctileJoint, JointPlace] | None]


class MemberJoints:
    """Makes joints for the ``pieces`` of ``scene``, by the laws that ``model`` wants.

    Attributes
    ----------
    settlements : list of Settlement
        Of the supports made so far.
    """

    def __init__(
        self, scene: Scene, model: Model, laws: MemberLaws, limits: Mapping[str, Limits], pieces: Pieces
    ) -> None:
        self.scene, self.model, self.pieces = scene, model, pieces
        self._laws, self._limits = laws, limits
        self._ground = pieces.space.static_body
        self.settlements: list[Settlement] = []

    def law(self, name: str, rule: Rule, index: int) -> Law:
        """Law of the joint at point ``index`` of a member's rule."""
        pinned = (index == 0 and self._is_hinge(name, "from")) or (
            index == len(rule.points) - 1 and self._is_hinge(name, "to")
        )
        length = float(rule.weights[index] * self.scene.axis(name)[2])
        return self._laws.joint(name, length, pinned=pinned, elastic=bool(rule.elastic[index]))

    def place(self, name: str, rule: Rule, index: int) -> JointPlace:
        """Where that joint is."""
        length = self.scene.axis(name)[2]
        return JointPlace(name, float(rule.points[index] * length), float(rule.weights[index] * length))

    def chain(self, name: str, bodies: Sequence[pymunk.Body]) -> list[tuple[pymunk.Body, pymunk.Body] | None]:
        """What the joints of a member connect, one for each point of its rule; None at a free end."""
        member = self.scene.members[name]
        ends = [self._beyond(member.start), *bodies, self._beyond(member.end)]
        return [None if a is None or b is None else (a, b) for a, b in itertools.pairwise(ends)]

    def joint(
        self, name: str, law: Law, place: JointPlace, between: tuple[pymunk.Body, pymunk.Body], at: tuple[float, float]
    ) -> DuctileJoint:
        """A joint of a member, at the world position ``at`` [m], free of force as its bodies lie."""
        c, s, _ = self.scene.axis(name)
        k = law.elastic_tangent()
        turn, length = 0.5, place.length
        if k[5] == 0.0:  # a hinge stands for no arc, and its axes stay with the member
            turn, length = float(place.position == 0.0), 0.0
        return self._apart(
            DuctileJoint(
                *between,
                at,
                law,
                direction=math.atan2(s, c),
                turn=turn,
                length=length,
                damping=(self.model.damping * k[0], self.model.damping * k[3], self.model.damping * k[5]),
                limits=self._limits.get(name, NO_LIMITS),
                scheme=self.model.scheme,
            )
        )

    def all_of(self, name: str, rule: Rule) -> Joined:
        """The joints of one member, from its start to its end, its pieces lying along its axis."""
        c, s, _ = self.scene.axis(name)
        x0, y0 = self.scene.nodes[self.scene.members[name].start].at
        joined: Joined = []
        for i, between in enumerate(self.chain(name, [piece.body for piece in self.pieces.of[name]])):
            place = self.place(name, rule, i)
            at = (x0 + c * place.position, y0 + s * place.position)
            joined.append(between and (self.joint(name, self.law(name, rule, i), place, between, at), place))
        return joined

    def _apart(self, joint: DuctileJoint) -> DuctileJoint:
        # Neighbours pass through each other until they have come apart, see `sim.shapes`; a foot stands in the ground.
        joint.collide_bodies = self._ground not in (joint.a, joint.b)
        return joint

    def _beyond(self, node: str) -> pymunk.Body | None:
        """What a member's end is joined to at ``node``."""
        if node in self.pieces.at_node:
            return self.pieces.at_node[node]
        return None if self.scene.nodes[node].support == "free" else self._ground

    def _is_hinge(self, name: str, end: MemberEnd) -> bool:
        """Whether a member's end bears no moment."""
        member = self.scene.members[name]
        node = member.start if end == "from" else member.end
        held_by_ground = node not in self.pieces.at_node
        return end in member.releases or (held_by_ground and self.scene.nodes[node].support == "pinned")

    def supports(self, name: str, body: pymunk.Body) -> list[DuctileJoint]:
        """Rigid springs to the ground where the node of ``body`` is supported, and the node's own spring."""
        node, members, joints = self.scene.nodes[name], self.pieces.meeting[name], []
        if any(node.held):
            k = RIGID * max(self.scene.capacity(m).EA / self.scene.axis(m)[2] for m in members)
            turn = RIGID * max(self.scene.capacity(m).EI / self.scene.axis(m)[2] for m in members)
            x, y, rotation = (stiffness * held for stiffness, held in zip((k, k, turn), node.held, strict=True))
            if node.settlement == (0.0, 0.0):
                joints.append(self._to(self._ground, node, body, (x, y, rotation)))
            else:
                # Outside the space, so that nothing but `settle` moves it.
                support = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
                joints.append(self._to(support, node, body, (x, y, rotation)))
                support.position = way = (float(node.settlement[0]), float(node.settlement[1]))
                self.settlements.append(Settlement(support, way))
        if node.bearing:
            law, upwards = Bearing(float(node.bearing)), 0.5 * math.pi
            joint = DuctileJoint(self._ground, body, node.at, law, direction=upwards, scheme=self.model.scheme)
            joints.append(self._apart(joint))
        if node.spring is not None:
            x, y, rotation = map(float, node.spring)
            joints.append(self._to(self._ground, node, body, (x, y, rotation)))
        return joints

    def _to(
        self, ground: pymunk.Body, node: Node, body: pymunk.Body, stiffness: tuple[float, float, float]
    ) -> DuctileJoint:
        law = ElasticPlastic(stiffness, (math.inf, math.inf, math.inf))
        return self._apart(DuctileJoint(ground, body, node.at, law, direction=0.0, scheme=self.model.scheme))
