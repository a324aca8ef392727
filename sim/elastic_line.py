"""The line of a member that is cut into rigid pieces: where its joints put the pieces, and back.

Points and vectors are complex numbers, x + iy, so that turning by an angle is a multiplication. A joint i lies at
``points[i]`` along the member. Its a-side has the angle α, and it puts its b-side, with deformations q = (u, v, θ),

    at e^{i (α + θ/2)} (u + a θ² + i v) + e^{iα} (k_u + i k_v) from a, turned by θ + k_θ,

a θ² being the way by which an arc falls short of a kink (see `sim.kernels.kinematics`), and k a kink that stays. Ends
that nothing holds count as joints that do not give.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_MOST_STEPS, _CLOSED = 60, 1e-12


@dataclass(frozen=True)
class End:
    """The side of an end joint that does not belong to the member: where it is, and the angle of its axis [rad]."""

    at: complex
    angle: float


@dataclass(frozen=True)
class Chain:
    """Joints of a member, from its start to its end.

    Attributes
    ----------
    points : (n,) float
        Along the member [m].
    stops : (n,) float
        Where the pieces between them begin and end along the member [m]; at nodes not at the joints.
    stiffness : (n, 3, 3) float
        ∂(N, Q, M) / ∂(u, v, θ) while elastic; 0 for a hinge's rotation, and at an end that nothing holds.
    arc : (n,) float
        Extension over the square of the rotation.
    rest : (n, 3) float
        Deformation at which a joint bears nothing.
    kink : (n, 3) float
        Of the joint's place on its bodies.
    held : (bool, bool)
        Whether there is a joint at the start, and at the end.
    """

    points: np.ndarray
    stops: np.ndarray
    stiffness: np.ndarray
    arc: np.ndarray
    rest: np.ndarray
    kink: np.ndarray
    held: tuple[bool, bool]

    @property
    def middles(self) -> np.ndarray:
        """Of the pieces, along the member (n - 1,) [m]."""
        middles: np.ndarray = 0.5 * (self.stops[:-1] + self.stops[1:])
        return middles

    @property
    def joints(self) -> slice:
        """Those points that have a joint."""
        return slice(0 if self.held[0] else 1, len(self.points) if self.held[1] else len(self.points) - 1)

    def deformation(self, poses: np.ndarray, start: End, end: End) -> np.ndarray:
        """Deformations of the joints between pieces with ``poses`` (x, y, angle) (n - 1, 3), (n, 3)."""
        centre, turned = poses[:, 0] + 1j * poses[:, 1], poses[:, 2]
        way = np.exp(1j * turned)
        left, right = centre + way * (self.points[:-1] - self.middles), centre + way * (self.points[1:] - self.middles)
        a_at, b_at = np.append(start.at, right), np.append(left, end.at)
        a_angle, b_angle = np.append(start.angle, turned), np.append(turned, end.angle)
        q = np.zeros((len(self.points), 3))
        q[:, 2] = b_angle - a_angle - self.kink[:, 2]
        gap = b_at - a_at - np.exp(1j * a_angle) * (self.kink[:, 0] + 1j * self.kink[:, 1])
        local = gap * np.exp(-1j * (a_angle + 0.5 * q[:, 2]))
        q[:, 0], q[:, 1] = local.real - self.arc * q[:, 2] ** 2, local.imag
        for side, i in enumerate((0, -1)):
            if not self.held[side]:
                q[i] = 0.0
        return q

    def force(self, q: np.ndarray) -> np.ndarray:
        """N, Q and M that the joints bear at deformations ``q`` while elastic, (n, 3)."""
        bears: np.ndarray = np.einsum("nij,nj->ni", self.stiffness, q - self.rest)
        return bears

    def energy(self, q: np.ndarray) -> np.ndarray:
        """Elastic energy of each joint, (n,) [J]."""
        stored: np.ndarray = 0.5 * np.einsum("ni,ni->n", q - self.rest, self.force(q))
        return stored

    def excess(self, q: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Of deformations ``q`` what neither ``force`` nor what is at rest explains, (n, 3); of hinges the rotation."""
        rest: np.ndarray = q - self.rest - np.einsum("nij,nj->ni", self._compliance(), force)
        return rest

    def laid(self, force: np.ndarray, excess: np.ndarray, start: End | None, end: End | None) -> np.ndarray | None:
        """Poses (n - 1, 3) at which the joints bear ``force`` (n, 3), but for what closes the line between its ends.

        What closes it are forces that are in equilibrium by themselves: a constant N and Q, and a straight M. Joints
        are deformed further by an ``excess`` (n, 3); at hinges the rotation is free, and that to begin with. A line
        that is held at one end goes from there; of one that nothing holds only the shape means anything. None when it
        does not close.
        """
        compliance, given = self._compliance(), self.rest + excess
        hinges = np.flatnonzero(self._hinged())
        # Rows N, Q, M of what a unit of N, Q and M at the start is at each joint; it is no moment at a hinge.
        balance = np.zeros((len(self.points), 3, 3))
        balance[:, [0, 1, 2], [0, 1, 2]] = 1.0
        balance[:, 2, 1] = self.points[0] - self.points
        matrix = np.zeros((3 + len(hinges), 3 + len(hinges)))
        matrix[3:, :3] = balance[hinges, 2]
        closing = np.zeros(3)
        for _ in range(_MOST_STEPS):
            q = given + np.einsum("nij,nj->ni", compliance, force + balance @ closing)
            b_at, after, frames = self._march(q, start or End(0.0j, 0.0))
            if start is None or end is None:
                return self._poses(b_at, after, end if start is None else None)
            miss = np.array([(end.at - b_at[-1]).real, (end.at - b_at[-1]).imag, end.angle - after[-1]])
            if np.abs(miss).max() <= _CLOSED * (self.points[-1] + np.abs(end.at)):
                return self._poses(b_at, after, None)
            # How a joint's deformations move the line's end.
            moves = np.zeros((len(self.points), 3, 3))
            moves[:, 0, 0], moves[:, 1, 0] = frames.real, frames.imag
            moves[:, 0, 1], moves[:, 1, 1] = -frames.imag, frames.real
            arm = b_at[-1] - b_at
            moves[:, 0, 2], moves[:, 1, 2], moves[:, 2, 2] = -arm.imag, arm.real, 1.0
            matrix[:3, :3] = np.einsum("nij,njk,nkl->il", moves, compliance, balance)
            matrix[:3, 3:] = moves[hinges, :, 2].T
            change = np.linalg.solve(matrix, np.append(miss, -matrix[3:, :3] @ closing))
            if not np.isfinite(change).all():
                return None
            closing += change[:3]
            given[hinges, 2] += change[3:]
        return None

    def _hinged(self) -> np.ndarray:
        """Which joints bear no moment, (n,) bool."""
        hinged = np.zeros(len(self.points), dtype=bool)
        hinged[self.joints] = self.stiffness[self.joints, 2, 2] == 0.0
        return hinged

    def _compliance(self) -> np.ndarray:
        """Inverse of the stiffness; none for a hinge's rotation, and where there is no joint."""
        c, hinged = np.zeros_like(self.stiffness), self._hinged()[self.joints]
        stiffness = self.stiffness[self.joints].copy()
        stiffness[hinged, 2, 2] = 1.0
        inverse = np.linalg.inv(stiffness)
        inverse[hinged, 2, 2] = 0.0
        c[self.joints] = inverse
        return c

    def _march(self, q: np.ndarray, start: End) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where each joint's b-side is, its angle, and the direction of the joint's axis, (n,) each."""
        after = start.angle + np.cumsum(q[:, 2] + self.kink[:, 2])
        before = np.append(start.angle, after[:-1])
        frames = np.exp(1j * (before + 0.5 * q[:, 2]))
        jump = frames * (q[:, 0] + self.arc * q[:, 2] ** 2 + 1j * q[:, 1])
        jump += np.exp(1j * before) * (self.kink[:, 0] + 1j * self.kink[:, 1])
        way = np.append(0.0, np.exp(1j * after[:-1]) * np.diff(self.points))
        return start.at + np.cumsum(jump + way), after, frames

    def _poses(self, b_at: np.ndarray, after: np.ndarray, end: End | None) -> np.ndarray:
        """Poses of the pieces; the whole moved so that it ends at ``end``, if that is given."""
        angle, turn, pivot, goal = after[:-1], 0.0, 0.0j, 0.0j
        if end is not None:
            turn, pivot, goal = end.angle - after[-1], b_at[-1], end.at
        centre = b_at[:-1] + np.exp(1j * angle) * (self.middles - self.points[:-1])
        centre = goal + np.exp(1j * turn) * (centre - pivot)
        return np.column_stack([centre.real, centre.imag, angle + turn])


def interpolated(chain: Chain, force: np.ndarray, at: np.ndarray) -> np.ndarray:
    """N, Q and M at points ``at`` along a member that bears ``force`` (n, 3) at the joints of ``chain``.

    Between two joints N is straight, and M the cubic that has there the moments and, Q = -dM/dx, the shear forces: what
    a load gives that changes evenly along the member, as that of inertia. What belongs to the nodes bears on them, so
    at both ends M goes straight until the pieces begin.
    """
    points, known = chain.points.copy(), force.copy()
    points[[0, -1]] = chain.stops[[0, -1]]
    known[[0, -1], 2] -= force[[0, -1], 1] * (points - chain.points)[[0, -1]]
    i = np.clip(np.searchsorted(points, at, side="right") - 1, 0, len(points) - 2)
    length = points[i + 1] - points[i]
    t = (at - points[i]) / length
    (N0, Q0, M0), (N1, Q1, M1) = known[i].T, known[i + 1].T
    M = (1 + 2 * t) * (1 - t) ** 2 * M0 + t**2 * (3 - 2 * t) * M1
    M -= length * (t * (1 - t) ** 2 * Q0 - t**2 * (1 - t) * Q1)
    slope = 6 * t * (1 - t) * (M1 - M0) / length - (1 - t) * (1 - 3 * t) * Q0 - t * (3 * t - 2) * Q1
    found = np.column_stack([(1 - t) * N0 + t * N1, -slope, M])
    found[[0, -1]] = force[[0, -1]]
    return found
