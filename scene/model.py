"""What a scene consists of. These structs are the schema of a scene file, too."""

from __future__ import annotations

import math
from typing import Literal

import msgspec

from capacity import Capacity, InputError, Material, Section, capacity
from scene.actions import Load, LoadKind, Motion, Push, unit_vector
from scene.bodies import Body, Coefficient, Ground, Joint, Point
from scene.plane import Plane
from scene.programme import JointCount, Measure, Simulation
from scene.quantities import Acceleration, Angle, Length, Mass, RotationalStiffness, Speed, Stiffness, si
from scene.vehicles import Vehicle

Support = Literal["free", "pinned", "clamped", "roller-x", "roller-y", "guided-x", "guided-y"]
Theory = Literal["euler-bernoulli", "timoshenko"]
Kinematics = Literal["small", "p-delta", "large"]
Yielding = Literal["gradual", "ideal-hinges"]
MemberEnd = Literal["from", "to"]

#: Which of x, y and rotation each support holds.
HELD: dict[Support, tuple[bool, bool, bool]] = {
    "free": (False, False, False),
    "pinned": (True, True, False),
    "clamped": (True, True, True),
    "roller-x": (False, True, False),
    "roller-y": (True, False, False),
    "guided-x": (False, True, True),
    "guided-y": (True, False, True),
}


class Node(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A point where members begin, end or meet.

    Attributes
    ----------
    at : (Length, Length)
        Position x, y [m].
    support : str
        A key of `HELD`: ``"clamped"`` holds x, y and rotation, ``"pinned"`` x and y, ``"roller-x"`` is free to move
        along x and to turn, ``"guided-x"`` slides along x without turning; likewise with y; ``"free"`` holds nothing.
    spring : (Stiffness, Stiffness, RotationalStiffness), optional
        Elastic springs to the ground along x, y and in rotation [N/m, N/m, N m/rad].
    bearing : Stiffness
        Of a support under the node that holds it up and lets it go: it only pushes, upwards [N/m].
    settlement : (Length, Length)
        How far the support itself moves, before any push or motion [m].
    mass : Mass
        Mass of a body fixed to the node [kg].
    velocity : (Speed, Speed)
        Velocity of that body when a motion begins [m/s]; the node's own comes of the impact.
    """

    at: tuple[Length, Length]
    support: Support = "free"
    spring: tuple[Stiffness, Stiffness, RotationalStiffness] | None = None
    bearing: Stiffness = si(0.0)
    settlement: tuple[Length, Length] = (si(0.0), si(0.0))
    mass: Mass = si(0.0)
    velocity: tuple[Speed, Speed] = (si(0.0), si(0.0))

    @property
    def held(self) -> tuple[bool, bool, bool]:
        """Whether the support holds x, y and rotation."""
        return HELD[self.support]


class Profile(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What a member is made of.

    Attributes
    ----------
    section : Section
    material : Material
    theory : str
        ``"timoshenko"`` with shear flexibility, ``"euler-bernoulli"`` without.
    break_elongation, break_slip : Length, optional
        Plastic deformations of a joint at which it breaks in a simulation [m]; never by default.
    break_rotation : Angle, optional
        Likewise [rad].
    friction : float
        Of its surface, where something touches it in a simulation.
    joints : int, optional
        Points of the rule in a simulation, in place of the scene's `Simulation.joints`.
    """

    section: Section
    material: Material
    theory: Theory = "timoshenko"
    break_elongation: Length | None = None
    break_slip: Length | None = None
    break_rotation: Angle | None = None
    friction: Coefficient = 0.5
    joints: JointCount | None = None

    @property
    def mass_per_length(self) -> float:
        """∫ ρ dA [kg/m]."""
        return float(self.section.weighted(lambda m: m.density, self.material).moments()[0])


class Member(Profile, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A straight prismatic member from one node to another.

    Attributes
    ----------
    start, end : str
        Names of the nodes; written ``from`` and ``to``.
    releases : tuple of str
        Ends, ``"from"`` or ``"to"``, that are hinged to their node and so bear no moment.
    """

    start: str = msgspec.field(name="from")
    end: str = msgspec.field(name="to")
    releases: tuple[MemberEnd, ...] = ()


class Grid(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A frame of bays and storeys.

    Its nodes are called ``NAME-i-j``, column line i from the left and floor j from the ground, both from 0; its members
    ``NAME-column-i-j`` up to floor j, and ``NAME-beam-i-j`` to the right of column line i on floor j.

    Attributes
    ----------
    bays, storeys : tuple of Length
        Widths from the left and heights from the ground [m].
    columns, beams : Profile
    at : (Length, Length)
        Where the foot of the left column stands [m].
    support : str
        Of all feet.
    """

    bays: tuple[Length, ...]
    storeys: tuple[Length, ...]
    columns: Profile
    beams: Profile
    at: Point = (si(0.0), si(0.0))
    support: Support = "clamped"


class Scene(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A structure, loose bodies, and what happens to them.

    Attributes
    ----------
    title : str
    nodes : dict[str, Node]
    members : dict[str, Member]
    grids : dict[str, Grid]
        As a file has them; `scene.grids.spelled_out` puts them among nodes and members.
    pushed : Push, optional
        Written ``push``; see the property of that name.
    motion : Motion, optional
    simulation : Simulation, optional
    loads : tuple of Load
    bodies : dict[str, Body]
    joints : dict[str, Joint]
        Given directly, between bodies.
    vehicles : dict[str, Vehicle]
    grounds : tuple of Ground
    measures : dict[str, Measure]
        What a simulation shall tell, by the name it gets in the answer.
    gravity : Acceleration
        Downward acceleration [m/s²].
    criterion : str
        Yield criterion in shear, ``"tresca"`` or ``"von-mises"``.
    kinematics : str
        ``"small"`` displacements, ``"p-delta"``: equilibrium where the structure has moved to, rotations small, or
        ``"large"`` displacements and rotations.
    reference : str
        What the finite-element reference follows: ``"beam"`` elements, a ``"plane-stress"`` continuum, or what
        `fem_reference` holds to be right, ``"auto"``.
    plane : Plane, optional
        What only a plane stress reference needs to know.
    yielding : str
        What the reference lets yield: ``"gradual"``, fibres across and along members; or ``"ideal-hinges"``, points
        that turn at M_p whatever the axial force, as in tables of collapse loads.
    """

    title: str
    nodes: dict[str, Node] = {}
    members: dict[str, Member] = {}
    grids: dict[str, Grid] = {}
    pushed: Push | None = msgspec.field(name="push", default=None)
    motion: Motion | None = None
    simulation: Simulation | None = None
    loads: tuple[Load, ...] = ()
    bodies: dict[str, Body] = {}
    joints: dict[str, Joint] = {}
    vehicles: dict[str, Vehicle] = {}
    grounds: tuple[Ground, ...] = ()
    measures: dict[str, Measure] = {}
    gravity: Acceleration = si(9.81)
    criterion: Literal["tresca", "von-mises"] = "von-mises"
    kinematics: Kinematics = "small"
    reference: Literal["auto", "beam", "plane-stress"] = "auto"
    plane: Plane | None = None
    yielding: Yielding = "gradual"

    @property
    def meshed(self) -> Plane | None:
        """`plane` where a mesh stands in place of members."""
        return self.plane if self.plane is not None and self.plane.mesh is not None else None

    @property
    def push(self) -> Push:
        """The push.

        Raises
        ------
        InputError
            When the scene has none.
        """
        if self.pushed is None:
            raise InputError("push", "the scene has no push", 'add [push] with node = "…", direction and distance')
        return self.pushed

    def capacity(self, member: str) -> Capacity:
        """Capacities and stiffnesses of a member by name."""
        m = self.members[member]
        return capacity(m.section, m.material, self.criterion)

    def axis(self, member: str) -> tuple[float, float, float]:
        """Direction cosines and length (c, s, L) of a member by name [-, -, m]."""
        m = self.members[member]
        (x0, y0), (x1, y1) = self.nodes[m.start].at, self.nodes[m.end].at
        length = math.hypot(x1 - x0, y1 - y0)
        return (x1 - x0) / length, (y1 - y0) / length, length

    def push_direction(self) -> tuple[float, float]:
        """Unit vector of the push."""
        return unit_vector(self.push.direction)

    def loads_of(self, kind: LoadKind) -> tuple[Load, ...]:
        """The loads of one kind, in the order of the file."""
        return tuple(load for load in self.loads if load.kind == kind)

    def weight_per_length(self, member: str) -> float:
        """Own weight of a member by name, downwards: ρ A g [N/m]."""
        return self.members[member].mass_per_length * self.gravity
