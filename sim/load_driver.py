"""Loads under displacement control: a pattern of forces, multiplied so that a node goes where it is wanted.

What the solver prescribes is the displacement w that the pattern p works on (see `sim.kernels.spread`), for which its
energy stays convex. How far the node goes for a unit of w changes as joints yield, and from step to step it jumps, as
fibres yield and unload by turns and as the structure vibrates. So the driver goes by what the node has done for w in
the last while, and makes up little by little for what it is off its way: a driver that followed every jump would shake
the structure. A force on the node alone is the pattern for which w is the node's own displacement.

What it makes up for is smoothed twice over a time T. A vibration of ω is a quarter of a turn behind w, and w, in which
what is off adds up, a quarter behind that: unsmoothed, the driver feeds every vibration, by more than what a short step
damps of it. Smoothing turns it by up to half a turn more, and the driver damps all of ω > 1 / T.
"""

from __future__ import annotations

import math

import numpy as np

from sim.members import Assembly
from sim.pieces import NodePoint
from sim.step_back import SolverError

#: Time over which the node's ways are remembered, over which it is brought back to where it is wanted, and over which
#: what it is off is smoothed [s].
_MEMORY, _RETURN, _SMOOTHED = 0.5, 0.25, 0.1
#: Share of the time from one turn to the next over which a driven node shall be sped up, and slowed down; and how long,
#: as such a share, it is waited for at most before it turns or ends.
EASE, LONGEST_WAIT = 0.2, 0.5
#: How near to a place it is there, and how far off its way it has gone for good, in lengths of the whole way.
_NEAR, _ASTRAY = 1e-4, 10.0


class LoadDriver:
    """Drives the proportional loads of ``assembly``, or else a force on ``node``, so that the node goes its way.

    Parameters
    ----------
    assembly : Assembly
    node : str
    direction : (float, float)
        Of the way, of unit length.
    reach : float
        About how long it is [m].

    Attributes
    ----------
    displacement : float
        How far the node has come since the driver was made [m].
    factor : float
        By what the loads are multiplied in the last step [-].
    way : float
        What the loads have gone since then: by ``factor`` it is their work [J].
    """

    def __init__(self, assembly: Assembly, node: str, direction: tuple[float, float], reach: float) -> None:
        self._assembly, self._name, self._direction, self._reach = assembly, node, np.array(direction), reach
        self._take()
        self._origin = np.array(self._node.now())
        size = sum(load.force[0] ** 2 + load.force[1] ** 2 + load.moment**2 for load in self._loads)
        self._stiffness = max(joint.law.elastic_tangent()[0] for joint in self._structure.joints) / size
        # w for a unit of the node's displacement d: Σ Δw Δd / Σ Δd² over the last while, the tangent's at first.
        self._ratio = 0.0
        self._both = self._own = 0.0
        self._gap = 1e-9 * size**0.5
        self._wanted = self._once = self._behind = 0.0
        self.displacement = self.factor = self.way = 0.0

    def _take(self) -> None:
        """Take the assembly as it is now."""
        self._structure, self._node = self._assembly.structure, self._assembly.nodes[self._name]
        x, y = self._direction.tolist()
        self._loads = self._assembly.driven(self._name, (x, y))
        centre = self._node.body.center_of_gravity
        self._centre = NodePoint(self._node.body, (centre.x, centre.y))
        self._index = {body: i for i, body in enumerate(self._structure.bodies)}
        self._pattern = np.zeros((len(self._structure.bodies), 3))

    def aim(self, wanted: float, dt: float) -> None:
        """Before a step of ``dt`` [s]: have the node at ``wanted`` [m] along its way at the step's end.

        Members that are due are refined first.
        """
        self._assembly.refine()
        if self._structure is not self._assembly.structure:
            self._take()
        self._pattern = self._forces(dt)
        if self._ratio:
            ahead = wanted - self._wanted + min(1.0, dt / _RETURN) * self._behind
            # The spring itself gives by as much as the loads need.
            self._gap = self._ratio * ahead + self.factor / self._stiffness
        self._wanted = wanted
        self._structure.drive(self._pattern, self._stiffness, self._gap)

    def read(self, dt: float) -> None:
        """After that step: where the node is, and by what the loads were multiplied.

        Raises
        ------
        SolverError
            When the node has left its way for good.
        """
        before = self.displacement
        self.displacement = float((self._node.ahead(dt) - self._origin) @ self._direction)
        self.factor = self._structure.load_factor
        behind = self._wanted - self.displacement
        if not abs(behind) <= _ASTRAY * self._reach:
            raise SolverError(
                f"the pushed node has left its way of {self._reach:.4g} m by {abs(behind):.4g} m; take shorter steps "
                "or fewer joints, or look for a structure that its loads carry away"
            )
        new = 1.0 - math.exp(-dt / _SMOOTHED)
        self._once += new * (behind - self._once)
        self._behind += new * (self._once - self._behind)
        moved, worked = self.displacement - before, self._gap - self.factor / self._stiffness
        self.way += worked
        keep = math.exp(-dt / _MEMORY)
        self._both = keep * self._both + worked * moved
        self._own = keep * self._own + moved * moved
        if not self._ratio:
            self._ratio = self._tangent(dt)
        elif self._both * self._ratio > 0.0:
            self._ratio = self._both / self._own

    def is_at(self, place: float) -> bool:
        """Whether the node is there, ``place`` [m] along its way."""
        return abs(self.displacement - place) <= _NEAR * self._reach

    def _tangent(self, dt: float) -> float:
        """Ratio g·y / p·y of w to d for the velocities y that a unit impulse of the pattern gives."""
        arm = self._node.ahead(dt) - self._centre.ahead(dt)
        x, y = self._direction
        response = self._structure.pattern_response
        along_node = float(np.array([x, y, arm[0] * y - arm[1] * x]) @ response[self._index[self._node.body]])
        return float(np.sum(self._pattern * response)) / along_node if along_node else 0.0

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
