"""Equilibrium paths of a frame: own weight first, then a push under displacement control."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_reference.banded import BandedSolver
from fem_reference.frame import Frame

#: Energy r · K⁻¹ r of the out-of-balance forces r allowed in a converged step, as a share of the work λ p · d: its
#: root is the relative error of a force. (The forces themselves are no measure: in a very short element they carry
#: rounding errors that do no work.)
TOLERANCE = 1e-18
_MOST_ITERATIONS = 25
_SMALLEST_CUT = 2.0**-12


class NotConverged(RuntimeError):
    """No equilibrium was found, even with the smallest step."""


def push(
    frame: Frame,
    pattern: np.ndarray,
    distances: np.ndarray,
    watch: Callable[[float], None] = lambda share: None,
) -> tuple[np.ndarray, float]:
    """Loads λ at which the frame's displacement along ``pattern`` reaches each of ``distances``.

    The displacement at λ = 0, under own weight alone, counts as distance 0. Solves

        F_int(d) = W + λ p,   p · d = p · d₀ + distance

    by Newton's method for (d, λ) together, so a falling or level path is no obstacle.

    Parameters
    ----------
    frame : Frame
    pattern : (size,) float
        Unit load pattern p [-].
    distances : (k,) float
        Increasing distances along p [m].
    watch : callable
        Told the finished share of the path, 0 to 1.

    Returns
    -------
    loads : (k,) float
        λ at each distance [N].
    imbalance : float
        Largest force by which the whole frame is out of balance along the push, over the largest λ [-].

    Raises
    ------
    NotConverged
        When a step finds no equilibrium.
    """
    solver = _Newton(frame, pattern)
    solver.carry_weight()
    start = float(pattern @ solver.displacement)
    loads = np.empty(len(distances))
    imbalance = 0.0
    for i, distance in enumerate(distances):
        solver.move_to(start + float(distance))
        loads[i] = solver.load
        imbalance = max(imbalance, solver.imbalance)
        watch((i + 1) / len(distances))
    return loads, imbalance / float(np.abs(loads).max())


class _Newton:
    """State of a frame on its path, and the step to the next point."""

    def __init__(self, frame: Frame, pattern: np.ndarray) -> None:
        self.frame = frame
        self.pattern = pattern
        self.solver = BandedSolver(frame.dofs, frame.fixed, frame.size)
        self.displacement = np.zeros(frame.size)
        self.plastic_strain = frame.undeformed()
        self.load = 0.0
        self.imbalance = 0.0
        self._translation = _translation(frame, pattern)[self.solver.free]
        # Change of displacement and load per metre of the push in the last step, to predict the next.
        self.slope: tuple[np.ndarray, float] | None = None

    def carry_weight(self) -> None:
        """Apply the own weight under load control."""
        weight = self.frame.weight
        if not weight.any():
            return
        free = self.solver.free
        d = self.displacement.copy()
        for _ in range(_MOST_ITERATIONS):
            internal, matrices, plastic = self.frame.respond(d, self.plastic_strain)
            residual = (weight - internal)[free]
            change = self.solver.solve(matrices, residual)[:, 0]
            if abs(residual @ change) <= TOLERANCE * abs(weight @ d):
                self.displacement, self.plastic_strain = d, plastic
                return
            d[free] += change
        raise NotConverged("the structure does not carry its own weight")

    def move_to(self, target: float) -> None:
        """Step to p · d = ``target``, in smaller pieces where need be."""
        position = float(self.pattern @ self.displacement)
        share = 1.0
        while position != target:
            goal = target if share == 1.0 else position + share * (target - position)
            if self._step(goal, goal - position):
                position, share = goal, min(1.0, 2.0 * share)
            elif share > _SMALLEST_CUT:
                share *= 0.5
                self.slope = None
            else:
                raise NotConverged(f"no equilibrium beyond a displacement of {position:.6g} m")

    def _step(self, goal: float, distance: float) -> bool:
        free, p = self.solver.free, self.pattern[self.solver.free]
        d, load = self.displacement.copy(), self.load
        if self.slope is not None:
            d += distance * self.slope[0]
            load += distance * self.slope[1]
        for _ in range(_MOST_ITERATIONS):
            internal, matrices, plastic = self.frame.respond(d, self.plastic_strain)
            residual = (self.frame.weight + load * self.pattern - internal)[free]
            gap = goal - float(self.pattern @ d)
            answer = self.solver.solve(matrices, residual, p)
            rise = (gap - float(p @ answer[:, 0])) / float(p @ answer[:, 1])
            change = answer[:, 0] + rise * answer[:, 1]
            if not np.isfinite(rise):
                return False
            if abs(residual @ change) <= TOLERANCE * abs(load * goal) and abs(gap) <= 1e-9 * abs(goal):
                self.slope = ((d - self.displacement) / distance, (load - self.load) / distance)
                self.displacement, self.plastic_strain, self.load = d, plastic, load
                self.imbalance = abs(float(residual @ self._translation))
                return True
            d[free] += change
            load += rise
        return False


def _translation(frame: Frame, pattern: np.ndarray) -> np.ndarray:
    """Displacements of all nodes by one metre along the force in ``pattern``, (size,)."""
    node = next(dofs for dofs in frame.node_dofs.values() if pattern[dofs].any())
    whole = np.zeros(frame.size)
    whole[frame.dofs[:, [0, 3]]], whole[frame.dofs[:, [1, 4]]] = pattern[node[:2]]
    return whole
