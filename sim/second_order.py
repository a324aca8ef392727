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

from sim.chipmunk import (
    ANGLE,
    BODY_WORDS,
    FORCE_X,
    FORCE_Y,
    MOMENT,
    MOMENT_INVERSE,
    SPIN,
    TORQUE,
    body_address,
    words,
)
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
        # Their structs: by pymunk's attributes, half of what a push takes would be spent here.
        self._words = [words(body_address(body), BODY_WORDS) for body in self._bodies]
        self._row = {body: i for i, body in enumerate(self._bodies)}
        self._inertia = np.array([self._own_inertia.setdefault(body, body.moment) for body in self._bodies])
        self._start = np.zeros(len(self._bodies))
        sides = []
        for k, joint in enumerate(assembly.joints):
            x, y = -math.sin(joint.direction), math.cos(joint.direction)
            turn = joint.geometry[at.TURN]
            # Tension pulls the first body of a joint along its axis.
            for body, sign, anchor, rest, share in (
                (joint.a, 1.0, at.ANCHOR_A, at.REST_A, 1.0 - turn),
                (joint.b, -1.0, at.ANCHOR_B, at.REST_B, turn),
            ):
                if body in self._row:
                    self._start[self._row[body]] = joint.direction - joint.geometry[rest]
                    arm = pymunk.Vec2d(*joint.geometry[anchor : anchor + 2]).rotated(-joint.geometry[rest])
                    sides.append((self._row[body], k, sign * arm.x, sign * arm.y, share, sign * x, sign * y))
        # Of every side of a joint: r along and across its axis, which turn with the body; the body's share in the
        # turn of its frame; a unit force across it.
        table = np.array(sides).T
        self._body_of, self._joint_of = table[:2].astype(int)
        self._along, self._across, self._share, *self._normal = table[2:]
        self._carried = np.zeros(len(assembly.joints))

    def act(self, dt: float, dead_share: float = 1.0, factor: float = 0.0) -> None:
        """Act in the next step of ``dt`` [s], with a share of the dead loads and a load factor as in the last."""
        if self._structure is not self._assembly.structure:
            self._take()
        N, Q, _ = self._structure.force.T
        slipped = N * self._structure.deformation[:, 1]
        of, across = self._joint_of, Q + self._carried
        reach = self._on_bodies(self._along * N[of] + self._across * across[of])
        for loads, share in ((self._dead_loads, dead_share), (self._pattern, factor)):
            for load in loads:
                if load.body in self._row:
                    arm = load.body.local_to_world(load.point) - load.body.position
                    reach[self._row[load.body]] += share * arm.dot(load.force)
        angle, step = np.array([(w.item(ANGLE), dt * w.item(SPIN)) for w in self._words]).T
        # Chipmunk moves the bodies by one step before it asks for forces.
        turned = angle + step - self._start
        frames = np.bincount(of, weights=self._share * turned[self._body_of], minlength=len(N))
        self._carried = self._more * N * frames
        turn = self._more * turned + (self._more + 1.0) * step
        x, y = (self._on_bodies(normal * self._carried[of]) for normal in self._normal)
        moments = (
            self._on_bodies(self._along * self._carried[of] - self._more * self._share * slipped[of]) - turn * reach
        )
        implicit = (self._inertia + (self._more + 1.0) * dt * dt * np.maximum(reach, 0.0)).tolist()
        forces = np.column_stack([x, y, moments]).tolist()
        for w, (fx, fy, moment), inertia in zip(self._words, forces, implicit, strict=True):
            w[MOMENT], w[MOMENT_INVERSE] = inertia, 1.0 / inertia
            w[FORCE_X] += fx
            w[FORCE_Y] += fy
            w[TORQUE] += moment

    def _on_bodies(self, of_sides: np.ndarray) -> np.ndarray:
        """What the sides of all joints add up to on every body, (bodies,)."""
        return np.bincount(self._body_of, weights=of_sides, minlength=len(self._bodies))
