"""Vehicles: springs, dampers and motors of stock pymunk parts, with the numbers of a mass on springs."""

import math

import numpy as np
import pymunk
import pytest

from scene import parse_scene
from sim.world import World

# A box of 2 t on two wheels of 100 kg, 1 m before and behind its middle, sprung at 4 Hz.
CART = """
title = "Cart"
gravity = "{gravity} m/s^2"
[simulation]
duration = "20 s"
dt = "1/240 s"
iterations = 20
[[grounds]]
points = [["-500 m", "0 m"], ["500 m", "0 m"]]
friction = 1.0
[vehicles.cart]
at = ["0 m", "1.2 m"]
mass = "2 t"
chassis = [{{ kind = "box", size = ["4 m", "1 m"] }}]
drive = [{{ time = "0 s", speed = "{speed} rad/s", torque = "{torque} N m" }}]
[[vehicles.cart.wheels]]
at = ["-1 m", "-0.7 m"]
radius = "0.5 m"
mass = "100 kg"
suspension_frequency = "4 Hz"
suspension_damping_ratio = {ratio}
driven = true
[[vehicles.cart.wheels]]
at = ["1 m", "-0.7 m"]
radius = "0.5 m"
mass = "100 kg"
suspension_frequency = "4 Hz"
suspension_damping_ratio = {ratio}
driven = true
"""
CHASSIS, WHEEL, ARM = 2000.0, 100.0, 1.0
INERTIA = CHASSIS * (4.0**2 + 1.0) / 12.0
# The mass of wheel and chassis against each other at the wheel, and the spring that it is given.
MASS = 1.0 / (1.0 / WHEEL + 1.0 / CHASSIS + ARM**2 / INERTIA)
SPRING = (2.0 * math.pi * 4.0) ** 2 * MASS


def cart(ratio: float = 0.7, speed: float = 0.0, torque: float = 0.0, gravity: float = 10.0) -> World:
    return World(parse_scene(CART.format(ratio=ratio, speed=speed, torque=torque, gravity=gravity), "test"))


def test_a_vehicle_is_made_of_stock_parts() -> None:
    """A groove, a spring and a motor for each driven wheel; nothing of our own."""
    kinds = sorted(type(part).__name__ for part in cart().space.constraints)
    assert kinds == sorted(2 * ["GrooveJoint", "DampedSpring", "SimpleMotor"])


def test_springs_give_by_the_chassis_weight() -> None:
    """m g / 2 k, each."""
    world = cart()
    chassis, wheel = world.cars["cart"].chassis, world.cars["cart"].wheels[0]
    before = chassis.position.y - wheel.position.y
    for _ in range(20 * 240):
        world.step()
    assert before - (chassis.position.y - wheel.position.y) == pytest.approx(CHASSIS * 10.0 / (2.0 * SPRING), rel=0.01)


def test_the_chassis_swings_on_its_springs_by_their_stiffness() -> None:
    """√(2 k / m) / 2π with the wheels on the ground, undamped, from a push downwards."""
    world = cart(ratio=0.0)
    chassis = world.cars["cart"].chassis
    height = []
    while not world.finished:
        world.step()
        height.append(chassis.position.y)
    swing = np.array(height) - np.mean(height)
    crossings = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    period = float(np.diff(crossings).mean()) / 240.0
    assert 1.0 / period == pytest.approx(math.sqrt(2.0 * SPRING / CHASSIS) / (2.0 * math.pi), rel=0.02)


def test_motors_drive_to_their_speed_with_their_torque() -> None:
    """Force 2 T / r on the whole mass, wheels rolling; then 4 rad/s · 0.5 m, however long."""
    world = cart(speed=-4.0, torque=150.0)
    car = world.cars["cart"]
    rolling = CHASSIS + 2.0 * WHEEL + 2.0 * 0.5 * WHEEL
    for _ in range(2 * 240):
        world.step()
    assert car.chassis.velocity.x == pytest.approx(2.0 * 150.0 / 0.5 / rolling * 2.0, rel=0.05)
    while not world.finished:
        world.step()
    assert car.chassis.velocity.x == pytest.approx(2.0, rel=0.01)
    assert all(isinstance(wheel, pymunk.Body) and wheel.position.y < 0.52 for wheel in car.wheels)
