"""A frame in motion and its next step in time, by the generalised-α method.

J. Chung and G. M. Hulbert, A time integration algorithm for structural dynamics with improved numerical dissipation:
the generalized-α method, J. Appl. Mech. 60 (1993). From (d₀, v₀, a₀) to the end of a step h,

    M [(1 - α_m) a₁ + α_m a₀] + f((1 - α_f) d₁ + α_f d₀) = F,
    d₁ = d₀ + h v₀ + h² [(1/2 - β) a₀ + β a₁],   v₁ = v₀ + h [(1 - γ) a₀ + γ a₁],

    α_m = (2ρ - 1) / (ρ + 1),   α_f = ρ / (ρ + 1),   β = (1 - α_m + α_f)² / 4,   γ = 1/2 - α_m + α_f,

of second order for any ρ in [0, 1], the share of the highest frequencies' amplitude that a step leaves: 1 dissipates
nothing, 0 takes them out at once. Solved for d₁ by Newton's method with M (1 - α_m) / (β h²) + (1 - α_f) K.

The plastic state is that of the displacements within the step, from one such point to the next. Taking a mean of the
forces at both ends instead, f̄ = (1 - α_f) f(d₁) + α_f f(d₀), is of second order too, but counts too little plastic work
where a section yields and unloads within a step or two, as it does behind every impact: with 1000 steps a struck
cantilever's peak was a tenth too large, and with any number of steps its error had the same sign.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_reference.frame import Response
from fem_reference.modes import Masses
from fem_reference.paths import NotConverged, State

#: Energy of the out-of-balance forces over that in the structure at which a step is solved, …
_TOLERANCE = 1e-16
#: … and at which a late one is: where a short element yields throughout, rounding of its forces works as much.
_LATE_TOLERANCE, _LATE = 1e-12, 8
_MOST_ITERATIONS = 30
#: Of a Newton step: where sections yield throughout, one may be ten thousand times too long.
_MOST_CUTS = 20
#: Newton steps in a row, none of which leads anywhere however short, after which a shorter step in time is tried. At an
#: ideal hinge that yields and unloads by turns they go on for ever; elsewhere at most five were seen before one did.
_MOST_IN_VAIN = 8
_MOST_PIECES = 256
#: Share of h² K in the mass matrix that is inverted for a start: degrees of freedom without mass follow statically.
_REGULAR = 1e-9
#: Coming to rest: steps without momentum, each this much longer than the last, until one moves no more than that.
_LONGER, _STILL = 10.0, 1e-9
_MOST_RESTS = 12


class Stepper:
    """A frame in motion.

    Parameters
    ----------
    state : State
        At its loads; it moves with the steps.
    mass : Masses
    dissipation : float
        ρ above [-].
    """

    def __init__(self, state: State, mass: Masses, dissipation: float) -> None:
        self.frame, self.mass, self.state = state.frame, mass, state
        self.alpha_m = (2.0 * dissipation - 1.0) / (dissipation + 1.0)
        self.alpha_f = dissipation / (dissipation + 1.0)
        self.beta = 0.25 * (1.0 - self.alpha_m + self.alpha_f) ** 2
        self.gamma = 0.5 - self.alpha_m + self.alpha_f
        self.velocity = np.zeros(self.frame.size)
        self.acceleration = np.zeros(self.frame.size)
        self.loads = state.applied

    def start(self, velocity: np.ndarray, step: float) -> None:
        """Start with ``velocity`` (size,), and with the accelerations of the loads that are not balanced then."""
        self.velocity = velocity
        frame, free, share = self.frame, self.state.solver.free, _REGULAR * step**2
        matrices = self.mass.matrices + share * self.state.response.matrices
        force = (self.loads - self.state.response.internal)[free]
        self.acceleration = np.zeros(frame.size)
        self.acceleration[free] = self.state.solver.solve(matrices, self.mass.nodal + share * frame.springs, force)[
            :, 0
        ]

    def energies(self) -> tuple[float, float, float, float]:
        """Kinetic and elastic energy, plastic work, and potential that the loads have lost [J], at the end of a step.

        The committed state is that of the middle, where the forces were in balance.
        """
        frame, state = self.frame, self.state
        end = frame.respond(state.displacement, state.response.slip)
        kinetic = 0.5 * float(self.velocity @ self.mass.momentum(frame, self.velocity))
        elastic = frame.elastic_energy(end) + frame.spring_energy(state.displacement)
        plastic = state.plastic + frame.plastic_work(state.response, end)
        return kinetic, elastic, plastic, float(self.loads @ state.displacement)

    def advance(self, step: float) -> None:
        """One step in time [s], in smaller pieces where need be."""
        done, pieces = 0.0, 1
        while done < 1.0:
            if self._try(step / pieces):
                done += 1.0 / pieces
            elif pieces < _MOST_PIECES:
                pieces *= 2
            else:
                raise NotConverged(f"no equilibrium in a time step of {step / pieces:.3g} s")

    def come_to_rest(self, step: float) -> None:
        """Let go of all momentum again and again, over longer and longer steps, until nothing moves.

        Each displacement is the least of W(d) + |d - d₀|² / 2h² in the norm of M, which has one also where nothing
        holds the frame in place, and where a mechanism would.
        """
        stored = self.frame.elastic_energy(self.state.response)
        for _ in range(_MOST_RESTS):
            before = self.state.displacement
            inertia = 1.0 / step**2

            def balance(new: np.ndarray) -> tuple[Response, np.ndarray]:
                response = self.frame.respond(new, self.state.response.slip)
                slowed = inertia * self.mass.momentum(self.frame, new - before)  # noqa: B023
                return response, self.loads - response.internal - slowed

            found = self._solve(before, balance, inertia, 1.0, stored)
            if found is None:
                raise NotConverged("the structure does not come to rest under its loads")
            self._take(*found)
            if np.abs(found[0] - before).max() <= _STILL * np.abs(before).max():
                break
            step *= _LONGER

    def _try(self, h: float) -> bool:
        """One step ``h`` of the generalised-α method; whether it converged and was taken."""
        frame, state = self.frame, self.state
        d, v, a = state.displacement, self.velocity, self.acceleration

        def acceleration(new: np.ndarray) -> np.ndarray:
            ahead = (new - d - h * v) / (self.beta * h * h) - (0.5 / self.beta - 1.0) * a
            ahead[frame.fixed] = 0.0
            return np.asarray(ahead)

        def balance(new: np.ndarray) -> tuple[Response, np.ndarray]:
            response = frame.respond((1.0 - self.alpha_f) * new + self.alpha_f * d, state.response.slip)
            mean = (1.0 - self.alpha_m) * acceleration(new) + self.alpha_m * a
            return response, self.loads - response.internal - self.mass.momentum(frame, mean)

        inertia = (1.0 - self.alpha_m) / (self.beta * h * h)
        kinetic = float(v @ self.mass.momentum(frame, v))
        found = self._solve(d + h * v, balance, inertia, 1.0 - self.alpha_f, kinetic)
        if found is None:
            return False
        ahead = acceleration(found[0])
        self.velocity = v + h * ((1.0 - self.gamma) * a + self.gamma * ahead)
        self.acceleration = ahead
        self._take(*found)
        return True

    def _take(self, displacement: np.ndarray, response: Response) -> None:
        self.state.plastic += self.frame.plastic_work(self.state.response, response)
        self.state.displacement, self.state.response = displacement, response

    def _solve(
        self,
        start: np.ndarray,
        balance: Callable[[np.ndarray], tuple[Response, np.ndarray]],
        inertia: float,
        stiff: float,
        scale: float,
    ) -> tuple[np.ndarray, Response] | None:
        """Newton's method from ``start`` for ``balance``'s forces to vanish; None where it does not get there.

        With small displacements they are the slopes of a convex function, so a line search always gets there.
        """
        solver = self.state.solver
        free = solver.free
        new, in_vain = start, 0
        response, force = balance(new)
        for iteration in range(_MOST_ITERATIONS):
            matrices = inertia * self.mass.matrices + stiff * response.matrices
            diagonal = inertia * self.mass.nodal + stiff * response.springs
            change = solver.solve(matrices, diagonal, force[free])[:, 0]
            here = float(force[free] @ change)
            scale = max(scale, abs(float(response.internal @ new)))
            if abs(here) <= (_TOLERANCE if iteration < _LATE else _LATE_TOLERANCE) * max(scale, 1e-30):
                return new, response
            base, length, low, high, low_slope, high_slope = new, 1.0, 0.0, 1.0, here, 0.0
            for _ in range(_MOST_CUTS):
                new = base.copy()
                new[free] += length * change
                response, force = balance(new)
                slope = float(force[free] @ change)
                if slope >= -0.5 * here and (slope <= 0.5 * here or length == 1.0):
                    in_vain = 0
                    break
                if slope < 0.0:
                    high, high_slope = length, slope
                else:
                    low, low_slope = length, slope
                length = low + (high - low) * min(max(low_slope / (low_slope - high_slope), 0.1), 0.9)
            else:
                in_vain += 1
                if in_vain == _MOST_IN_VAIN:
                    break
        return None
