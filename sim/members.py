"""A scene's members, cut into rigid pieces and joined."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from dataclasses import dataclass

import pymunk

from scene import Scene
from sim.joint import DuctileJoint
from sim.laws import ElasticPlastic, FibreSection, Law
from sim.rules import RULES, Rule
from sim.structure import Structure

#: A spring that counts as rigid is this much stiffer than the members it is tied to.
RIGID = 1e2
#: Shear stiffness of an Euler–Bernoulli member, which has none of its own to give way, over EI / L²: shear adds 3e-5
#: to the deflection of a cantilever and 5e-4 to that of a beam fixed at both ends.
_SHEAR_RIGID = 1e5
#: Share of a member's end piece that belongs to the body of a node where several members meet.
_NODE_SHARE = 0.1


@dataclass(frozen=True)
class Model:
    """How a scene is turned into rigid bodies, and how these are stepped.

    Attributes
    ----------
    rule : str
        ``"lobatto"`` or ``"equal"``: where the joints of a member go.
    joints : int
        Points of the rule in each member; the one at a free end needs no joint.
    law : str
        ``"elastic-plastic"`` or ``"fibre"``.
    fibres : int
        Fibres a section, for the fibre law; a multiple of 4.
    dt : float
        Step [s].
    iterations : int
        Iterations of Chipmunk's solver in a step.
    """

    rule: str
    joints: int
    law: str
    fibres: int = 8
    dt: float = 1.0 / 60.0
    iterations: int = 2


@dataclass(frozen=True)
class Piece:
    """A rigid piece of a member, from ``start`` to ``end`` along it [m]."""

    body: pymunk.Body
    member: str
    start: float
    end: float


@dataclass(frozen=True)
class JointPlace:
    """Where a joint sits: ``position`` along ``member`` [m], standing for ``length`` of it [m]."""

    member: str
    position: float
    length: float


@dataclass(frozen=True)
class Assembly:
    """A scene as pymunk bodies and joints, ready to step.

    Attributes
    ----------
    space : pymunk.Space
        Holds all bodies and the structure.
    structure : Structure
        Joints of the members first, in the order of ``places``; then supports, then the pusher.
    pieces : tuple of Piece
    places : tuple of JointPlace
    pusher : pymunk.Body
        Kinematic body that pushes the scene's node through the structure's last joint.
    """

    space: pymunk.Space
    structure: Structure
    pieces: tuple[Piece, ...]
    places: tuple[JointPlace, ...]
    pusher: pymunk.Body

    def pushed_point(self) -> tuple[float, float]:
        """Where the pushed node is now [m]."""
        last = self.structure.joints[-1]
        x, y = last.b.local_to_world((last.geometry[2], last.geometry[3]))
        return x, y


def joint_law(scene: Scene, name: str, length: float, model: Model, pinned: bool = False) -> Law:
    """Law of a joint that stands for ``length`` [m] of the member ``name``; a pinned one bears no moment."""
    member, c = scene.members[name], scene.capacity(name)
    shear = c.GA_s
    if member.theory == "euler-bernoulli":
        shear = _SHEAR_RIGID * c.EI / scene.axis(name)[2] ** 2
    if pinned:
        return ElasticPlastic((c.EA / length, shear / length, 0.0), (c.N_max, c.Q_max, 0.0))
    if model.law == "elastic-plastic":
        return ElasticPlastic((c.EA / length, shear / length, c.EI / length), (c.N_max, c.Q_max, c.M_max))
    if model.law == "fibre":
        fibres, material = member.section.fibres(model.fibres), member.material
        return FibreSection(
            length=length,
            y=fibres.y,
            area=fibres.area,
            youngs_modulus=material.youngs_modulus,
            yield_stress=material.yield_stress,
            tangent_modulus=material.tangent_modulus,
            shear_stiffness=shear / length,
            shear_capacity=c.Q_max,
        )
    raise ValueError(f'there is no joint law "{model.law}"; the laws are elastic-plastic and fibre')


def assemble(scene: Scene, model: Model) -> Assembly:
    """Bodies and joints for ``scene`` in a space of their own.

    Raises
    ------
    ValueError
        When ``model`` names an unknown rule or law.
    """
    if model.rule not in RULES:
        raise ValueError(f'there is no rule "{model.rule}"; the rules are {", ".join(RULES)}')
    rule = RULES[model.rule](model.joints)
    space = pymunk.Space()
    space.iterations = model.iterations
    space.gravity = (0.0, -scene.gravity)
    builder = _Builder(scene, model, rule, space)
    for name in scene.members:
        builder.cut(name)
    for name in scene.members:
        builder.join(name)
    builder.support()
    stiffest = max(scene.capacity(name).EA / scene.axis(name)[2] for name in scene.members)
    pusher = builder.add_pusher(RIGID * stiffest)
    structure = Structure(builder.joints)
    space.add(*structure.joints)
    return Assembly(space, structure, tuple(builder.pieces), tuple(builder.places), pusher)


class _Builder:
    """The work of `assemble`."""

    def __init__(self, scene: Scene, model: Model, rule: Rule, space: pymunk.Space) -> None:
        self.scene, self.model, self.rule, self.space = scene, model, rule, space
        self.pieces: list[Piece] = []
        self.places: list[JointPlace] = []
        self.joints: list[DuctileJoint] = []
        self.meeting: dict[str, list[str]] = defaultdict(list)
        for name, member in scene.members.items():
            self.meeting[member.start].append(name)
            self.meeting[member.end].append(name)
        self.node_body: dict[str, pymunk.Body] = {}
        self._make_node_bodies()

    def _make_node_bodies(self) -> None:
        """A body for each node where members meet, of the first bit of each."""
        for node, names in self.meeting.items():
            if len(names) < 2:
                continue
            x, y = self.scene.nodes[node].at
            parts = []
            for name in names:
                c, s, length = self.scene.axis(name)
                first = length * (self.rule.points[1] - self.rule.points[0]) * _NODE_SHARE
                side = 1.0 if self.scene.members[name].start == node else -1.0
                mass, moment = self._inertia(name, first)
                parts.append((mass, moment, x + 0.5 * side * c * first, y + 0.5 * side * s * first))
            mass = sum(part[0] for part in parts)
            cx = sum(m * px for m, _, px, _ in parts) / mass
            cy = sum(m * py for m, _, _, py in parts) / mass
            moment = sum(i + m * ((px - cx) ** 2 + (py - cy) ** 2) for m, i, px, py in parts)
            self.node_body[node] = self._add_body(mass, moment, cx, cy, 0.0)

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

    def cut(self, name: str) -> None:
        """Rigid pieces of one member."""
        member = self.scene.members[name]
        c, s, length = self.scene.axis(name)
        x0, y0 = self.scene.nodes[member.start].at
        stops = (self.rule.points * length).tolist()
        if member.start in self.node_body:
            stops[0] += _NODE_SHARE * (stops[1] - stops[0])
        if member.end in self.node_body:
            stops[-1] -= _NODE_SHARE * (stops[-1] - stops[-2])
        for start, end in itertools.pairwise(stops):
            mass, moment = self._inertia(name, end - start)
            middle = 0.5 * (start + end)
            body = self._add_body(mass, moment, x0 + c * middle, y0 + s * middle, math.atan2(s, c))
            self.pieces.append(Piece(body, name, start, end))

    def join(self, name: str) -> None:
        """Joints of one member, from its start to its end."""
        member = self.scene.members[name]
        c, s, length = self.scene.axis(name)
        x0, y0 = self.scene.nodes[member.start].at
        own = [piece.body for piece in self.pieces if piece.member == name]
        chain = [self._beyond(member.start), *own, self._beyond(member.end)]
        for i, (a, b) in enumerate(itertools.pairwise(chain)):
            if a is None or b is None:
                continue
            position, share = float(self.rule.points[i] * length), float(self.rule.weights[i] * length)
            pinned = (i == 0 and self._is_hinge(member.start)) or (b is chain[-1] and self._is_hinge(member.end))
            law = joint_law(self.scene, name, share, self.model, pinned)
            at = (x0 + c * position, y0 + s * position)
            self.joints.append(DuctileJoint(a, b, at, law, direction=math.atan2(s, c), turn=0.5))
            self.places.append(JointPlace(name, position, share))

    def _beyond(self, node: str) -> pymunk.Body | None:
        """What a member's end is joined to at ``node``."""
        if node in self.node_body:
            return self.node_body[node]
        return None if self.scene.nodes[node].support == "free" else self.space.static_body

    def _is_hinge(self, node: str) -> bool:
        return node not in self.node_body and self.scene.nodes[node].support == "pinned"

    def support(self) -> None:
        """Rigid springs to the ground for the node bodies that are supported."""
        for node, body in self.node_body.items():
            kind = self.scene.nodes[node].support
            if kind == "free":
                continue
            names = self.meeting[node]
            k = RIGID * max(self.scene.capacity(m).EA / self.scene.axis(m)[2] for m in names)
            turn = RIGID * max(self.scene.capacity(m).EI / self.scene.axis(m)[2] for m in names)
            law = ElasticPlastic((k, k, turn if kind == "clamped" else 0.0), (math.inf, math.inf, math.inf))
            self.joints.append(
                DuctileJoint(self.space.static_body, body, self.scene.nodes[node].at, law, direction=0.0)
            )

    def add_pusher(self, stiffness: float) -> pymunk.Body:
        """Kinematic body at the pushed node, tied to it along the push only."""
        node = self.scene.push.node
        x, y = self.scene.nodes[node].at
        pushed = self.node_body.get(node) or next(
            piece.body
            for piece in (self.pieces if self.scene.members[self.meeting[node][0]].start == node else self.pieces[::-1])
            if piece.member == self.meeting[node][0]
        )
        pusher = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        pusher.position = (x, y)
        self.space.add(pusher)
        dx, dy = self.scene.push_direction()
        law = ElasticPlastic((stiffness, 0.0, 0.0), (math.inf, math.inf, math.inf))
        self.joints.append(DuctileJoint(pusher, pushed, (x, y), law, direction=math.atan2(dy, dx)))
        return pusher
