"""How a scene is simulated, and what is measured."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from scene.quantities import Duration, Length, si

NodeQuantity = Literal["x", "y", "angle", "displacement", "vx", "vy", "speed"]
BodyQuantity = Literal[NodeQuantity, "kinetic-energy", "first-contact", "overlap"]
JointQuantity = Literal[
    "N",
    "Q",
    "M",
    "impulse",
    "utilisation",
    "capacity-used",
    "plastic-elongation",
    "plastic-slip",
    "plastic-rotation",
    "plastic-work",
    "yielded",
    "broken",
]
Quantity = Literal[BodyQuantity, JointQuantity]
Take = Literal["last", "first", "largest", "smallest", "change", "time-of-largest", "laps"]
#: Points of a rule in a member.
JointCount = Annotated[int, msgspec.Meta(ge=2, le=1000)]
Integration = Literal["average-acceleration", "implicit-euler"]


class Measure(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A figure that a simulation shall give.

    Attributes
    ----------
    quantity : str
        A `BodyQuantity` of a body or vehicle, a `NodeQuantity` of a node, a `JointQuantity` of a joint or member.
    of : str
        Its name; ``"joints"`` is all joints. Of several joints forces and deformations are the largest by size, work
        and counts the sum.
    take : str
        ``"last"``, ``"first"``, ``"largest"`` or ``"smallest"`` value, ``"change"`` from first to last,
        ``"time-of-largest"``, or ``"laps"``: the value at the end of each lap of a vehicle.
    at : Duration, optional
        The value at this time instead [s].
    since, until : Duration, optional
        Only values between these times count [s].
    """

    quantity: Quantity
    of: str
    take: Take = "last"
    at: Duration | None = None
    since: Duration | None = None
    until: Duration | None = None


class Simulation(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How the scene is run by ``ductile simulate``.

    Attributes
    ----------
    duration : Duration
        How long [s]; a push gives its own.
    dt : Duration
        Step [s].
    iterations : int
        Iterations of Chipmunk's solver in a step.
    gravity_ramp : Duration
        Gravity and dead loads grow over this time [s].
    integration : str
        ``"average-acceleration"``: second order; ``"implicit-euler"``: robust, damping with ωh/2. By default the latter
        for a push, and else the former.
    numerical_damping : float
        δ of the average acceleration. It damps what a step does not resolve, and is not felt by what it does; with 0
        the ringing of stiff joints after an impact can feed on their rotation.
    collision_slop : Length
        Overlap that contacts may keep [m].
    largest_travel : Length, optional
        From where a continuous body first touches something, steps are cut into equal parts, so that it travels no
        further than this in one [m].
    rule : str, optional
        Where the joints of a member go: ``"lobatto"`` points, ``"graded"``, which draws them to where moments peak,
        ``"equal"`` pieces, or ``"radau"``, hinges of a chosen length at both ends. By default the second for a push,
        in members of 6 joints and more, and else the first.
    joints : int, optional
        Points of the rule in each member that does not say otherwise; by default 9 for ``"graded"``, and for
        ``"lobatto"`` in a push or a motion, 6 for ``"radau"``, and else 5.
    joint_damping : Duration
        Viscous damping of the members' joints over their stiffness [s]: a vibration at ω has the damping ratio
        ω joint_damping / 2.
    law : str, optional
        Of the members' joints: ``"rigid-plastic"``, ``"elastic-plastic"``, ``"interaction"`` of N, Q and M, or
        ``"fibre"`` section; by default the last for a push, a motion and members that harden, and else the second.
    fibres : int, optional
        In a section, for the fibre law; by default 16 for a push or a motion, and else 8.
    hinge_length : Length, optional
        For the rule ``"radau"`` [m]; by default the depth of each section.
    refine_at : float, optional
        Members start with ``coarse_joints`` Gauss–Lobatto points, and get those of the rule once
        |N| / N_max + |M| / M_yield or |Q| / Q_max passes this in a joint; by default they have them from the start.
    coarse_joints : int
        Points in each member at first, where ``refine_at`` is given.
    """

    duration: Duration | None = None
    dt: Duration = si(1.0 / 60.0)
    iterations: Annotated[int, msgspec.Meta(ge=1)] = 10
    gravity_ramp: Duration = si(0.0)
    integration: Integration | None = None
    numerical_damping: Annotated[float, msgspec.Meta(ge=0.0, le=1.0)] = 0.02
    collision_slop: Length = si(1e-3)
    largest_travel: Length | None = None
    rule: Literal["lobatto", "graded", "equal", "radau"] | None = None
    joints: JointCount | None = None
    joint_damping: Duration = si(0.0)
    law: Literal["rigid-plastic", "elastic-plastic", "interaction", "fibre"] | None = None
    fibres: Annotated[int, msgspec.Meta(ge=4, le=1000)] | None = None
    hinge_length: Length | None = None
    refine_at: Annotated[float, msgspec.Meta(gt=0.0)] | None = None
    coarse_joints: JointCount = 4
