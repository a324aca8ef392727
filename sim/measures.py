"""Figures that a simulation gives: what a scene's measures ask for, watched step by step."""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, get_args

import numpy as np
import pymunk

from scene import ALL_JOINTS, Measure
from scene.programme import JointQuantity
from sim.joint import DuctileJoint
from sim.joint_arrays import JointArrays

if TYPE_CHECKING:
    from sim.world import World

#: Units of what can be measured.
UNITS = {
    "x": "m",
    "y": "m",
    "angle": "rad",
    "displacement": "m",
    "vx": "m/s",
    "vy": "m/s",
    "speed": "m/s",
    "kinetic-energy": "J",
    "first-contact": "s",
    "overlap": "m",
    "N": "N",
    "Q": "N",
    "M": "N m",
    "impulse": "N s",
    "utilisation": "",
    "capacity-used": "",
    "plastic-elongation": "m",
    "plastic-slip": "m",
    "plastic-rotation": "rad",
    "plastic-work": "J",
    "yielded": "",
    "broken": "",
}
_FORCES = ("N", "Q", "M")


class Watch:
    """A measure and its values so far.

    Attributes
    ----------
    time, value : list of float
        At the start and after each step.
    """

    def __init__(self, measure: Measure, world: World) -> None:
        self._measure, self._world = measure, world
        self._now = _reader(measure, world)
        self.time: list[float] = []
        self.value: list[float] = []
        self.note()

    def note(self) -> None:
        """Take the value as it is now."""
        self.time.append(self._world.time)
        self.value.append(self._now())

    def result(self) -> float | list[float]:
        """What the measure asks for; nan when there is no such value."""
        measure = self._measure
        if measure.take == "laps":
            laps = sorted(time for car in self._world.cars.values() for time in car.laps)
            return [self._at(time) for time in laps]
        if measure.at is not None:
            return self._at(measure.at)
        first = 0 if measure.since is None else bisect.bisect_left(self.time, measure.since - 1e-9)
        last = len(self.time) if measure.until is None else bisect.bisect_right(self.time, measure.until + 1e-9)
        values = np.array(self.value[first:last])
        if len(values) == 0:
            return math.nan
        largest = int(np.argmax(np.abs(values)))
        return {
            "last": float(values[-1]),
            "first": float(values[0]),
            "largest": float(values[largest]),
            "smallest": float(values[np.argmin(np.abs(values))]),
            "change": float(values[-1] - values[0]),
            "time-of-largest": self.time[first + largest],
        }[measure.take]

    def _at(self, time: float) -> float:
        """The value of the last step that ended by ``time``."""
        k = bisect.bisect_right(self.time, time + 1e-9)
        return self.value[k - 1] if self.time[-1] >= time - 1e-9 else math.nan


def _reader(measure: Measure, world: World) -> Callable[[], float]:
    if measure.quantity in get_args(JointQuantity):
        return lambda: _of_joints(measure.quantity, _joints_called(measure.of, world))
    if measure.quantity in ("first-contact", "overlap"):
        contacts = world.contacts_of(world.bodies_called(measure.of))
        return lambda: contacts.first if measure.quantity == "first-contact" else contacts.overlap
    if measure.quantity == "kinetic-energy":
        bodies = world.bodies_called(measure.of)
        return lambda: sum(_kinetic_energy(body) for body in bodies)
    return _of_point(measure.quantity, lambda: world.point_called(measure.of))


def _joints_called(name: str, world: World) -> Sequence[DuctileJoint]:
    """All joints, or those of a member, or that of the name, as there are now."""
    return world.all_joints if name == ALL_JOINTS else world.joints[name]


def _kinetic_energy(body: pymunk.Body) -> float:
    """[J]; pymunk's own is twice that."""
    return 0.5 * (body.mass * body.velocity.length_squared + body.moment * body.angular_velocity**2)


def _of_point(quantity: str, now: Callable[[], tuple[pymunk.Body, tuple[float, float]]]) -> Callable[[], float]:
    """Of a point of a body, which ``now`` says."""

    def place() -> pymunk.Vec2d:
        body, point = now()
        return body.local_to_world(point)

    def velocity() -> pymunk.Vec2d:
        body, point = now()
        return body.velocity_at_local_point(point)

    origin = place()

    return {
        "x": lambda: place().x,
        "y": lambda: place().y,
        "angle": lambda: now()[0].angle,
        "displacement": lambda: place().get_distance(origin),
        "vx": lambda: velocity().x,
        "vy": lambda: velocity().y,
        "speed": lambda: velocity().length,
    }[quantity]


def _of_joints(quantity: str, joints: Sequence[DuctileJoint]) -> float:
    """Of several joints the largest by size; sums of work and counts."""
    read = JointArrays(joints)
    if quantity in _FORCES:
        return _largest(read.force[:, _FORCES.index(quantity)])
    if quantity == "impulse":
        return _largest(np.array([joint.impulse for joint in joints])[~read.broken])
    if quantity == "utilisation":
        return _largest(read.utilisation[~read.broken])
    if quantity == "capacity-used":
        return _largest(read.capacity_used)
    if quantity == "plastic-work":
        return float(read.dissipated.sum())
    if quantity == "broken":
        return float(read.broken.sum())
    if quantity == "yielded":
        return float(read.plastic_deformation.any(axis=1).sum())
    column = {"plastic-elongation": 0, "plastic-slip": 2, "plastic-rotation": 3}[quantity]
    return _largest(read.plastic_deformation[:, column])


def _largest(values: np.ndarray) -> float:
    return float(values.flat[np.abs(values).argmax()]) if values.size else 0.0
