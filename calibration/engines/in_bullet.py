"""Pushing a scene in PyBullet: a tree of links, each joint a velocity motor that stands still until M_max."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from calibration.engines.handover import Handover, JointTerms, PushPoint
from calibration.engines.pushing import Pushed, push_rig

#: The pusher's motor, in times of what the strongest joint could ask of it.
_STRONG = 1e3


class NoTree(ValueError):
    """The scene has loops, slides or loose parts, which PyBullet's motors do not hold."""


def push_in_bullet(handover: Handover, push: PushPoint, distances: np.ndarray) -> Pushed:
    """Push the scene's tree; raises `NoTree` when it is none."""
    return push_rig(_BulletRig(handover, push), handover, push, distances)


def _tree(handover: Handover) -> list[tuple[JointTerms, int, int]]:
    """Joints with parent and child, parents first."""
    order: list[tuple[JointTerms, int, int]] = []
    known, left = {-1}, list(handover.joints)
    while left:
        joint = next((joint for joint in left if (joint.a in known) != (joint.b in known)), None)
        if joint is None or joint.slide is not None:
            raise NoTree("PyBullet caps motors of trees only")
        left.remove(joint)
        parent, child = (joint.a, joint.b) if joint.a in known else (joint.b, joint.a)
        known.add(child)
        order.append((joint, parent, child))
    return order


@contextmanager
def _without_chatter() -> Iterator[None]:
    """Bullet says things on standard output, past Python; there they go to standard error."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        os.dup2(2, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


class _BulletRig:
    """See `calibration.engines.pushing.Rig`. Links are not turned as the scene begins; the plane is x, y."""

    def __init__(self, handover: Handover, push: PushPoint) -> None:
        self.handover, self.push = handover, push
        tree = _tree(handover)
        with _without_chatter():
            import pybullet
            from pybullet_utils.bullet_client import BulletClient

            self.client = client = BulletClient(connection_mode=pybullet.DIRECT)
        client.setGravity(0.0, -handover.gravity, 0.0)
        client.setPhysicsEngineParameter(
            fixedTimeStep=handover.model.dt, numSubSteps=0, numSolverIterations=handover.model.iterations,
            solverResidualThreshold=0.0,
        )  # fmt: skip
        self.link = {child: i for i, (_, _, child) in enumerate(tree)}
        centres = [handover.bodies[child] for _, _, child in tree]
        at = {child: joint.at for joint, _, child in tree} | {-1: (0.0, 0.0)}
        n = len(tree)
        # A link's frame is at its joint; the centre of gravity lies apart from it.
        self.body = client.createMultiBody(
            baseMass=0.0,
            linkMasses=[piece.mass for piece in centres],
            linkCollisionShapeIndices=[-1] * n,
            linkVisualShapeIndices=[-1] * n,
            linkPositions=[(j.at[0] - at[p][0], j.at[1] - at[p][1], 0.0) for j, p, _ in tree],
            linkOrientations=[(0.0, 0.0, 0.0, 1.0)] * n,
            linkInertialFramePositions=[
                (piece.x - j.at[0], piece.y - j.at[1], 0.0) for piece, (j, _, _) in zip(centres, tree, strict=True)
            ],
            linkInertialFrameOrientations=[(0.0, 0.0, 0.0, 1.0)] * n,
            linkParentIndices=[0 if p < 0 else self.link[p] + 1 for _, p, _ in tree],
            linkJointTypes=[client.JOINT_REVOLUTE] * n,
            linkJointAxis=[(0.0, 0.0, 1.0)] * n,
        )
        for i, (joint, _, child) in enumerate(tree):
            moment = handover.bodies[child].moment
            client.changeDynamics(
                self.body, i, localInertiaDiagonal=[moment] * 3, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0
            )
            limit = 0.0 if joint.turns_freely else min(joint.capacity[2], 1e9)
            client.setJointMotorControl2(self.body, i, client.VELOCITY_CONTROL, targetVelocity=0.0, force=limit)
        self.pusher: int | None = None

    def place(self, body: int) -> tuple[float, float, float]:
        state = self.client.getLinkState(self.body, self.link[body], computeForwardKinematics=1)
        x, y, _ = state[0]
        turned = self.client.getEulerFromQuaternion(state[1])[2]
        return x, y, self.handover.bodies[body].angle + turned

    def act(self, body: int, force: tuple[float, float], moment: float) -> None:
        link, world = self.link[body], self.client.WORLD_FRAME
        x, y, _ = self.place(body)
        self.client.applyExternalForce(self.body, link, (*force, 0.0), (x, y, 0.0), world)
        self.client.applyExternalTorque(self.body, link, (0.0, 0.0, moment), world)

    def hold(self) -> None:
        client, (dx, dy) = self.client, self.push.direction
        x, y, angle = self.place(self.push.body)
        turned = angle - self.handover.bodies[self.push.body].angle
        piece = self.handover.bodies[self.push.body]
        c, s = math.cos(piece.angle), math.sin(piece.angle)
        px, py = self.push.point
        ox, oy = c * px - s * py, s * px + c * py  # in the link's own, unturned axes
        c, s = math.cos(turned), math.sin(turned)
        start = (x + c * ox - s * oy, y + s * ox + c * oy, 0.0)
        still = (0.0, 0.0, 0.0, 1.0)
        heavy, light = 1e2 * piece.mass, 1e-1 * piece.mass
        self.pusher = client.createMultiBody(
            baseMass=0.0, basePosition=start, linkMasses=[heavy, light], linkCollisionShapeIndices=[-1, -1],
            linkVisualShapeIndices=[-1, -1], linkPositions=[(0.0, 0.0, 0.0)] * 2, linkOrientations=[still] * 2,
            linkInertialFramePositions=[(0.0, 0.0, 0.0)] * 2, linkInertialFrameOrientations=[still] * 2,
            linkParentIndices=[0, 1], linkJointTypes=[client.JOINT_PRISMATIC] * 2,
            linkJointAxis=[(dx, dy, 0.0), (-dy, dx, 0.0)],
        )  # fmt: skip
        for link in range(2):
            client.changeDynamics(self.pusher, link, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0)
            client.setJointMotorControl2(self.pusher, link, client.VELOCITY_CONTROL, force=0.0)
        tie = client.createConstraint(
            self.pusher, 1, self.body, self.link[self.push.body], client.JOINT_POINT2POINT,
            (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (ox, oy, 0.0),
        )  # fmt: skip
        strong = max(joint.capacity[2] for joint in self.handover.joints if math.isfinite(joint.capacity[2]))
        self.strength = _STRONG * strong
        client.changeConstraint(tie, maxForce=self.strength)
        self.travel = 0.0

    def step(self, travel: float) -> float:
        client, dt = self.client, self.handover.model.dt
        if self.pusher is None:
            client.stepSimulation()
            return 0.0
        here = client.getJointState(self.pusher, 0)[0]
        client.setJointMotorControl2(
            self.pusher, 0, client.VELOCITY_CONTROL, targetVelocity=(travel - here) / dt, force=self.strength
        )
        client.stepSimulation()
        return float(client.getJointState(self.pusher, 0)[3])
