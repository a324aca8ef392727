"""Pushing a scene in Box2D 2.3, which has pins and friction motors, but no spring with a largest torque."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from calibration.engines.handover import Handover, JointTerms, PushPoint
from calibration.engines.pushing import Pushed, push_rig

#: Frequency of a wheel's spring that shall bear nothing [Hz]. Without any, Box2D 2.3 multiplies by zero numbers that it
#: never set, and where they are not finite the whole world is lost.
_LOOSE = 1e-3


def push_in_box2d(handover: Handover, push: PushPoint, distances: np.ndarray) -> Pushed:
    """Push pins with motors that stand still until M_max: rigid, then plastic."""
    return push_rig(_Box2DRig(handover, push), handover, push, distances)


class _Box2DRig:
    """See `calibration.engines.pushing.Rig`."""

    def __init__(self, handover: Handover, push: PushPoint) -> None:
        import Box2D

        self.handover, self.push = handover, push
        self.world = Box2D.b2World(gravity=(0.0, -handover.gravity), doSleep=False)
        self.ground = self.world.CreateStaticBody()
        self.bodies = []
        for piece in handover.bodies:
            body = self.world.CreateDynamicBody(position=(piece.x, piece.y), angle=piece.angle, allowSleep=False)
            body.massData = Box2D.b2MassData(mass=piece.mass, center=(0.0, 0.0), I=piece.moment)
            self.bodies.append(body)
        for joint in handover.joints:
            self._join(joint)
        self.pusher: Any = None

    def _join(self, joint: JointTerms) -> None:
        a, b = (self.ground if k < 0 else self.bodies[k] for k in (joint.a, joint.b))
        if joint.slide is None:
            motor = not joint.turns_freely
            limit = min(joint.capacity[2], 1e9) if motor else 0.0
            self.world.CreateRevoluteJoint(
                bodyA=a, bodyB=b, anchor=joint.at, enableMotor=motor, maxMotorTorque=limit, motorSpeed=0.0
            )
            return
        axis = (math.cos(joint.slide), math.sin(joint.slide))
        if joint.turns_freely:
            self.world.CreateWheelJoint(bodyA=a, bodyB=b, anchor=joint.at, axis=axis, frequencyHz=_LOOSE)
        else:
            self.world.CreatePrismaticJoint(bodyA=a, bodyB=b, anchor=joint.at, axis=axis)

    def place(self, body: int) -> tuple[float, float, float]:
        x, y = self.bodies[body].position
        return x, y, self.bodies[body].angle

    def act(self, body: int, force: tuple[float, float], moment: float) -> None:
        self.bodies[body].ApplyForce(force, self.bodies[body].worldCenter, True)
        self.bodies[body].ApplyTorque(moment, True)

    def hold(self) -> None:
        node = self.bodies[self.push.body]
        at = node.GetWorldPoint(self.push.point)
        dx, dy = self.push.direction
        self.pusher = self.world.CreateKinematicBody(position=at)
        # A wheel's axle slides along its axis without a spring, and turns: only the way across the axis is held.
        self.tie = self.world.CreateWheelJoint(
            bodyA=self.pusher, bodyB=node, anchor=at, axis=(-dy, dx), frequencyHz=_LOOSE, maxMotorTorque=0.0
        )
        self.origin, self.travel = (at[0], at[1]), 0.0

    def step(self, travel: float) -> float:
        dt, (dx, dy) = self.handover.model.dt, self.push.direction
        if self.pusher is not None:
            speed = (travel - self.travel) / dt
            self.pusher.position = (self.origin[0] + self.travel * dx, self.origin[1] + self.travel * dy)
            self.pusher.linearVelocity = (speed * dx, speed * dy)
            self.travel = travel
        self.world.Step(dt, self.handover.model.iterations, self.handover.model.iterations)
        self.world.ClearForces()
        if self.pusher is None:
            return 0.0
        fx, fy = self.tie.GetReactionForce(1.0 / dt)
        return float(fx * dx + fy * dy)
