"""Vehicles of stock pymunk parts: wheels in grooves of the chassis, damped springs, and motors."""

from __future__ import annotations

import math

import pymunk

from scene import Scene, Vehicle, Wheel
from sim.loose_bodies import new_group, place, solid

#: Free way of a wheel up and down its groove, and length of its spring, over the wheel's radius.
_TRAVEL, _SPRING = 2.0, 4.0


class Car:
    """A vehicle in a space.

    Attributes
    ----------
    chassis : pymunk.Body
    wheels : tuple of pymunk.Body
    laps : list of float
        Times at which it was put back [s].
    """

    def __init__(self, vehicle: Vehicle, space: pymunk.Space) -> None:
        self._vehicle, self._space = vehicle, space
        group = new_group()
        self.chassis = solid(
            vehicle.chassis,
            mass=vehicle.mass,
            area_density=vehicle.density * vehicle.depth,
            friction=vehicle.friction,
            restitution=vehicle.restitution,
            group=group,
        )
        place(self.chassis, vehicle.at, 0.0)
        self.chassis.velocity = vehicle.velocity
        space.add(self.chassis, *self.chassis.shapes)
        self.wheels = tuple(self._add_wheel(wheel, group) for wheel in vehicle.wheels)
        self._motors = tuple(
            self._add_motor(body) for wheel, body in zip(vehicle.wheels, self.wheels, strict=True) if wheel.driven
        )
        self.laps: list[float] = []

    def _add_wheel(self, wheel: Wheel, group: int) -> pymunk.Body:
        body = pymunk.Body(wheel.mass, pymunk.moment_for_circle(wheel.mass, 0.0, wheel.radius))
        x, y = wheel.at
        body.position = self.chassis.local_to_world((x, y))
        body.velocity = self.chassis.velocity
        tyre = pymunk.Circle(body, wheel.radius)
        tyre.friction = wheel.friction
        tyre.filter = pymunk.ShapeFilter(group=group)
        travel, length = _TRAVEL * wheel.radius, _SPRING * wheel.radius
        arm = x - self.chassis.center_of_gravity.x
        mass = 1.0 / (1.0 / wheel.mass + 1.0 / self.chassis.mass + arm * arm / self.chassis.moment)
        omega = 2.0 * math.pi * wheel.suspension_frequency
        groove = pymunk.GrooveJoint(self.chassis, body, (x, y - travel), (x, y + travel), (0.0, 0.0))
        spring = pymunk.DampedSpring(
            self.chassis,
            body,
            (x, y + length),
            (0.0, 0.0),
            length,
            omega * omega * mass,
            2.0 * wheel.suspension_damping_ratio * omega * mass,
        )
        self._space.add(body, tyre, groove, spring)
        return body

    def _add_motor(self, wheel: pymunk.Body) -> pymunk.SimpleMotor:
        motor = pymunk.SimpleMotor(self.chassis, wheel, 0.0)
        motor.max_force = 0.0
        self._space.add(motor)
        return motor

    @property
    def bodies(self) -> tuple[pymunk.Body, ...]:
        """Chassis and wheels."""
        return (self.chassis, *self.wheels)

    def drive(self, time: float) -> None:
        """Set the motors for ``time`` [s], and put the vehicle back when its lap is over."""
        now = [drive for drive in self._vehicle.drive if drive.time <= time]
        for motor in self._motors if now else ():
            # Chipmunk turns the second body at minus the rate.
            motor.rate, motor.max_force = -float(now[-1].speed), float(now[-1].torque)
        lap = self._vehicle.lap
        x = self.chassis.local_to_world(self.chassis.center_of_gravity).x
        if lap is not None and x > lap.beyond:
            self.laps.append(time)
            for body in self.bodies:
                body.position += (lap.back_to - x, 0.0)
                self._space.reindex_shapes_for_body(body)


def add_vehicles(scene: Scene, space: pymunk.Space) -> dict[str, Car]:
    """The vehicles of ``scene`` by name."""
    return {name: Car(vehicle, space) for name, vehicle in scene.vehicles.items()}
