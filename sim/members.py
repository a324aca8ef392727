"""A scene's members, cut into rigid pieces and joined."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from dataclasses import dataclass

import pymunk

from scene import LoadKind, MemberEnd, Scene
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
        Fibres a section, for the fibre law; at least 4.
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
class BodyLoad:
    """A force [N] on a body at a point of it, and a moment [N m]; both keep their direction."""

    body: pymunk.Body
    force: tuple[float, float]
    moment: float
    point: tuple[float, float]

    def act(self, share: float) -> None:
        """Act with a share of the load on the body in the next step."""
        force = (share * self.force[0], share * self.force[1])
        self.body.apply_force_at_world_point(force, self.body.local_to_world(self.point))
        self.body.torque += share * self.moment


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
    dead_loads : tuple of BodyLoad
        To be made to act before each step.
    pattern : tuple of BodyLoad
        Proportional loads at a load factor of 1.
    """

    space: pymunk.Space
    structure: Structure
    pieces: tuple[Piece, ...]
    places: tuple[JointPlace, ...]
    pusher: pymunk.Body
    dead_loads: tuple[BodyLoad, ...]
    pattern: tuple[BodyLoad, ...]

    def step(self, dt: float, share: float = 1.0) -> None:
        """Step the space by ``dt`` [s], with a share of the dead loads acting."""
        for load in self.dead_loads:
            load.act(share)
        self.space.step(dt)

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
    InputError
        When the scene has no push.
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
    return Assembly(
        space=space,
        structure=structure,
        pieces=tuple(builder.pieces),
        places=tuple(builder.places),
        pusher=pusher,
        dead_loads=tuple(builder.loads("dead")),
        pattern=tuple(builder.loads("proportional")),
    )


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
        """A body for each node where members meet, or that is more than a clamp or a hinge at a member's end.

        It is made of the first bit of each member there, and of the node's own mass.
        """
        for name, members in self.meeting.items():
            node = self.scene.nodes[name]
            plain = node.support in ("free", "clamped", "pinned") and node.spring is None and node.mass == 0.0
            if len(members) == 1 and plain and node.settlement == (0.0, 0.0):
                continue
            x, y = node.at
            parts = [(float(node.mass), 0.0, x, y)]
            for member in members:
                c, s, length = self.scene.axis(member)
                first = length * (self.rule.points[1] - self.rule.points[0]) * _NODE_SHARE
                side = 1.0 if self.scene.members[member].start == name else -1.0
                mass, moment = self._inertia(member, first)
                parts.append((mass, moment, x + 0.5 * side * c * first, y + 0.5 * side * s * first))
            mass = sum(part[0] for part in parts)
            cx = sum(m * px for m, _, px, _ in parts) / mass
            cy = sum(m * py for m, _, _, py in parts) / mass
            moment = sum(i + m * ((px - cx) ** 2 + (py - cy) ** 2) for m, i, px, py in parts)
            self.node_body[name] = self._add_body(mass, moment, cx, cy, 0.0)

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
            first, last = i == 0, i == len(chain) - 2
            pinned = (first and self._is_hinge(name, "from")) or (last and self._is_hinge(name, "to"))
            law = joint_law(self.scene, name, share, self.model, pinned)
            at = (x0 + c * position, y0 + s * position)
            self.joints.append(DuctileJoint(a, b, at, law, direction=math.atan2(s, c), turn=0.5))
            self.places.append(JointPlace(name, position, share))

    def _beyond(self, node: str) -> pymunk.Body | None:
        """What a member's end is joined to at ``node``."""
        if node in self.node_body:
            return self.node_body[node]
        return None if self.scene.nodes[node].support == "free" else self.space.static_body

    def _is_hinge(self, name: str, end: MemberEnd) -> bool:
        """Whether a member's end bears no moment."""
        member = self.scene.members[name]
        node = member.start if end == "from" else member.end
        return end in member.releases or (node not in self.node_body and self.scene.nodes[node].support == "pinned")

    def support(self) -> None:
        """Rigid springs to the ground for the node bodies that are supported, and the nodes' own springs."""
        for name, body in self.node_body.items():
            node, members = self.scene.nodes[name], self.meeting[name]
            if any(node.held):
                k = RIGID * max(self.scene.capacity(m).EA / self.scene.axis(m)[2] for m in members)
                turn = RIGID * max(self.scene.capacity(m).EI / self.scene.axis(m)[2] for m in members)
                x, y, rotation = (stiffness * held for stiffness, held in zip((k, k, turn), node.held, strict=True))
                joint = self._to_ground(name, body, (x, y, rotation))
                # A support that settles pulls its node along: its spring is as long as the settlement at first.
                joint.geometry[0] += node.settlement[0]
                joint.geometry[1] += node.settlement[1]
            if node.spring is not None:
                x, y, rotation = map(float, node.spring)
                self._to_ground(name, body, (x, y, rotation))

    def _to_ground(self, node: str, body: pymunk.Body, stiffness: tuple[float, float, float]) -> DuctileJoint:
        law = ElasticPlastic(stiffness, (math.inf, math.inf, math.inf))
        joint = DuctileJoint(self.space.static_body, body, self.scene.nodes[node].at, law, direction=0.0)
        self.joints.append(joint)
        return joint

    def loads(self, kind: LoadKind) -> list[BodyLoad]:
        """The scene's loads of one kind, on the bodies that they act on."""
        loads: list[BodyLoad] = []
        for load in self.scene.loads_of(kind):
            if load.member is not None:
                for piece in self.pieces:
                    if piece.member == load.member:
                        span = piece.end - piece.start
                        force = (load.per_length[0] * span, load.per_length[1] * span)
                        loads.append(BodyLoad(piece.body, force, 0.0, (0.0, 0.0)))
            elif load.node is not None:
                body = self._carrier(load.node)
                point = body.world_to_local(self.scene.nodes[load.node].at)
                fx, fy = load.force
                loads.append(BodyLoad(body, (fx, fy), float(load.moment), (point.x, point.y)))
        return loads

    def _carrier(self, node: str) -> pymunk.Body:
        """The body that a node belongs to: its own, or the piece that ends there."""
        if node in self.node_body:
            return self.node_body[node]
        name = self.meeting[node][0]
        own = [piece.body for piece in self.pieces if piece.member == name]
        return own[0] if self.scene.members[name].start == node else own[-1]

    def add_pusher(self, stiffness: float) -> pymunk.Body:
        """Kinematic body at the pushed node, tied to it along the push only."""
        node = self.scene.push.node
        x, y = self.scene.nodes[node].at
        pushed = self._carrier(node)
        pusher = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        pusher.position = (x, y)
        self.space.add(pusher)
        dx, dy = self.scene.push_direction()
        law = ElasticPlastic((stiffness, 0.0, 0.0), (math.inf, math.inf, math.inf))
        self.joints.append(DuctileJoint(pusher, pushed, (x, y), law, direction=math.atan2(dy, dx)))
        return pusher
