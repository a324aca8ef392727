"""Vehicles: a chassis on sprung wheels, driven by a motor."""

from __future__ import annotations

import msgspec

from scene.bodies import Coefficient, Point, Shape
from scene.quantities import AngularSpeed, Density, Duration, Frequency, Length, Mass, Moment, Speed, si


class Wheel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A wheel on a vertical suspension.

    Attributes
    ----------
    at : (Length, Length)
        Its centre in the vehicle's coordinates, with the suspension unloaded [m].
    radius : Length
        [m]
    mass : Mass
        [kg]
    friction : float
        Of its surface.
    suspension_frequency : Frequency
        f of the spring (2π f)² m, m the mass of wheel and chassis against each other at the wheel [Hz].
    suspension_damping_ratio : float
        ζ of the damper 2 ζ 2π f m.
    driven : bool
        Whether the motor turns it.
    """

    at: Point
    radius: Length
    mass: Mass
    friction: Coefficient = 1.0
    suspension_frequency: Frequency = si(4.0)
    suspension_damping_ratio: Coefficient = 0.7
    driven: bool = False


class Drive(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a motor does from a time on.

    Attributes
    ----------
    time : Duration
        From when on [s].
    speed : AngularSpeed
        Of the wheel against the chassis; negative drives to the right [rad/s].
    torque : Moment
        Largest torque to reach it [N m].
    """

    time: Duration
    speed: AngularSpeed
    torque: Moment


class Lap(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where a vehicle is put back to drive the way again, with its velocities kept.

    Attributes
    ----------
    beyond : Length
        It is put back when its chassis passes this x [m],
    back_to : Length
        to this one [m].
    """

    beyond: Length
    back_to: Length


class Vehicle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A chassis on wheels.

    Attributes
    ----------
    at : (Length, Length)
        Where the origin of the vehicle's coordinates is [m].
    chassis : tuple of Circle, Box or Polygon
        In the vehicle's coordinates.
    wheels : tuple of Wheel
    velocity : (Speed, Speed)
        At the start [m/s].
    mass : Mass, optional
        Of the chassis [kg]; or else ``density`` and ``depth`` give it.
    density : Density
        [kg/m³]
    depth : Length
        Extent out of the plane [m].
    friction, restitution : float
        Of the chassis.
    drive : tuple of Drive
        One after the other in time; before the first the wheels roll freely.
    lap : Lap, optional
    """

    at: Point
    chassis: tuple[Shape, ...]
    wheels: tuple[Wheel, ...]
    velocity: tuple[Speed, Speed] = (si(0.0), si(0.0))
    mass: Mass | None = None
    density: Density = si(200.0)
    depth: Length = si(1.0)
    friction: Coefficient = 0.5
    restitution: Coefficient = 0.0
    drive: tuple[Drive, ...] = ()
    lap: Lap | None = None
