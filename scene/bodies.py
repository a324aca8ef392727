"""Loose bodies: shapes with a mass, the ground they fall on, and joints given directly between them."""

from __future__ import annotations

from typing import Annotated

import msgspec

from scene.quantities import (
    Angle,
    AngularSpeed,
    Density,
    Force,
    Frequency,
    Length,
    Mass,
    Moment,
    MomentOfInertia,
    RotationalStiffness,
    Speed,
    Stiffness,
    si,
)

#: A coefficient of friction or restitution, or a damping ratio.
Coefficient = Annotated[float, msgspec.Meta(ge=0.0, le=1e3)]
Point = tuple[Length, Length]

#: What a joint may name in place of a body.
GROUND = "ground"


class Circle(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="circle"):
    """A disc.

    Attributes
    ----------
    radius : Length
        [m]
    at : (Length, Length)
        Its centre in the body's coordinates [m].
    """

    radius: Length
    at: Point = (si(0.0), si(0.0))


class Box(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="box"):
    """A rectangle along the body's axes.

    Attributes
    ----------
    size : (Length, Length)
        Width and height [m].
    at : (Length, Length)
        Its centre in the body's coordinates [m].
    """

    size: Point
    at: Point = (si(0.0), si(0.0))


class Polygon(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="polygon"):
    """A convex polygon.

    Attributes
    ----------
    points : tuple of (Length, Length)
        Corners in the body's coordinates, in either direction [m].
    """

    points: tuple[Point, ...]


Shape = Circle | Box | Polygon


class Body(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A rigid body that moves freely, unless it is fixed or joined.

    Attributes
    ----------
    shapes : tuple of Circle, Box or Polygon
        What it is made of; its centre of mass is theirs.
    at : (Length, Length)
        Where the origin of the shapes' coordinates is [m].
    angle : Angle
        [rad]
    velocity : (Speed, Speed)
        At the start [m/s].
    spin : AngularSpeed
        At the start [rad/s].
    mass : Mass, optional
        [kg]; or else ``density`` and ``depth`` give it.
    density : Density
        [kg/m³]
    depth : Length
        Extent out of the plane [m].
    moment_of_inertia : MomentOfInertia, optional
        About the centre of mass [kg m²]; by default that of the shapes, filled evenly.
    fixed : bool
        Whether it stays where it is.
    friction, restitution : float
        Of its surface. A pair of surfaces has the product of both.
    group : str, optional
        Bodies of the same group pass through each other.
    continuous : bool
        While nothing is joined to it, the body ends its move where it first touches another, so that it goes into
        nothing however fast it is.
    """

    shapes: tuple[Shape, ...]
    at: Point
    angle: Angle = si(0.0)
    velocity: tuple[Speed, Speed] = (si(0.0), si(0.0))
    spin: AngularSpeed = si(0.0)
    mass: Mass | None = None
    density: Density = si(7850.0)
    depth: Length = si(1.0)
    moment_of_inertia: MomentOfInertia | None = None
    fixed: bool = False
    friction: Coefficient = 0.5
    restitution: Coefficient = 0.0
    group: str | None = None
    continuous: bool = False


class Ground(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Solid ground under a line.

    Attributes
    ----------
    points : tuple of (Length, Length)
        Corners of the line, one after the other [m]. The ground is below a line that is drawn to the right or to the
        left as a whole; one that ends above where it began, or in that point, has it on the right of its way.
    thickness : Length
        Of the ground below the line, less where it would come out elsewhere [m].
    friction, restitution : float
        Of its surface. A pair of surfaces has the product of both.
    """

    points: tuple[Point, ...]
    thickness: Length = si(1.0)
    friction: Coefficient = 0.5
    restitution: Coefficient = 0.0


class Joint(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An elastic–plastic joint between two bodies, given directly.

    Attributes
    ----------
    between : (str, str)
        Names of the bodies a and b; ``"ground"`` is the fixed world.
    at : (Length, Length)
        Where it is [m].
    direction : (float, float), optional
        Along which N acts; by default from a's centre of mass to b's.
    N_max, Q_max : Force, optional
        Capacities [N]; endless by default.
    M_max : Moment, optional
        Moment capacity [N m]; by default rotational stiffness times ``elastic_rotation``.
    elastic_elongation, elastic_slip : Length
        At which N_max and Q_max are reached [m].
    elastic_rotation : Angle
        At which M_max is reached [rad].
    stiffness : (Stiffness, Stiffness, RotationalStiffness), optional
        In place of the elastic deformations [N/m, N/m, N m/rad].
    frequency : Frequency, optional
        In place of the rotational stiffness, (2π f)² I with I the reduced moment of inertia of the two bodies [Hz].
    damping_ratio : float
        ζ of a viscous moment 2 ζ √(k I) θ', with the same I.
    break_elongation, break_slip : Length, optional
        Plastic deformations at which the joint breaks [m]; never by default.
    break_rotation : Angle, optional
        Likewise [rad].
    compression_counts : bool
        Whether plastic shortening counts with the elongation.
    """

    between: tuple[str, str]
    at: Point
    direction: tuple[float, float] | None = None
    N_max: Force | None = None
    Q_max: Force | None = None
    M_max: Moment | None = None
    elastic_elongation: Length = si(1e-4)
    elastic_slip: Length = si(1e-4)
    elastic_rotation: Angle = si(0.01)
    stiffness: tuple[Stiffness, Stiffness, RotationalStiffness] | None = None
    frequency: Frequency | None = None
    damping_ratio: Coefficient = 0.0
    break_elongation: Length | None = None
    break_slip: Length | None = None
    break_rotation: Angle | None = None
    compression_counts: bool = False
