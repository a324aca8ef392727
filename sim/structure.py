"""A structure: pymunk bodies and the joints between them, solved as one Chipmunk constraint."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pymunk

from sim import chipmunk, kernels
from sim.laws import Law
from sim.ordering import minimum_degree


class SolverError(RuntimeError):
    """A step that could not be taken."""


@dataclass(frozen=True)
class Joint:
    """A joint from body ``a`` to body ``b``; free of force as the bodies lie when the structure is built.

    Parameters
    ----------
    a, b : pymunk.Body
        At least one of them dynamic.
    at : (float, float)
        World position of the joint [m].
    direction : float
        Angle of the joint's x axis, from a to b along the member [rad].
    law : Law
    turn : float
        Share of b's rotation that the joint's axes follow; the rest is a's. ½ for a member, 0 for a support, whose
        axes stay with a.
    """

    a: pymunk.Body
    b: pymunk.Body
    at: tuple[float, float]
    direction: float
    law: Law
    turn: float = 0.5


class Structure(pymunk.Constraint):
    """All joints of a connected structure; add it to a `pymunk.Space` like any other constraint.

    Parameters
    ----------
    joints : sequence of Joint
        At least one.
    beta, delta : float
        Time integration: (0, 1) is implicit Euler, robust and damped; (¼, 0) the average-acceleration rule, second
        order and without damping; (¼, small) damps what a step does not resolve.
    tolerance : float
        Newton's method ends when the residual impulses, as velocities, are below this share of the impulses' own.

    Raises
    ------
    ValueError
        When a joint has no dynamic body, or a number in it is not finite.
    """

    def __init__(self, joints: Sequence[Joint], beta: float = 0.0, delta: float = 1.0, tolerance: float = 1e-9) -> None:
        if not joints:
            raise ValueError("a structure needs at least one joint")
        self.joints = tuple(joints)
        self._order_bodies()
        self._lay_out(beta, delta, tolerance)
        first = self.joints[0]
        self._init(first.a, first.b, chipmunk.pivot(first.a, first.b))
        chipmunk.adopt(self._constraint, kernels.FUNCTIONS, self._control, kernels.AFTER_STEP)

    def _order_bodies(self) -> None:
        bodies = list(dict.fromkeys(body for joint in self.joints for body in (joint.a, joint.b)))
        moving = [body for body in bodies if body.body_type == pymunk.Body.DYNAMIC]
        held = [body for body in bodies if body.body_type != pymunk.Body.DYNAMIC]
        index = {body: i for i, body in enumerate(moving)}
        for i, joint in enumerate(self.joints):
            if joint.a not in index and joint.b not in index:
                raise ValueError(f"joint {i} joins no dynamic body")
        pairs = [(index[j.a], index[j.b]) for j in self.joints if j.a in index and j.b in index]
        self._pattern = minimum_degree(len(moving), pairs)
        #: Bodies of the structure: dynamic ones in order of elimination, then the others.
        self.bodies = tuple([moving[i] for i in self._pattern.order] + held)
        self._moving = len(moving)

    def _lay_out(self, beta: float, delta: float, tolerance: float) -> None:
        """All memory that the kernels work on, and the control table that points to it."""
        n, moving = len(self.joints), self._moving
        index = {body: i for i, body in enumerate(self.bodies)}
        ends = np.array([[index[j.a], index[j.b]] for j in self.joints], dtype=np.int64)
        slots = [self._pattern.slot(ends[i].max(), ends[i].min()) if ends[i].max() < moving else -1 for i in range(n)]
        self._laws = [joint.law for joint in self.joints]
        parameters = [np.ascontiguousarray(j.law.parameters(), dtype=float) for j in self.joints]
        states = [np.ascontiguousarray(j.law.state(), dtype=float) for j in self.joints]
        self._parameters = np.concatenate(parameters)
        self._parameters_from = np.append(_starts(parameters), len(self._parameters))
        self._state = np.concatenate(states)
        laws = np.empty((n, 4), dtype=np.int64)
        laws[:, 0] = [j.law.respond_address for j in self.joints]
        laws[:, 1] = [j.law.commit_address for j in self.joints]
        laws[:, 2] = self._parameters.ctypes.data + 8 * _starts(parameters)
        laws[:, 3] = self._state.ctypes.data + 8 * _starts(states)
        geometry = np.array([_geometry(joint) for joint in self.joints])
        stiffness = np.array([joint.law.elastic_tangent() for joint in self.joints])
        for what, values in (("geometry", geometry), ("stiffness", stiffness)):
            wrong = np.flatnonzero(~np.isfinite(values).all(axis=1))
            if wrong.size:
                raise ValueError(f"joint {wrong[0]} has a {what} that is not finite")

        below = len(self._pattern.column_rows)
        self._settings = np.zeros(kernels.SETTINGS_WORDS)
        self._settings[kernels.BETA] = beta
        self._settings[kernels.DELTA] = delta
        self._settings[kernels.TOLERANCE] = tolerance**2
        self._result = np.zeros((n, kernels.RESULT_WORDS))
        self._arrays: dict[int, np.ndarray] = {
            kernels.BODY_AT: np.array([chipmunk.body_address(body) for body in self.bodies], dtype=np.int64),
            kernels.JOINT_BODIES: ends,
            kernels.GEOMETRY: geometry,
            kernels.LAWS: laws,
            kernels.STIFFNESS: stiffness,
            kernels.COLUMN_START: self._pattern.column_start,
            kernels.COLUMN_ROWS: self._pattern.column_rows,
            kernels.FILL_TARGETS: np.append(self._pattern.fill_targets, 0),
            kernels.JOINT_SLOT: np.array(slots, dtype=np.int64),
            kernels.SETTINGS: self._settings,
            kernels.JACOBIAN: np.zeros((n, 18)),
            kernels.DEFORMATION: np.zeros((n, 3)),
            kernels.IMPULSE: np.zeros((n, 3)),
            kernels.RESIDUAL: np.zeros((n, 3)),
            kernels.SLOPE: np.zeros((n, 3)),
            kernels.RESPONSE: np.zeros((n, kernels.RESPONSE_WORDS)),
            kernels.VELOCITY: np.zeros((len(self.bodies), 3)),
            kernels.SOLUTION: np.zeros((moving, 3)),
            kernels.DIAGONAL: np.zeros((moving, 9)),
            kernels.LOWER_BLOCKS: np.zeros((below, 9)),
            kernels.SCALED_BLOCKS: np.zeros((below, 9)),
            kernels.RESULT: self._result,
        }
        self._control = np.zeros(kernels.CONTROL_WORDS, dtype=np.int64)
        self._control[[kernels.BODIES, kernels.MOVING, kernels.JOINTS, kernels.LOWER]] = (
            len(self.bodies),
            moving,
            n,
            below,
        )
        for word, array in self._arrays.items():
            self._control[word] = array.ctypes.data

    def anchors(self, joint: int) -> tuple[tuple[float, float], tuple[float, float]]:
        """Where a joint holds its bodies a and b, each in that body's own coordinates [m]."""
        ax, ay, bx, by = self._arrays[kernels.GEOMETRY][joint, :4].tolist()
        return (ax, ay), (bx, by)

    def change_law(self, joint: int, law: Law) -> None:
        """Give a joint new numbers for the law it has; its plastic state stays.

        Raises
        ------
        ValueError
            When ``law`` is of another kind or size.
        """
        values = law.parameters()
        first, last = self._parameters_from[joint], self._parameters_from[joint + 1]
        if type(law) is not type(self._laws[joint]) or len(values) != last - first:
            raise ValueError(f"joint {joint} has a law of another kind or size")
        self._parameters[first:last] = values
        self._arrays[kernels.STIFFNESS][joint] = law.elastic_tangent()
        self._laws[joint] = law

    @property
    def deformation(self) -> np.ndarray:
        """Deformation (u, v, θ) of each joint at the end of the last step, (n, 3) [m, m, rad]."""
        return self._result[:, 0:3].copy()

    @property
    def force(self) -> np.ndarray:
        """Force (N, Q, M) that each joint bore in the last step, (n, 3) [N, N, N m]; signs as in `scene`."""
        return self._result[:, 3:6].copy()

    @property
    def elastic_energy(self) -> np.ndarray:
        """Elastic energy in each joint, (n,) [J]."""
        return self._result[:, 6].copy()

    @property
    def dissipated(self) -> np.ndarray:
        """Plastic work that each joint has dissipated, (n,) [J]."""
        return self._result[:, 7].copy()

    @property
    def residual(self) -> float:
        """Residual impulses of the last solve, as a share of the impulses [-]."""
        return float(self._settings[kernels.LAST_RESIDUAL])

    @property
    def newton_steps(self) -> int:
        """Newton steps taken so far."""
        return int(self._control[kernels.NEWTON_STEPS])

    @property
    def unconverged(self) -> int:
        """How many solves so far ended above the tolerance."""
        return int(self._control[kernels.UNCONVERGED])

    def check(self) -> None:
        """Raise when the last step could not be taken.

        Raises
        ------
        SolverError
            When a velocity was not finite; the structure then took no part in that step.
        """
        if self._control[kernels.STATUS] == kernels.NOT_FINITE:
            raise SolverError(
                "the structure's velocities are no longer finite; look for a body that was moved or pushed without "
                "bound, or lower the stiffness or the step"
            )


def _starts(pieces: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([[0], np.cumsum([len(piece) for piece in pieces])[:-1]]).astype(np.int64)


def _geometry(joint: Joint) -> list[float]:
    """Anchors in body coordinates, the frame's rest angle on a and on b, and the share of b's rotation."""
    anchors: list[float] = []
    for body in (joint.a, joint.b):
        dx, dy = joint.at[0] - body.position.x, joint.at[1] - body.position.y
        c, s = math.cos(body.angle), math.sin(body.angle)
        anchors += [c * dx + s * dy, -s * dx + c * dy]
    return [*anchors, joint.direction - joint.a.angle, joint.direction - joint.b.angle, joint.turn]
