"""The second-order share of equilibrium: moments of forces whose points a body has turned.

A body that turns by θ bears its forces F_k where their points r_k turn to. To first order in θ that gives it the moment

    Σ (θ ẑ × r_k) × F_k = -θ Σ r_k · F_k,

which is all that P–Δ knows of geometry. In a simulation positions are exact, but a step begins with them and ends with
the forces of its end: the moment lags by what the body turns in the step. A push, which asks for states of rest, is
given what is missing. And it can be given more: g times the moment of the whole rotation stands for a structure that
turns g + 1 times as far under the same forces; g = -1 for one that is in equilibrium where it was built.

In a step that takes θ to θ + h ω, with Σ r·F = k, the moment -k (g θ + (g + 1) h ω) is missing. Of ω only the value
before the step is known. Forces that pull outwards, k > 0, resist the turn, and resisting late they would shake the
body: their part acts implicitly, as an inertia that is greater by (g + 1) h² k while I ω stays what it is, which makes
of ω the value before the step in the formula above.

Shear flexibility has a part in it, too (F. Engesser, 1891). Slip v of a joint moves the ends of the axial force N off
one line; the moment -N v goes to the bodies as they turn the joint's frame, and g times as much is added. And as the
frame turns by ψ, N takes over a share N ψ of what the joint bears across; so a pair of forces g N ψ across is put on
its two bodies, which nothing but the joint feels.
"""

from __future__ import annotations

import math

import numpy as np
import pymunk

from sim.kernels import layout as at
from sim.members import Assembly


class SecondOrder:
    """Second-order moments of the bodies of ``assembly``.

    Parameters
    ----------
    assembly : Assembly
    node : str
        Which is pushed.
    direction : (float, float)
        Of the push.
    more : float
        g above [-].
    """

    def __init__(self, assembly: Assembly, node: str, direction: tuple[float, float], more: float) -> None:
        self._assembly, self._node, self._direction, self._more = assembly, node, direction, more
        self._own_inertia: dict[pymunk.Body, float] = {}
        self._take()

    def _take(self) -> None:
        """Take the assembly as it is now."""
        assembly = self._assembly
        self._structure = assembly.structure
        self._dead_loads, self._pattern = assembly.dead_loads, assembly.driven(self._node, self._direction)
        self._bodies = [b for b in self._structure.bodies if b.body_type == pymunk.Body.DYNAMIC]
        self._row = {body: i for i, body in enumerate(self._bodies)}
        self._inertia = np.array([self._own_inertia.setdefault(body, body.moment) for body in self._bodies])
        self._start = np.zeros(len(self._bodies))
        # Σ r · F of every body for a unit of N and Q in every joint; both turn with it. Tension pulls the first body
        # of a joint along its axis.
        self._of_joints = np.zeros((len(self._bodies), len(assembly.joints), 2))
        # Share of the frame of every joint in the turn of every body, and the pair of unit forces across it.
        self._of_frames = np.zeros((len(self._bodies), len(assembly.joints)))
        self._across = np.zeros((len(self._bodies), len(assembly.joints), 3))
        self._carried = np.zeros(len(assembly.joints))
        for k, joint in enumerate(assembly.joints):
            turn = joint.geometry[at.TURN]
            sides = (
                (joint.a, 1.0, at.ANCHOR_A, at.REST_A, 1.0 - turn),
                (joint.b, -1.0, at.ANCHOR_B, at.REST_B, turn),
            )
            for body, sign, anchor, rest, share in sides:
                if body in self._row:
                    self._start[self._row[body]] = joint.direction - joint.geometry[rest]
                    arm = pymunk.Vec2d(*joint.geometry[anchor : anchor + 2]).rotated(-joint.geometry[rest])
                    self._of_joints[self._row[body], k] += sign * arm.x, sign * arm.y
                    self._of_frames[self._row[body], k] += share
                    x, y = -math.sin(joint.direction), math.cos(joint.direction)
                    self._across[self._row[body], k] += sign * x, sign * y, sign * arm.x

    def act(self, dt: float, dead_share: float = 1.0, factor: float = 0.0) -> None:
        """Act in the next step of ``dt`` [s], with a share of the dead loads and a load factor as in the last."""
        if self._structure is not self._assembly.structure:
            self._take()
        N, Q, _ = self._structure.force.T
        reach = np.einsum("bjk,jk->b", self._of_joints, np.column_stack([N, Q + self._carried]))
        slipped = self._of_frames @ (N * self._structure.deformation[:, 1])
        for loads, share in ((self._dead_loads, dead_share), (self._pattern, factor)):
            for load in loads:
                if load.body in self._row:
                    arm = load.body.local_to_world(load.point) - load.body.position
                    reach[self._row[load.body]] += share * arm.dot(load.force)
        angle, step = np.array([(body.angle, dt * body.angular_velocity) for body in self._bodies]).T
        # Chipmunk moves the bodies by one step before it asks for forces.
        turned = angle + step - self._start
        self._carried = self._more * N * (turned @ self._of_frames)
        turn = self._more * turned + (self._more + 1.0) * step
        pairs = np.einsum("bjk,j->bk", self._across, self._carried)
        pairs[:, 2] -= turn * reach + self._more * slipped
        implicit = (self._inertia + (self._more + 1.0) * dt * dt * np.maximum(reach, 0.0)).tolist()
        for body, (x, y, moment), inertia in zip(self._bodies, pairs.tolist(), implicit, strict=True):
            body.moment = inertia
            body.force += x, y
            body.torque += moment
