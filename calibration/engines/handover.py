"""A scene's bodies and joints in plain mechanical terms, before an engine's own words are put to them.

Joints are elastic–perfectly plastic with N, Q and M capped one by one: what a joint of a game engine can be made to do.
A joint's frequency and damping ratio are those of its rotation,

    f = √(k / I) / 2π,   c = 2 ζ √(k I),   1 / I = 1 / I_a + 1 / I_b,

with I_a and I_b about the bodies' centres, as engines define them; a body that is held has none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import pymunk

from capacity import InputError, rotation_capacity
from scene import Scene
from sim import Assembly, DuctileJoint, Model, assemble
from sim.body_loads import BodyLoad

#: Law that every engine is given.
LAW = "elastic-plastic"


@dataclass(frozen=True)
class RigidPiece:
    """A rigid body; SI units.

    Attributes
    ----------
    name : str
        Member and number of the piece, or node.
    mass, moment : float
        [kg], and [kg m²] about the centre of gravity.
    x, y, angle : float
        Where it lies [m, m, rad]; its length runs along the angle.
    length, depth : float
        Of a box around it [m]; both 0 for the body of a node.
    """

    name: str
    mass: float
    moment: float
    x: float
    y: float
    angle: float
    length: float
    depth: float


@dataclass(frozen=True)
class JointTerms:
    """A joint; SI units, inf where nothing limits it.

    Attributes
    ----------
    name : str
        The member and where along it, or the support.
    a, b : int
        Numbers of the bodies; -1 for the world.
    at, anchor_a, anchor_b : (float, float)
        The joint in world coordinates and from each body's centre, in its own axes [m].
    direction : float
        Angle of the axis that N acts along [rad].
    stiffness : (float, float, float)
        Axial, shear [N/m] and rotational [N m/rad]; 0 where the joint lets go.
    capacity : (float, float, float)
        N_max, Q_max [N] and M_max [N m].
    rest_angle : float
        Rotation of b less that of a without moment [rad].
    inertia : float
        I of the two bodies against each other [kg m²].
    damping_ratio : float
        ζ of the rotation [-].
    break_rotation : float
        Plastic rotation at which it breaks [rad].
    """

    name: str
    a: int
    b: int
    at: tuple[float, float]
    anchor_a: tuple[float, float]
    anchor_b: tuple[float, float]
    direction: float
    stiffness: tuple[float, float, float]
    capacity: tuple[float, float, float]
    rest_angle: float
    inertia: float
    damping_ratio: float
    break_rotation: float

    @property
    def frequency(self) -> float:
        """Natural frequency of the rotation [Hz]."""
        return math.sqrt(self.stiffness[2] / self.inertia) / math.tau

    @property
    def damping(self) -> float:
        """Viscous damping of the rotation [N m s/rad]."""
        return 2.0 * self.damping_ratio * math.sqrt(self.stiffness[2] * self.inertia)

    @property
    def yield_rotation(self) -> float:
        """Elastic rotation at which M_max is reached [rad]."""
        return self.capacity[2] / self.stiffness[2] if self.stiffness[2] > 0.0 else math.inf

    @property
    def turns_freely(self) -> bool:
        """Whether it is a hinge without moment."""
        return self.stiffness[2] == 0.0

    @property
    def slide(self) -> float | None:
        """Angle along which it lets the bodies slide, if it does [rad]."""
        if self.stiffness[0] == 0.0:
            return self.direction
        return self.direction + 0.5 * math.pi if self.stiffness[1] == 0.0 else None


@dataclass(frozen=True)
class PieceLoad:
    """A force [N] with a fixed direction at a point of a body [m, own axes], and a moment [N m]."""

    body: int
    force: tuple[float, float]
    moment: float
    point: tuple[float, float]


@dataclass(frozen=True)
class PushPoint:
    """What is pushed: a point of a body [m, own axes], along a unit vector."""

    body: int
    point: tuple[float, float]
    direction: tuple[float, float]


@dataclass(frozen=True)
class Handover:
    """What is handed over.

    Attributes
    ----------
    name : str
        What the scene is called.
    gravity : float
        Downwards [m/s²].
    model : Model
        The cut that the bodies come from, with the step and the iterations to use.
    bodies : tuple of RigidPiece
    joints : tuple of JointTerms
    dead_loads, pattern : tuple of PieceLoad
        Loads that are always there, and those that the push multiplies.
    push : PushPoint, optional
        Where the scene is pushed, if it is.
    """

    name: str
    gravity: float
    model: Model
    bodies: tuple[RigidPiece, ...]
    joints: tuple[JointTerms, ...]
    dead_loads: tuple[PieceLoad, ...]
    pattern: tuple[PieceLoad, ...]
    push: PushPoint | None


def hand_over(scene: Scene, model: Model, name: str = "", damping_ratio: float = 0.2) -> Handover:
    """Bodies and joints of ``scene`` cut as ``model`` says.

    Raises
    ------
    InputError
        When the scene has no members.
    ValueError
        When the model's law is not the one that engines are given.
    """
    if model.law != LAW:
        raise ValueError(f'engines are given the law "{LAW}", not "{model.law}"')
    if not scene.members:
        raise InputError(
            "members",
            "the scene has none, and what is handed over are members cut into bodies and joints",
            "name a scene with members; joints between loose bodies have their numbers in the scene file",
        )
    assembly = assemble(scene, model, shapes=False)
    bodies = list(assembly.space.bodies)
    number = {body: i for i, body in enumerate(bodies)} | dict.fromkeys(assembly.grounds, -1)

    def numbered(loads: Sequence[BodyLoad]) -> tuple[PieceLoad, ...]:
        return tuple(PieceLoad(number[load.body], load.force, load.moment, load.point) for load in loads)

    return Handover(
        name=name or scene.title,
        gravity=float(scene.gravity),
        model=model,
        bodies=tuple(_pieces(scene, assembly, bodies)),
        joints=tuple(_joints(scene, assembly, number, damping_ratio)),
        dead_loads=numbered(assembly.dead_loads),
        pattern=numbered(assembly.pattern),
        push=_push(scene, assembly, number),
    )


def _push(scene: Scene, assembly: Assembly, number: dict[pymunk.Body, int]) -> PushPoint | None:
    if scene.pushed is None:
        return None
    node = assembly.nodes[scene.push.node]
    return PushPoint(number[node.body], node.point, scene.push_direction())


def _pieces(scene: Scene, assembly: Assembly, bodies: list[pymunk.Body]) -> list[RigidPiece]:
    pieces = {piece.body: piece for piece in assembly.pieces}
    counts: dict[str, int] = {}
    found = []
    for body in bodies:
        piece = pieces.get(body)
        kind = "node" if piece is None else piece.member
        counts[kind] = counts.get(kind, 0) + 1
        length = 0.0 if piece is None else piece.end - piece.start
        depth = 0.0 if piece is None else scene.members[piece.member].section.depth
        x, y = body.position
        found.append(RigidPiece(f"{kind}.{counts[kind]}", body.mass, body.moment, x, y, body.angle, length, depth))
    return found


def _joints(scene: Scene, assembly: Assembly, number: dict[pymunk.Body, int], damping_ratio: float) -> list[JointTerms]:
    found = []
    breaks = {member: _break_rotation(scene, member) for member in scene.members}
    for i, joint in enumerate(assembly.joints):
        place = assembly.places[i] if i < len(assembly.places) else None
        tangent = joint.law.elastic_tangent()
        found.append(
            JointTerms(
                name=f"support.{i}" if place is None else f"{place.member} at {place.position:.4g} m",
                a=number[joint.a],
                b=number[joint.b],
                at=joint.at,
                anchor_a=(joint.geometry[0], joint.geometry[1]),
                anchor_b=(joint.geometry[2], joint.geometry[3]),
                direction=joint.direction,
                stiffness=(tangent[0], tangent[3], tangent[5]),
                capacity=joint.law.capacities(),
                rest_angle=joint.b.angle - joint.a.angle,
                inertia=_inertia(joint),
                damping_ratio=damping_ratio,
                break_rotation=math.inf if place is None else breaks[place.member],
            )
        )
    return found


def _inertia(joint: DuctileJoint) -> float:
    moving = [body.moment for body in (joint.a, joint.b) if body.body_type == pymunk.Body.DYNAMIC]
    return 1.0 / sum(1.0 / moment for moment in moving)


def _break_rotation(scene: Scene, member: str) -> float:
    """Plastic rotation at break, of materials whose ultimate strain is known."""
    section, material = scene.members[member].section, scene.members[member].material
    strains = [(part.material or material).stress_strain.ultimate_strain for part in section.parts]
    if math.inf in strains:
        return math.inf
    return rotation_capacity(section, material).plastic_rotation
