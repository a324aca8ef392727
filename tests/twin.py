"""The structure solver in plain numpy: dense matrices, no compiled code, perfectly plastic joints."""

from dataclasses import dataclass

import numpy as np


@dataclass
class Twin:
    """Bodies and joints as arrays; fixed bodies have infinite mass.

    position (b, 3) is x, y, angle; velocity (b, 3); mass (b, 3) is m, m, I. Joints: ends (n, 2); anchors (n, 2, 2) in
    body coordinates; rest (n, 2), the frame's angle on each body; turn (n,); arc (n,), extension over
    rotation squared; stiffness and cap (n, 3).
    """

    position: np.ndarray
    velocity: np.ndarray
    mass: np.ndarray
    ends: np.ndarray
    anchors: np.ndarray
    rest: np.ndarray
    turn: np.ndarray
    arc: np.ndarray
    stiffness: np.ndarray
    cap: np.ndarray
    beta: float = 0.0
    delta: float = 1.0

    def __post_init__(self) -> None:
        self.slip = np.zeros_like(self.stiffness)
        self.force = np.zeros_like(self.stiffness)
        # A velocity given before the first step acts when the forces do.
        self.last = np.zeros_like(self.velocity)

    def kinematics(self) -> tuple[np.ndarray, np.ndarray]:
        """Deformations (n, 3) and their gradient (3n, 3b)."""
        n, bodies = len(self.ends), len(self.position)
        q, jacobian = np.empty((n, 3)), np.zeros((n, 3, bodies, 3))
        for k, (a, b) in enumerate(self.ends):
            angles = self.position[[a, b], 2]
            turned = [np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]]) for t in angles]
            arms = [turned[i] @ self.anchors[k, i] for i in (0, 1)]
            d = self.position[b, :2] + arms[1] - self.position[a, :2] - arms[0]
            frame = angles + self.rest[k]
            share = np.array([1.0 - self.turn[k], self.turn[k]])
            psi = share @ frame
            axes = np.array([[np.cos(psi), np.sin(psi)], [-np.sin(psi), np.cos(psi)]])
            u, v = axes @ d
            q[k] = u, v, frame[1] - frame[0]
            for i, body in enumerate((a, b)):
                sign = 2 * i - 1
                jacobian[k, :2, body, :2] = sign * axes
                jacobian[k, :2, body, 2] = sign * axes @ [-arms[i][1], arms[i][0]] + share[i] * np.array([v, -u])
                jacobian[k, 2, body, 2] = sign
            q[k, 0] -= self.arc[k] * q[k, 2] ** 2
            jacobian[k, 0] -= 2.0 * self.arc[k] * q[k, 2] * jacobian[k, 2]
        return q, jacobian.reshape(3 * n, 3 * bodies)

    def step(self, h: float, push: np.ndarray) -> None:
        """One step of Chipmunk's order: move, find q and J, add the forces' ``push`` (b, 3), solve."""
        self.position = self.position + h * self.last
        q, jacobian = self.kinematics()
        old, reach = self.last.ravel(), h * (self.beta + self.delta)
        k, cap, inverse = self.stiffness.ravel(), self.cap.ravel(), 1.0 / self.mass.ravel()
        free = self.velocity.ravel() + h * inverse * push.ravel()
        v, impulse = free.copy(), np.zeros(k.size)
        for iteration in range(60):
            trial = k * (q.ravel() - self.beta * h * jacobian @ old + reach * jacobian @ v - self.slip.ravel())
            force = np.clip(trial, -cap, cap)
            residual = -h * force - impulse
            if np.abs(jacobian.T @ residual * inverse).max() <= 1e-15 * np.abs(jacobian.T @ force * inverse).max():
                break
            tangent = np.where((np.abs(trial) < cap) | (iteration == 0), k, 0.0)
            compliance = jacobian * inverse @ jacobian.T
            # (1 + h² D J M⁻¹ Jᵀ) Δλ = r: the joints' own form of the Newton step.
            change = np.linalg.solve(np.eye(k.size) + h * reach * tangent[:, None] * compliance, residual)
            impulse += change
            v = free + inverse * (jacobian.T @ impulse)
        self.velocity = self.last = v.reshape(-1, 3)
        trial = k * (q.ravel() - self.beta * h * jacobian @ old + reach * jacobian @ v - self.slip.ravel())
        self.force = np.clip(trial, -cap, cap).reshape(-1, 3)
        with np.errstate(divide="ignore", invalid="ignore"):
            slip = np.where(k > 0.0, (trial - self.force.ravel()) / k, 0.0)
        # By the midpoint rule, flow up to q* is that of a part of the step only.
        whole = 1.0 if self.beta == 0.0 else 1.0 / (0.5 + self.delta)
        self.slip = self.slip + whole * slip.reshape(-1, 3)
