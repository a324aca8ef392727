"""A plane body in equilibrium, and the step to its next one.

Each step solves, for the displacements d and the forces f on rows R of degrees of freedom,

    F_int(d) = W + Rᵀ f,   r · d = goal of each active row r,

by Newton's method. The rows are the held means of the boundary, whose goal is 0, and last the pushed edge's degree of
freedom: active where its displacement is prescribed, and with a prescribed force where not. The matrix that is factored
is K + s Rᵀ R over the active rows. It is positive definite on a level path, too, and as right as K once the rows are
met, which they are after one iteration.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from fem_reference.paths import NotConverged
from fem_reference.plane.boundary import Boundary
from fem_reference.plane.continuum import Continuum, State
from fem_reference.plane.solver import SymmetricSolver

Control = Literal["displacement", "load"]

#: Largest out-of-balance force on a degree of freedom, as a share of the largest force there is.
TOLERANCE = 1e-9
#: How far from its goal a row may be, as a share of the largest displacement.
_MET = 1e-12
_MOST_ITERATIONS = 16
_SMALLEST_CUT = 2.0**-9
#: A Newton step that overshoots by more than this share of its start is shortened, at most so often.
_OVERSHOOT, _MOST_SHORTENINGS = 0.5, 6


class Body:
    """A continuum with its boundary, at rest.

    Parameters
    ----------
    continuum : Continuum
    edges : Boundary
    dead : (size,) float
        Dead loads [N].

    Attributes
    ----------
    state : State
    external, plastic : float
        Work of all loads so far, and plastic work [J].
    """

    def __init__(self, continuum: Continuum, edges: Boundary, dead: np.ndarray) -> None:
        self.continuum, self.edges = continuum, edges
        self.state = continuum.undeformed()
        self.external = self.plastic = 0.0
        self._dead, self._share = dead, 0.0
        push = np.arange(continuum.size) == edges.control
        self._rows = np.vstack([edges.rows, push])
        self._forces = np.zeros(len(self._rows))
        self._scale = float(np.abs(continuum.elastic).max())
        self._tied = [np.flatnonzero(row) for row in self._rows]
        self._solver = SymmetricSolver(
            [continuum.dofs, *(dofs[None] for dofs in self._tied)], edges.fixed, edges.position
        )
        self._elastic: dict[int, Callable[[np.ndarray], np.ndarray]] = {}
        self._out_of_balance = self._all_loads = 0.0
        # Change of displacements and forces per unit of what is controlled in the last step, to predict the next.
        self._slope: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def position(self) -> float:
        """Displacement of the pushed edge along the push [m]."""
        return float(self.state.displacement[self.edges.control])

    @property
    def load(self) -> float:
        """Force on the pushed edge along the push [N]."""
        return float(self._forces[-1])

    @property
    def imbalance(self) -> float:
        """Largest resultant of the out-of-balance forces so far, over the largest sum of loads [-]."""
        return self._out_of_balance / self._all_loads if self._all_loads else 0.0

    def carry_dead_loads(self) -> None:
        """Apply the dead loads, the pushed edge being free.

        Raises
        ------
        NotConverged
            When there is no equilibrium under them.
        """
        if self._dead.any():
            self._approach("load", 0.0, 0.0, "the dead loads beyond {0:.3g} of them", dead=True)
            self.turn()

    def move_to(self, goal: float) -> list[list[float]]:
        """Move the pushed edge to ``goal`` [m]; returns the residuals of each step that it took, by iteration [-].

        Raises
        ------
        NotConverged
            When there is no equilibrium on the way.
        """
        return self._approach("displacement", self.position, goal, "a displacement of {1:.6g} m")

    def load_to(self, goal: float) -> list[list[float]]:
        """Load the pushed edge with ``goal`` [N]; otherwise like `move_to`."""
        return self._approach("load", self.load, goal, "a load of {1:.6g} N")

    def turn(self) -> None:
        """Forget the way of the last step: the next goes another way, and begins elastically."""
        self._slope = None

    def _approach(
        self, control: Control, start: float, goal: float, limit: str, dead: bool = False
    ) -> list[list[float]]:
        """From ``start`` to ``goal`` in one step, or in as many as it takes."""
        found = []
        share, done = 1.0, 0.0
        while done < 1.0:
            ahead = min(1.0, done + share)
            if dead:
                self._share = ahead
            residuals = self._step(control, start + ahead * (goal - start))
            if residuals:
                found.append(residuals)
                done, share = ahead, 2.0 * share
            elif share > _SMALLEST_CUT:
                share *= 0.5
                self.turn()
            else:
                raise NotConverged("no equilibrium beyond " + limit.format(done, start + done * (goal - start)))
        return found

    def _step(self, control: Control, goal: float) -> list[float]:
        """Newton's method; its residuals if it converged and was accepted, none if not."""
        d, forces = self.state.displacement, self._forces
        way = goal - (self.position if control == "displacement" else self.load)
        if self._slope is not None:
            d, forces = d + way * self._slope[0], forces + way * self._slope[1]
        active = len(self._rows) if control == "displacement" else len(self._rows) - 1
        goals = np.zeros(active)
        if control == "displacement":
            goals[-1] = goal
        else:
            forces = np.append(forces[:-1], goal)
        residuals: list[float] = []
        # Without a way to go on, the first iteration is elastic and begins where the body is.
        elastic = self._slope is None
        try:
            state = self.state if elastic else self.continuum.respond(d, self.state)
            for _ in range(_MOST_ITERATIONS):
                out = self._out_of_balance_at(state, forces)
                gap = goals - self._rows[:active] @ d
                largest = max(float(np.abs(v).max()) for v in (state.internal, self._dead, forces))
                residuals.append(float(np.abs(out).max()) / largest if largest else 0.0)
                met = bool(np.abs(gap).max(initial=0.0) <= _MET * np.abs(d).max())
                if residuals[-1] <= TOLERANCE and met and not elastic:
                    self._accept(state, forces, way, out)
                    return residuals
                change, pulls = self._solve(None if elastic else state.matrices, out, gap)
                d, forces, state = self._advance(d, forces, change, pulls, float(out @ change) if met else np.inf)
                elastic = False
        except (np.linalg.LinAlgError, ArithmeticError):  # an iterate gone astray: a smaller step may not
            return []
        return []

    def _advance(
        self, d: np.ndarray, forces: np.ndarray, change: np.ndarray, pulls: np.ndarray, here: float
    ) -> tuple[np.ndarray, np.ndarray, State]:
        """Displacements and forces changed, and the state there.

        Where the rows are met, Newton's step goes down a convex potential, whose slope is now -``here``: it is
        shortened so as not to end far up the other side.
        """
        length = 1.0
        for _ in range(_MOST_SHORTENINGS):
            ahead, pulled = d.copy(), forces.copy()
            ahead[self._solver.free] += length * change
            pulled[: len(pulls)] += length * pulls
            state = self.continuum.respond(ahead, self.state)
            there = float(self._out_of_balance_at(state, pulled) @ change)
            if there >= -_OVERSHOOT * abs(here):
                break
            length *= max(here / (here - there), 0.1)
        return ahead, pulled, state

    def _out_of_balance_at(self, state: State, forces: np.ndarray) -> np.ndarray:
        """Forces on the free degrees of freedom that nothing balances [N]."""
        out = self._share * self._dead - state.internal + forces @ self._rows
        return np.asarray(out[self._solver.free])

    def _solve(self, matrices: np.ndarray | None, out: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Changes of the free displacements and of the forces on active rows; elastic ones without ``matrices``."""
        active = len(gap)
        if matrices is not None:
            solve = self._factor(matrices, active)
        elif active in self._elastic:
            solve = self._elastic[active]
        else:
            solve = self._elastic[active] = self._factor(self.continuum.elastic, active)
        rows = self._rows[:active, self._solver.free]
        answer = solve(np.column_stack([out, rows.T]))
        alone, unit = answer[:, 0], answer[:, 1:]
        pulls = np.linalg.solve(rows @ unit, gap - rows @ alone) if active else np.zeros(0)
        return alone + unit @ pulls, pulls - self._scale * gap

    def _factor(self, matrices: np.ndarray, active: int) -> Callable[[np.ndarray], np.ndarray]:
        ties = [np.outer(row[dofs], row[dofs])[None] for row, dofs in zip(self._rows, self._tied, strict=True)]
        return self._solver.factor(matrices, *(self._scale * (i < active) * tie for i, tie in enumerate(ties)))

    def _accept(self, state: State, forces: np.ndarray, way: float, out: np.ndarray) -> None:
        before, moved = self.state, state.displacement - self.state.displacement
        if way != 0.0:
            self._slope = (moved / way, (forces - self._forces) / way)
        # Only loads work, for supports do not move: the trapezoid of both ends of the step.
        self.external += 0.5 * float((before.internal + state.internal) @ moved)
        self.plastic += self.continuum.plastic_work(before, state)
        self.state, self._forces = state, forces
        resultant = out @ self.edges.directions[self._solver.free]
        self._out_of_balance = max(self._out_of_balance, float(np.hypot(*resultant)))
        self._all_loads = max(self._all_loads, abs(self.load) + self._share * float(np.abs(self._dead).sum()))
