"""A scene's members, cut into rigid pieces and joined."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import pymunk

from scene import MemberEnd, Node, Scene
from sim.body_loads import BodyLoad, body_loads
from sim.followed import check_followed
from sim.joint import DuctileJoint
from sim.laws import Bearing, ElasticPlastic
from sim.limits import NO_LIMITS, Limits
from sim.member_laws import MemberLaws
from sim.model import MemberModel, Model
from sim.pieces import NodePoint, Piece, Pieces, Span
from sim.rules import Rule, member_rule
from sim.shapes import keep_neighbours_apart
from sim.structure import Structure

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


@dataclass(frozen=True)
class Assembly:
    """A scene as pymunk bodies and joints, ready to step.

    Attributes
    ----------
    space : pymunk.Space
        Holds all bodies and joints.
    joints : tuple of DuctileJoint
        Those of the members first, in the order of ``places``; then supports.
    structure : Structure
        All of them as one, as long as none breaks and nothing else is joined to them.
    pieces : tuple of Piece
    spans : tuple of Span
        The pieces, and the bits of members that belong to nodes.
    places : tuple of JointPlace
    nodes : dict[str, NodePoint]
        Where each node is.
    dead_loads : tuple of BodyLoad
        To be made to act before each step.
    sudden_loads : tuple of BodyLoad
        Those that a motion begins with; to be made to act before each of its steps.
    pattern : tuple of BodyLoad
        Proportional loads at a load factor of 1.
    settlements : tuple of Settlement
        Of supports, all of which are there from the start unless `settle` lets them grow.
    """

    space: pymunk.Space
    joints: tuple[DuctileJoint, ...]
    structure: Structure
    pieces: tuple[Piece, ...]
    spans: tuple[Span, ...]
    places: tuple[JointPlace, ...]
    nodes: dict[str, NodePoint]
    dead_loads: tuple[BodyLoad, ...]
    sudden_loads: tuple[BodyLoad, ...]
    pattern: tuple[BodyLoad, ...]
    settlements: tuple[Settlement, ...]

    @property
    def grounds(self) -> tuple[pymunk.Body, ...]:
        """What supports are fixed to: the world, and what settles."""
        return (self.space.static_body, *(support.body for support in self.settlements))

    def step(self, dt: float, share: float = 1.0, *, sudden: bool = False) -> None:
        """Step the space by ``dt`` [s], with a share of the dead loads acting, and the sudden ones if wanted."""
        for load in self.dead_loads:
            load.act(share)
        if sudden:
            for load in self.sudden_loads:
                load.act()
        self.space.step(dt)


def assemble(
    scene: Scene,
    model: Model,
    space: pymunk.Space | None = None,
    *,
    limits: Mapping[str, Limits] | None = None,
    shapes: bool = True,
) -> Assembly:
    """Bodies and joints for ``scene``.

    Parameters
    ----------
    scene : Scene
    model : Model
    space : pymunk.Space, optional
        Where to put them; by default a space of their own with the scene's gravity and the model's iterations.
    limits : mapping, optional
        By member, when its joints break; those not named do not.
    shapes : bool
        Give the pieces shapes as deep as their sections, so that other things touch them. The parts of a structure that
        a joint holds together pass through each other.

    Raises
    ------
    ValueError
        When ``model`` names an unknown rule or law, or too few joints.
    InputError
        When its hinges are too long for a member, or the scene has what joints do not follow.
    """
    check_followed(scene)
    laws = MemberLaws(scene, model)
    rules = {name: _rule(scene, name, model.of(name)) for name in scene.members}
    if space is None:
        space = pymunk.Space()
        space.iterations = model.iterations
        space.gravity = (0.0, -scene.gravity)
    builder = _Builder(scene, model, laws, limits or {}, Pieces(scene, rules, space))
    for name in scene.members:
        builder.join(name)
    for name, body in builder.pieces.at_node.items():
        builder.support(name, body)
    nodes = builder.pieces.node_points()
    if shapes:
        builder.pieces.add_shapes()
        keep_neighbours_apart(space, builder.pieces.bodies(), builder.pieces.greatest_depth())
    spans = tuple(span for name in scene.members for span in builder.pieces.spans(name))
    structure = Structure(builder.joints)
    space.add(*builder.joints)
    return Assembly(
        space=space,
        joints=tuple(builder.joints),
        structure=structure,
        pieces=tuple(piece for pieces in builder.pieces.of.values() for piece in pieces),
        spans=spans,
        places=tuple(builder.places),
        nodes=nodes,
        dead_loads=body_loads(scene, "dead", spans, nodes),
        sudden_loads=body_loads(scene, "step", spans, nodes),
        pattern=body_loads(scene, "proportional", spans, nodes),
        settlements=tuple(builder.settlements),
    )


def _rule(scene: Scene, name: str, model: MemberModel) -> Rule:
    hinge = model.hinge_length
    if hinge is None:
        low, high = scene.members[name].section.outline.extent()
        hinge = high - low
    return member_rule(model.rule, model.joints, hinge, name, scene.axis(name)[2])


class _Builder:
    """The joints of `assemble`."""

    def __init__(
        self, scene: Scene, model: Model, laws: MemberLaws, limits: Mapping[str, Limits], pieces: Pieces
    ) -> None:
        self.scene, self.model, self.laws, self.limits, self.pieces = scene, model, laws, limits, pieces
        self.ground = pieces.space.static_body
        self.places: list[JointPlace] = []
        self.joints: list[DuctileJoint] = []
        self.settlements: list[Settlement] = []

    def join(self, name: str) -> None:
        """Joints of one member, from its start to its end."""
        member, rule = self.scene.members[name], self.pieces.rules[name]
        c, s, length = self.scene.axis(name)
        x0, y0 = self.scene.nodes[member.start].at
        own = [piece.body for piece in self.pieces.of[name]]
        chain = [self._beyond(member.start), *own, self._beyond(member.end)]
        for i, (a, b) in enumerate(itertools.pairwise(chain)):
            if a is None or b is None:
                continue
            position, share = float(rule.points[i] * length), float(rule.weights[i] * length)
            first, last = i == 0, i == len(chain) - 2
            pinned = (first and self._is_hinge(name, "from")) or (last and self._is_hinge(name, "to"))
            law = self.laws.joint(name, share, pinned=pinned, elastic=bool(rule.elastic[i]))
            at = (x0 + c * position, y0 + s * position)
            k = law.elastic_tangent()
            joint = DuctileJoint(
                a,
                b,
                at,
                law,
                direction=math.atan2(s, c),
                turn=0.5,
                length=share,
                damping=(self.model.damping * k[0], self.model.damping * k[3], self.model.damping * k[5]),
                limits=self.limits.get(name, NO_LIMITS),
                scheme=self.model.scheme,
            )
            self._add(joint)
            self.places.append(JointPlace(name, position, share))

    def _add(self, joint: DuctileJoint) -> None:
        if self.ground in (joint.a, joint.b):
            joint.collide_bodies = False  # a foot stands in the ground that holds it
        self.joints.append(joint)

    def _beyond(self, node: str) -> pymunk.Body | None:
        """What a member's end is joined to at ``node``."""
        if node in self.pieces.at_node:
            return self.pieces.at_node[node]
        return None if self.scene.nodes[node].support == "free" else self.ground

    def _is_hinge(self, name: str, end: MemberEnd) -> bool:
        """Whether a member's end bears no moment."""
        member = self.scene.members[name]
        node = member.start if end == "from" else member.end
        held_by_ground = node not in self.pieces.at_node
        return end in member.releases or (held_by_ground and self.scene.nodes[node].support == "pinned")

    def support(self, name: str, body: pymunk.Body) -> None:
        """Rigid springs to the ground where the node of ``body`` is supported, and the node's own spring."""
        node, members = self.scene.nodes[name], self.pieces.meeting[name]
        if any(node.held):
            k = RIGID * max(self.scene.capacity(m).EA / self.scene.axis(m)[2] for m in members)
            turn = RIGID * max(self.scene.capacity(m).EI / self.scene.axis(m)[2] for m in members)
            x, y, rotation = (stiffness * held for stiffness, held in zip((k, k, turn), node.held, strict=True))
            if node.settlement == (0.0, 0.0):
                self._to_ground(self.ground, node, body, (x, y, rotation))
            else:
                # Outside the space, so that nothing but `settle` moves it.
                support = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
                self._to_ground(support, node, body, (x, y, rotation))
                support.position = way = (float(node.settlement[0]), float(node.settlement[1]))
                self.settlements.append(Settlement(support, way))
        if node.bearing:
            law = Bearing(float(node.bearing))
            upwards = 0.5 * math.pi
            self._add(DuctileJoint(self.ground, body, node.at, law, direction=upwards, scheme=self.model.scheme))
        if node.spring is not None:
            x, y, rotation = map(float, node.spring)
            self._to_ground(self.ground, node, body, (x, y, rotation))

    def _to_ground(
        self, ground: pymunk.Body, node: Node, body: pymunk.Body, stiffness: tuple[float, float, float]
    ) -> None:
        law = ElasticPlastic(stiffness, (math.inf, math.inf, math.inf))
        self._add(DuctileJoint(ground, body, node.at, law, direction=0.0, scheme=self.model.scheme))
