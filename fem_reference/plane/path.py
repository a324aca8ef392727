"""Equilibrium paths of a plane body: dead loads first, then a programme of displacements or loads of the pushed edge.

Each step solves, for the displacements d, the load λ on the control degree of freedom c, and the reactions μ of held
means r (rows R),

    F_int(d) + Rᵀ μ = W + λ e_c,   R d = 0,   d_c = goal   or   λ = goal

by Newton's method. The matrix that is factored is K + s Rᵀ R, with e_c among the rows where d_c is prescribed: it is
positive definite on a level path, too, and right once the rows are met, which they are after one iteration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from fem_reference.paths import NotConverged
from fem_reference.plane.boundary import Boundary
from fem_reference.plane.continuum import Continuum, State
from fem_reference.plane.solver import SymmetricSolver

Control = Literal["displacement", "load"]

#: Largest out-of-balance force on a degree of freedom, as a share of the largest force there is.
TOLERANCE = 1e-9
_MOST_ITERATIONS = 16
_SMALLEST_CUT = 2.0**-9
#: A Newton step that overshoots by more than this share of its start is shortened, at most so often.
_OVERSHOOT, _MOST_SHORTENINGS = 0.5, 6
_UNLOADING_STEPS = 8


@dataclass
class Trace:
    """A path point by point; k points, the first under dead loads alone.

    Attributes
    ----------
    displacement, load : list of float
        Of the pushed edge along the push [m, N].
    external, elastic, plastic : list of float
        Work of all loads, energy that unloading would give back, plastic work [J].
    imbalance : float
        Largest resultant of the out-of-balance forces, over the largest load or reaction [-].
    residuals : list of list of float
        Largest out-of-balance force by iteration of each step, over the largest force [-].
    snapshots : list of (float, State)
        Displacement and state at the points that were asked for.
    stopped : str
        Why the path ends before its programme does; empty when it does not.
    """

    displacement: list[float] = field(default_factory=list)
    load: list[float] = field(default_factory=list)
    external: list[float] = field(default_factory=list)
    elastic: list[float] = field(default_factory=list)
    plastic: list[float] = field(default_factory=list)
    imbalance: float = 0.0
    residuals: list[list[float]] = field(default_factory=list)
    snapshots: list[tuple[float, State]] = field(default_factory=list)
    stopped: str = ""


class Body:
    """A continuum with its boundary, on its path.

    Parameters
    ----------
    continuum : Continuum
    edges : Boundary
    dead : (size,) float
        Dead loads [N].
    """

    def __init__(self, continuum: Continuum, edges: Boundary, dead: np.ndarray) -> None:
        self.continuum, self.edges, self.dead = continuum, edges, dead
        self.state = continuum.undeformed()
        self.load = 0.0
        self._share = 0.0
        self._reactions = np.zeros(len(edges.rows))
        self._scale = float(np.abs(continuum.elastic).max())
        push = np.zeros((1, continuum.size))
        push[0, edges.control] = 1.0
        self._rows = {"displacement": np.concatenate([edges.rows, push]), "load": edges.rows}
        self._ties = [np.flatnonzero(row)[None] for row in self._rows["displacement"]]
        self._solver = SymmetricSolver([continuum.dofs, *self._ties], edges.fixed, edges.position)
        self._elastic_solve: dict[str, Callable[[np.ndarray], np.ndarray]] = {}
        self.external = self.plastic = 0.0
        self._out_of_balance = self._all_loads = 0.0
        # Change of displacements, load and reactions per unit of what is controlled, to predict the next step.
        self._slope: tuple[np.ndarray, float, np.ndarray] | None = None

    @property
    def position(self) -> float:
        """Displacement of the pushed edge along the push [m]."""
        return float(self.state.displacement[self.edges.control])

    def carry_dead_loads(self) -> None:
        """Apply the dead loads, the pushed edge being free.

        Raises
        ------
        NotConverged
            When there is no equilibrium under them.
        """
        if self.dead.any():
            self._approach("load", 0.0, 1.0, "a share of the dead loads of", "", dead=True)

    def move_to(self, goal: float) -> list[list[float]]:
        """Move the pushed edge to ``goal`` [m]; returns the residuals of each step that it took."""
        return self._approach("displacement", self.position, goal, "a displacement of", "m")

    def load_to(self, goal: float) -> list[list[float]]:
        """Load the pushed edge with ``goal`` [N]; returns the residuals of each step that it took."""
        return self._approach("load", self.load, goal, "a load of", "N")

    def turn(self) -> None:
        """Forget the way of the last step: the next goes another way, and begins elastically."""
        self._slope = None

    def _approach(
        self, control: Control, start: float, goal: float, what: str, unit: str, dead: bool = False
    ) -> list[list[float]]:
        """From ``start`` to ``goal`` in one step, or in as many as it takes."""
        found = []
        share, done = 1.0, 0.0
        while done < 1.0:
            ahead = min(1.0, done + share)
            here = start + ahead * (goal - start)
            if dead:
                self._share = ahead
            residuals = self._step(control, 0.0 if dead else here)
            if residuals:
                found.append(residuals)
                done, share = ahead, 2.0 * share
            elif share > _SMALLEST_CUT:
                share *= 0.5
                self._slope = None
            else:
                here = start + done * (goal - start)
                raise NotConverged(f"no equilibrium beyond {what} {here:.6g} {unit}".rstrip())
        return found

    def _step(self, control: Control, goal: float) -> list[float]:
        """Newton's method; the residuals if it converged and was accepted, and none if not."""
        free = self._solver.free
        rows = self._rows[control]
        d, load, reactions = self.state.displacement, self.load, self._reactions
        way = goal - (d[self.edges.control] if control == "displacement" else load)
        if self._slope is not None:
            d, reactions = d + way * self._slope[0], reactions + way * self._slope[2]
            load = load + way * self._slope[1]
        load = goal if control == "load" else load
        residuals: list[float] = []
        # Without a way to go on, the first iteration is elastic and begins where the body is.
        elastic = self._slope is None
        try:
            state = self.state if elastic else self.continuum.respond(d, self.state)
            for _ in range(_MOST_ITERATIONS):
                out = self._out_of_balance_at(state, load, reactions)
                gap = -(rows @ d)
                if control == "displacement":
                    gap[-1] += goal
                size = max(float(np.abs(state.internal).max()), float(np.abs(self.dead).max()), abs(load))
                residuals.append(float(np.abs(out).max()) / size if size else 0.0)
                met = np.abs(gap).max(initial=0.0) <= 1e-12 * float(np.abs(d).max(initial=0.0))
                if residuals[-1] <= TOLERANCE and met and not elastic:
                    self._accept(state, load, reactions, way, float(out.sum()))
                    return residuals
                change, pulls = self._solve(control, None if elastic else state.matrices, out, gap)
                elastic = False
                here, length = float(out @ change), 1.0
                for _ in range(_MOST_SHORTENINGS):
                    ahead = d.copy()
                    ahead[free] += length * change
                    raised = load + length * pulls[-1] if control == "displacement" else load
                    pulled = reactions - length * pulls[: len(reactions)]
                    state = self.continuum.respond(ahead, self.state)
                    there = float(self._out_of_balance_at(state, raised, pulled) @ change)
                    # Where the rows are met, the step goes down a convex potential: not far beyond its bottom.
                    if not met or there >= -_OVERSHOOT * abs(here):
                        break
                    length *= max(here / (here - there), 0.1)
                d, load, reactions = ahead, raised, pulled
        except (np.linalg.LinAlgError, ArithmeticError):  # an iterate gone astray: a smaller step may not
            return []
        return []

    def _out_of_balance_at(self, state: State, load: float, reactions: np.ndarray) -> np.ndarray:
        """Forces on the free degrees of freedom that nothing balances [N]."""
        out = self._share * self.dead - state.internal - reactions @ self.edges.rows
        out[self.edges.control] += load
        return np.asarray(out[self._solver.free])

    def _solve(
        self, control: Control, matrices: np.ndarray | None, out: np.ndarray, gap: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Change of the free displacements, and of the forces on the rows; elastically where no ``matrices`` are."""
        rows = self._rows[control][:, self._solver.free]
        if matrices is None:
            if control not in self._elastic_solve:
                self._elastic_solve[control] = self._factor(control, self.continuum.elastic)
            solve = self._elastic_solve[control]
        else:
            solve = self._factor(control, matrices)
        answer = solve(np.column_stack([out, rows.T]))
        alone, unit = answer[:, 0], answer[:, 1:]
        pulls = np.linalg.solve(rows @ unit, gap - rows @ alone) if len(rows) else np.zeros(0)
        return alone + unit @ pulls, pulls - self._scale * gap

    def _factor(self, control: Control, matrices: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        ties = [
            self._scale * np.outer(row[tie[0]], row[tie[0]])[None] * (i < len(self._rows[control]))
            for i, (row, tie) in enumerate(zip(self._rows["displacement"], self._ties, strict=True))
        ]
        return self._solver.factor(matrices, *ties)

    def _accept(self, state: State, load: float, reactions: np.ndarray, way: float, out: float) -> None:
        before, moved = self.state, state.displacement - self.state.displacement
        if way != 0.0:
            self._slope = (moved / way, (load - self.load) / way, (reactions - self._reactions) / way)
        # Loads and held means work on what moves; supports do not move. The trapezoid of both ends of the step.
        self.external += 0.5 * float((before.internal + state.internal) @ moved)
        self.plastic += self.continuum.plastic_work(before, state)
        self.state, self.load, self._reactions = state, load, reactions
        self._out_of_balance = max(self._out_of_balance, abs(out))
        self._all_loads = max(self._all_loads, abs(load), float(np.abs(self._share * self.dead).sum()))

    @property
    def imbalance(self) -> float:
        """Largest sum of the out-of-balance forces so far, over the largest load [-]."""
        return self._out_of_balance / self._all_loads if self._all_loads else 0.0


def trace(
    body: Body,
    legs: Sequence[np.ndarray],
    control: Control = "displacement",
    unload: bool = False,
    snapshots: int = 0,
    watch: Callable[[float], None] = lambda share: None,
) -> Trace:
    """The path of ``body`` through ``legs``.

    Parameters
    ----------
    body : Body
        Left at the end of its path.
    legs : sequence of (k,) float
        Displacements from where the edge is under dead loads [m], or loads [N], leg by leg.
    control : str
        Which of the two.
    unload : bool
        Whether to go back to zero load at the end.
    snapshots : int
        At how many points, evenly chosen, the whole state is kept.
    watch : callable
        Told the finished share of the path, 0 to 1.

    Raises
    ------
    NotConverged
        When the dead loads find no equilibrium. Later on, the path so far is returned.
    """
    body.carry_dead_loads()
    points = Trace()
    start = body.position
    total = sum(len(leg) for leg in legs) + (_UNLOADING_STEPS if unload else 0)
    kept = set(np.linspace(0, total, snapshots).round().astype(int).tolist())

    def record() -> None:
        points.displacement.append(body.position - start)
        points.load.append(body.load)
        points.external.append(body.external)
        points.elastic.append(body.continuum.elastic_energy(body.state))
        points.plastic.append(body.plastic)
        points.imbalance = body.imbalance
        if len(points.load) - 1 in kept:
            points.snapshots.append((points.displacement[-1], body.state))
        watch((len(points.load) - 1) / total if total else 1.0)

    record()
    try:
        for leg in legs:
            body.turn()
            for goal in leg:
                moved = body.move_to(start + goal) if control == "displacement" else body.load_to(float(goal))
                points.residuals += moved
                record()
        if unload:
            body.turn()
            for load in body.load * np.linspace(1.0, 0.0, _UNLOADING_STEPS + 1)[1:]:
                points.residuals += body.load_to(float(load))
                record()
    except NotConverged as error:
        points.stopped = str(error)
    return points
