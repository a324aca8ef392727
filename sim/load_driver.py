"""Loads under displacement control: a pattern of forces, multiplied so that a node goes where it is wanted.

What the solver prescribes is the displacement w that the pattern p works on (see `sim.kernels.spread`), for which its
energy stays convex. With y the velocities that a unit impulse of p gives, and g the node's displacement over the
bodies', the node goes on by g·y / p·y for a unit of w. A force on the node alone is the pattern for which w is the
node's own displacement.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sim.body_loads import BodyLoad
from sim.pieces import NodePoint
from sim.structure import Structure


class LoadDriver:
    """Drives ``loads`` on ``structure`` so that ``node`` goes its way along ``direction``.

    Attributes
    ----------
    displacement : float
        How far the node has come since the driver was made [m].
    factor : float
        By what the loads are multiplied in the last step [-].
    """

    def __init__(
        self, structure: Structure, loads: Sequence[BodyLoad], node: NodePoint, direction: tuple[float, float]
    ) -> None:
        self._structure, self._loads, self._node, self._direction = structure, loads, node, np.array(direction)
        self._centre = NodePoint(node.body, (node.body.center_of_gravity.x, node.body.center_of_gravity.y))
        self._index = {body: i for i, body in enumerate(structure.bodies)}
        self._origin = np.array(node.now())
        size = sum(load.force[0] ** 2 + load.force[1] ** 2 + load.moment**2 for load in loads)
        self._stiffness = max(joint.law.elastic_tangent()[0] for joint in structure.joints) / size
        self._first = 1e-9 * size**0.5
        self._ratio = 0.0
        self._pattern = np.zeros((len(structure.bodies), 3))
        self.displacement = self.factor = 0.0

    def aim(self, wanted: float, dt: float) -> None:
        """Before a step of ``dt`` [s]: have the node at ``wanted`` [m] along its way at the step's end."""
        self._pattern = self._forces(dt)
        here = float((self._node.ahead(dt) - self._origin) @ self._direction)
        # The first step, without a way to go, finds the ratio.
        gap = self._ratio * (wanted - here) if self._ratio else self._first
        self._structure.drive(self._pattern, self._stiffness, gap)

    def read(self, dt: float) -> None:
        """After that step: where the node is, and by what the loads were multiplied."""
        arm = self._node.ahead(dt) - self._centre.ahead(dt)
        x, y = self._direction
        response = self._structure.pattern_response
        along_node = float(np.array([x, y, arm[0] * y - arm[1] * x]) @ response[self._index[self._node.body]])
        if along_node > 0.0:
            self._ratio = float(np.sum(self._pattern * response)) / along_node
        self.displacement = float((self._node.ahead(dt) - self._origin) @ self._direction)
        self.factor = self._structure.load_factor

    def _forces(self, dt: float) -> np.ndarray:
        """Forces and moments of the loads about the bodies' centres, where these will be then."""
        pattern = np.zeros_like(self._pattern)
        for load in self._loads:
            (fx, fy), (px, py) = load.force, load.point
            angle = load.body.angle + dt * load.body.angular_velocity
            c, s = math.cos(angle), math.sin(angle)
            moment = load.moment + (c * px - s * py) * fy - (s * px + c * py) * fx
            pattern[self._index[load.body]] += fx, fy, moment
        return pattern
