"""Points of equilibrium of a frame, one after the other. Each step solves

    F_int(d) = W + λ p,   c · d + e λ = goal

by Newton's method for (d, λ) together. With (c, e) = (control, 0) it prescribes a displacement, so a falling or level
path is no obstacle; with (0, 1) the load.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fem_reference.banded import BandedSolver
from fem_reference.frame import Frame, Response

#: Energy r · K⁻¹ r of the out-of-balance forces r allowed in a converged step, as a share of the work done so far: its
#: root is the relative error of a force. (The forces themselves are no measure: in a very short element they carry
#: rounding errors that do no work.)
TOLERANCE = 1e-18
#: Where a section yields throughout, the last forces come slowly; a step that is late need not be better than this.
LATE_TOLERANCE = 1e-16
_MOST_ITERATIONS, _LATE = 25, 10
#: Newton steps on a kinked path may first go astray; they are cut when the work of out-of-balance forces grows by more.
_GROWTH = 1e3
_MOST_CUTS = 5
_SMALLEST_CUT = 2.0**-12


class NotConverged(RuntimeError):
    """No equilibrium was found, even with the smallest step."""


@dataclass
class Trace:
    """A path point by point; k points, the first under dead loads alone.

    Attributes
    ----------
    displacement, load : list of float
        Displacement under control, from the first point [m], and load factor λ.
    displacements : list of (size,) float
        Of all degrees of freedom.
    strain, stress : list of (n, 2, 3) float
        ε₀, κ, γ and N, M, Q at the quadrature points.
    plastic_strain : list of (n, 2) float
        Largest plastic strain of any fibre there [-].
    element_forces : list of (n, 8) float
        Forces on the elements' degrees of freedom, in global axes.
    external, elastic, plastic : list of float
        Work of all loads, energy stored in members and springs, plastic work [J].
    imbalance : float
        Largest resultant of the out-of-balance forces, over the largest sum of loads [-].
    stopped : str
        Why the path ends before its programme does; empty when it does not.
    """

    displacement: list[float] = field(default_factory=list)
    load: list[float] = field(default_factory=list)
    displacements: list[np.ndarray] = field(default_factory=list)
    strain: list[np.ndarray] = field(default_factory=list)
    stress: list[np.ndarray] = field(default_factory=list)
    plastic_strain: list[np.ndarray] = field(default_factory=list)
    element_forces: list[np.ndarray] = field(default_factory=list)
    external: list[float] = field(default_factory=list)
    elastic: list[float] = field(default_factory=list)
    plastic: list[float] = field(default_factory=list)
    imbalance: float = 0.0
    stopped: str = ""


class State:
    """A frame on its path, and the step to the next point."""

    def __init__(self, frame: Frame, control: np.ndarray) -> None:
        self.frame = frame
        self.control = control
        self.solver = BandedSolver(frame.dofs, frame.fixed, frame.size)
        self.displacement = np.zeros(frame.size)
        self.load = 0.0
        self.response: Response = frame.respond(self.displacement, frame.undeformed())
        self.external = self.plastic = 0.0
        self._out_of_balance = self._all_loads = 0.0
        # Change of displacement and load per unit of what is controlled in the last step, to predict the next.
        self.slope: tuple[np.ndarray, float] | None = None
        self._dead = 0.0
        self._work = 0.0

    @property
    def position(self) -> float:
        """Displacement under control [m]."""
        return float(self.control @ self.displacement)

    @property
    def imbalance(self) -> float:
        """Largest resultant of the out-of-balance forces so far, over the largest sum of loads and reactions [-]."""
        return self._out_of_balance / self._all_loads if self._all_loads else 0.0

    def record(self, points: Trace, start: float) -> None:
        """Append this state to ``points``."""
        points.displacement.append(self.position - start)
        points.load.append(self.load)
        points.displacements.append(self.displacement)
        points.strain.append(self.response.strain)
        points.stress.append(self.response.stress)
        points.plastic_strain.append(self.frame.largest_plastic_strain(self.response))
        points.element_forces.append(self.response.element_forces)
        points.external.append(self.external)
        points.elastic.append(self.frame.elastic_energy(self.response) + self.frame.spring_energy(self.displacement))
        points.plastic.append(self.plastic)
        points.imbalance = self.imbalance

    @property
    def standing(self) -> bool:
        """Whether the frame stands by itself under the loads that it bears: K is positive definite, or nearly."""
        return self._sign_and_way()[0] > 0.0

    @property
    def unique(self) -> bool:
        """Whether the path through this state is the only one, and stable, while the way of the loads is prescribed.

        K bordered with the load pattern p has a determinant with the sign of det K · pᵀ K⁻¹ p. That is positive for a
        structure that stands, at limit points of the load both change, and where a second path branches off one does
        (W. T. Koiter, On the stability of elastic equilibrium, 1945; for plastic structures R. Hill, 1958).
        """
        sign, way = self._sign_and_way()
        return sign * float(self.frame.pattern @ way) > 0.0

    @property
    def reach(self) -> float:
        """Displacement under control for a unit of the load pattern, over the largest of any [-]."""
        way = self._sign_and_way()[1]
        return float(self.control @ way) / max(float(np.abs(way).max()), np.finfo(float).tiny)

    def _sign_and_way(self) -> tuple[float, np.ndarray]:
        """The sign of det K, and K⁻¹ p, (size,)."""
        response, free, way = self.response, self.solver.free, np.zeros(self.frame.size)
        sign, answer = self.solver.solve_with_sign(response.matrices, response.springs, self.frame.pattern[free])
        way[free] = answer[:, 0]
        return sign, way

    def carry_dead_loads(self) -> None:
        """Apply dead loads and settlements together."""
        if not self.frame.weight.any() and not self.frame.settlement.any():
            return
        done, share = 0.0, 1.0
        while done < 1.0:
            goal = min(1.0, done + share)
            self._dead = goal
            if self._step(0.0, np.zeros(self.frame.size), 1.0):
                done, share = goal, 2.0 * share
            elif share > _SMALLEST_CUT:
                share *= 0.5
            else:
                raise NotConverged(
                    f"the structure does not carry its own weight and dead loads beyond {done:.3g} of them"
                )
        self.slope = None

    def release_dead_loads(self) -> None:
        """Let dead loads act from now on, unbalanced: a structure that falls does not bear them."""
        self._dead = 1.0

    @property
    def applied(self) -> np.ndarray:
        """Loads that act, (size,)."""
        return self._dead * self.frame.weight + self.load * self.frame.pattern

    def move_to(self, target: float) -> None:
        """Step to the displacement ``target``, in smaller pieces where need be."""
        self._advance(self.position, target, self.control, 0.0, "displacement", "m")

    def load_to(self, target: float) -> None:
        """Step to the load factor ``target``, in smaller pieces where need be."""
        self._advance(self.load, target, np.zeros(self.frame.size), 1.0, "load factor", "")

    def step_to(self, goal: float, normal: np.ndarray) -> bool:
        """One step to the plane ``normal`` · d = ``goal``, predicted by `slope`; whether it found equilibrium."""
        return self._step(goal, normal, 0.0)

    def _advance(self, position: float, target: float, c: np.ndarray, e: float, what: str, unit: str) -> None:
        share = 1.0
        while position != target:
            goal = target if share == 1.0 else position + share * (target - position)
            if self._step(goal, c, e):
                position, share = goal, min(1.0, 2.0 * share)
            elif share > _SMALLEST_CUT:
                share *= 0.5
                self.slope = None
            else:
                raise NotConverged(f"no equilibrium beyond a {what} of {position:.6g} {unit}".rstrip())

    @np.errstate(over="ignore", invalid="ignore")  # of iterates that are far astray, which are given up
    def _step(self, goal: float, c: np.ndarray, e: float) -> bool:
        """Newton's method to c · d + e λ = ``goal``; whether it converged and was accepted."""
        frame, free = self.frame, self.solver.free
        d, load = self.displacement.copy(), self.load
        distance = goal - float(c @ d) - e * load
        if self.slope is not None:
            d += distance * self.slope[0]
            load += distance * self.slope[1]
        settling = np.zeros(frame.size)
        settling[frame.fixed] = self._dead * frame.settlement - d[frame.fixed]
        if settling.any():
            # The rest of the frame follows as it would elastically; a support that moved alone would tear its member.
            pull = np.einsum("eij,ej->ei", self.response.matrices, settling[frame.dofs])
            force = np.bincount(frame.dofs.ravel(), weights=pull.ravel(), minlength=frame.size)
            settling[free] = self.solver.solve(self.response.matrices, self.response.springs, -force[free])[:, 0]
            d += settling
        response, applied, residual = self._balance(d, load)
        for iteration in range(_MOST_ITERATIONS):
            tolerance = TOLERANCE if iteration < _LATE else LATE_TOLERANCE
            gap = goal - float(c @ d) - e * load
            try:
                answer = self.solver.solve(response.matrices, response.springs, residual, frame.pattern[free])
            except np.linalg.LinAlgError:  # an iterate with a singular tangent: a smaller step may pass it by
                return False
            gained = float(c[free] @ answer[:, 1]) + e
            if gained == 0.0:  # the loads do not move what is controlled
                return False
            rise = (gap - float(c[free] @ answer[:, 0])) / gained
            change = answer[:, 0] + rise * answer[:, 1]
            here = float(residual @ change)
            if not np.isfinite([rise, here]).all():
                return False
            reactions = float(response.internal[frame.fixed] @ d[frame.fixed])
            work = max(self._work, abs(float(applied @ d)) + abs(reactions))
            on_goal = abs(gap) <= 1e-9 * max(abs(goal), abs(distance))
            if abs(here) <= tolerance * work and on_goal:
                # The load itself may still be out of balance: where every section yields it moves nothing, and
                # does no work.
                left = residual + rise * frame.pattern[free]
                self._accept(d, load + rise, distance, response, applied + rise * frame.pattern, left)
                self._work = work
                return True
            # Line search: not so far that the out-of-balance forces explode.
            there, length = np.inf, 1.0
            for cut in range(_MOST_CUTS):
                if cut:
                    length *= min(max(here / (here - there), 0.1), 0.5)
                ahead, factor = d.copy(), load + length * rise
                ahead[free] += length * change
                response, applied, residual = self._balance(ahead, factor)
                there = float(np.nan_to_num(residual @ change, nan=np.inf))
                if not on_goal or abs(there) <= max(_GROWTH * abs(here), TOLERANCE * work):
                    break
            d, load = ahead, factor
        return False

    def _balance(self, d: np.ndarray, load: float) -> tuple[Response, np.ndarray, np.ndarray]:
        """The frame's response, the loads on it, and the forces on free degrees of freedom that are out of balance."""
        response = self.frame.respond(d, self.response.slip)
        applied = self._dead * self.frame.weight + load * self.frame.pattern
        return response, applied, (applied - response.internal)[self.solver.free]

    def _accept(
        self,
        d: np.ndarray,
        load: float,
        distance: float,
        response: Response,
        applied: np.ndarray,
        residual: np.ndarray,
    ) -> None:
        frame = self.frame
        moved = d - self.displacement
        if distance != 0.0:
            self.slope = (moved / distance, (load - self.load) / distance)
        # Loads work on what is free, reactions on the settlements: together the trapezoid of both ends of the step.
        before = self.response.internal
        after = response.internal
        self.external += 0.5 * float((before + after) @ moved)
        self.plastic += frame.plastic_work(self.response, response)
        self.displacement, self.load, self.response = d, load, response
        out = np.zeros(frame.size)
        out[self.solver.free] = residual
        pulls = [out[frame.dofs_of(axis)].sum() for axis in (0, 1)]
        self._out_of_balance = max(self._out_of_balance, float(np.hypot(*pulls)))
        loads = np.abs(applied).sum() + np.abs(after[frame.fixed]).max(initial=0.0)
        self._all_loads = max(self._all_loads, float(loads))
