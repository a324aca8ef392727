"""Motion of a frame in time, by the generalised-α method.

J. Chung and G. M. Hulbert, A time integration algorithm for structural dynamics with improved numerical dissipation:
the generalized-α method, J. Appl. Mech. 60 (1993). From (d₀, v₀, a₀) to the end of a step h,

    M [(1 - α_m) a₁ + α_m a₀] + (1 - α_f) f(d₁) + α_f f(d₀) = F,
    d₁ = d₀ + h v₀ + h² [(1/2 - β) a₀ + β a₁],   v₁ = v₀ + h [(1 - γ) a₀ + γ a₁],

    α_m = (2ρ - 1) / (ρ + 1),   α_f = ρ / (ρ + 1),   β = (1 - α_m + α_f)² / 4,   γ = 1/2 - α_m + α_f,

of second order for any ρ in [0, 1], the share of the highest frequencies' amplitude that a step leaves: 1 dissipates
nothing, 0 takes them out at once. Solved for d₁ by Newton's method with M (1 - α_m) / (β h²) + (1 - α_f) K.

Bodies that strike and supports that catch a fall act in an instant. A body shares its momentum with the mass that is
lumped at its node, which vanishes as elements shrink; a support stops what it holds and nothing else yet.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from capacity import InputError
from fem_reference.frame import Frame, Response
from fem_reference.frame_mesh import build_frame
from fem_reference.modes import Masses, masses
from fem_reference.paths import NotConverged, State
from scene import Motion, Scene
from scene.actions import unit_vector

#: Energy of the out-of-balance forces over that in the structure, at which a step is solved.
_TOLERANCE = 1e-16
_MOST_ITERATIONS, _MOST_CUTS = 25, 6
_MOST_PIECES = 256
_COARSEST = (10, 24, 250)
_MOST_REFINEMENTS = 4
#: Share of h² K in the mass matrix that is inverted for a start: degrees of freedom without mass follow statically.
_REGULAR = 1e-9


@dataclass(frozen=True)
class MotionResult:
    """A motion in time; k points.

    Attributes
    ----------
    method : str
    node : str
        Whose displacement it is.
    time : (k,) float
        [s]
    displacement : (k,) float
        Along the watched direction [m].
    kinetic, elastic, plastic, external : (k,) float
        Energies of motion and stored, plastic work, and work of the loads since the start [J].
    peak, peak_time : float
        Largest displacement by size [m], and when [s].
    residual : dict[str, (float, float)]
        Displacements x, y of each node once it is at rest under dead and step loads [m].
    error_estimate : float
        Largest difference of the displacement from that of the next coarser model, with twice the step, over the peak.
    elements, fibres, steps : int
        Of the finest model.
    """

    method: str
    node: str
    time: np.ndarray
    displacement: np.ndarray
    kinetic: np.ndarray
    elastic: np.ndarray
    plastic: np.ndarray
    external: np.ndarray
    peak: float
    peak_time: float
    residual: dict[str, tuple[float, float]]
    error_estimate: float
    elements: int
    fibres: int
    steps: int


def motion(
    scene: Scene, tolerance: float = 0.01, dissipation: float = 0.9, watch: Callable[[float], None] = lambda share: None
) -> MotionResult:
    """Follow ``scene``'s motion with finer models and steps until the estimated error is at most ``tolerance``.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Largest difference of the watched displacement between two models, over its peak [-].
    dissipation : float
        ρ above [-].
    watch : callable
        Told the finished share of the current model's time.

    Raises
    ------
    InputError
        When the scene has no motion.
    NotConverged
        When the dead loads, or a time step, find no equilibrium.
    """
    if scene.motion is None:
        raise InputError("motion", "the scene has none", 'add [motion] with duration = "0.2 s"')
    elements, fibres, steps = _COARSEST
    coarse = _follow(scene, scene.motion, elements, fibres, steps, dissipation, watch)
    for _ in range(_MOST_REFINEMENTS):
        elements, fibres, steps = 2 * elements, min(2 * fibres, 96), 2 * steps
        fine = _follow(scene, scene.motion, elements, fibres, steps, dissipation, watch)
        node = scene.motion.watch or max(fine.paths, key=lambda name: float(np.ptp(fine.paths[name])))
        path = fine.paths[node]
        peak = int(np.argmax(np.abs(path)))
        error = float(np.abs(path[::2] - coarse.paths[node]).max() / abs(path[peak]))
        if error <= tolerance:
            break
        coarse = fine
    return MotionResult(
        method=f"displacement-based fibre beam elements, generalised-α with ρ = {dissipation:g}, consistent mass",
        node=node,
        time=np.linspace(0.0, scene.motion.duration, steps + 1),
        displacement=path,
        kinetic=fine.energies[:, 0],
        elastic=fine.energies[:, 1],
        plastic=fine.energies[:, 2],
        external=fine.energies[:, 3],
        peak=float(path[peak]),
        peak_time=peak * scene.motion.duration / steps,
        residual=fine.residual,
        error_estimate=error,
        elements=elements,
        fibres=fibres,
        steps=steps,
    )


@dataclass(frozen=True)
class _Followed:
    """One model's motion: watched displacements by node, energies (k, 4) and where it comes to rest."""

    paths: dict[str, np.ndarray]
    energies: np.ndarray
    residual: dict[str, tuple[float, float]]


def _follow(
    scene: Scene,
    asked: Motion,
    elements: int,
    fibres: int,
    steps: int,
    dissipation: float,
    watch: Callable[[float], None],
) -> _Followed:
    frame = build_frame(scene, elements, fibres)
    mass = masses(scene, frame)
    state = State(frame, np.zeros(frame.size))
    if len(frame.fixed) > np.sum([m.theory == "euler-bernoulli" for m in scene.members.values()]) * elements:
        state.carry_dead_loads()
    state.load = 1.0
    stepper = _Stepper(frame, mass, state, asked.duration / steps, dissipation)
    stepper.start(_velocity(scene, asked, frame, mass))
    direction = np.array(unit_vector(asked.direction))
    start = state.displacement.copy()
    paths = {name: np.zeros(steps + 1) for name in scene.nodes}
    energies = np.zeros((steps + 1, 4))
    energies[0] = stepper.energies()
    for k in range(steps):
        stepper.advance()
        for name, dofs in frame.node_dofs.items():
            paths[name][k + 1] = direction @ (state.displacement - start)[dofs[:2]]
        energies[k + 1] = stepper.energies()
        watch((k + 1) / steps)
    energies[:, 3] -= energies[0, 3]
    state.slope = None
    state.load_to_rest()
    rest = {name: (state.displacement - start)[dofs[:2]] for name, dofs in frame.node_dofs.items()}
    return _Followed(paths, energies, {name: (float(x), float(y)) for name, (x, y) in rest.items()})


def _velocity(scene: Scene, asked: Motion, frame: Frame, mass: Masses) -> np.ndarray:
    """Velocity of every degree of freedom just after the start, (size,)."""
    velocity, one = np.zeros(frame.size), np.zeros(frame.size)
    for axis in (0, 1):
        velocity[frame.dofs_of(axis)] = asked.velocity[axis]
        one[frame.dofs_of(axis)] = 1.0
    if frame.kinematics != "large":  # the middle of an element has an axial displacement of its own
        velocity[frame.dofs[:, 6]] = frame.chords.span @ np.array(asked.velocity) / frame.chords.length
    lumped = mass.momentum(frame, one)
    for name, node in scene.nodes.items():
        if any(node.velocity):
            dofs = frame.node_dofs[name][:2]
            brought = node.mass * (np.array(node.velocity) - velocity[dofs])
            velocity[dofs] += brought / lumped[dofs]
    velocity[frame.fixed] = 0.0
    return velocity


class _Stepper:
    """A frame in motion, and the step to the next time."""

    def __init__(self, frame: Frame, mass: Masses, state: State, step: float, dissipation: float) -> None:
        self.frame, self.mass, self.state, self.step = frame, mass, state, step
        self.alpha_m = (2.0 * dissipation - 1.0) / (dissipation + 1.0)
        self.alpha_f = dissipation / (dissipation + 1.0)
        self.beta = 0.25 * (1.0 - self.alpha_m + self.alpha_f) ** 2
        self.gamma = 0.5 - self.alpha_m + self.alpha_f
        self.velocity = np.zeros(frame.size)
        self.acceleration = np.zeros(frame.size)
        self.loads = state.applied

    def start(self, velocity: np.ndarray) -> None:
        """Start with ``velocity`` (size,), and with the accelerations of the loads that are not balanced then."""
        self.velocity = velocity
        self.acceleration = self._over_mass(self.loads - self.state.response.internal)

    def _over_mass(self, force: np.ndarray) -> np.ndarray:
        frame, free = self.frame, self.state.solver.free
        share = _REGULAR * self.step**2
        matrices = self.mass.matrices + share * self.state.response.matrices
        out = np.zeros(frame.size)
        out[free] = self.state.solver.solve(matrices, self.mass.nodal + share * frame.springs, force[free])[:, 0]
        return out

    def energies(self) -> tuple[float, float, float, float]:
        """Kinetic and elastic energy, plastic work, and potential that the loads have lost [J]."""
        state = self.state
        kinetic = 0.5 * float(self.velocity @ self.mass.momentum(self.frame, self.velocity))
        springs = 0.5 * float(self.frame.springs @ state.displacement**2)
        elastic = self.frame.elastic_energy(state.response) + springs
        return kinetic, elastic, state.plastic, float(self.loads @ state.displacement)

    def advance(self) -> None:
        """One step in time, in smaller pieces where need be."""
        done, pieces = 0.0, 1
        while done < 1.0:
            if self._try(self.step / pieces):
                done += 1.0 / pieces
            elif pieces < _MOST_PIECES:
                pieces *= 2
            else:
                raise NotConverged(f"no equilibrium in a time step of {self.step / pieces:.3g} s")

    def _try(self, h: float) -> bool:
        """One step ``h`` of the generalised-α method; whether it converged and was taken."""
        frame, state = self.frame, self.state
        free = state.solver.free
        d, v, a = state.displacement, self.velocity, self.acceleration
        inertia = (1.0 - self.alpha_m) / (self.beta * h * h)
        stiff = 1.0 - self.alpha_f
        new = d + h * v + 0.5 * h * h * a
        new[frame.fixed] = d[frame.fixed]
        scale = max(1e-30, float(v @ self.mass.momentum(frame, v)))
        response, ahead, residual = self._balance(new, h)
        for _ in range(_MOST_ITERATIONS):
            matrices = inertia * self.mass.matrices + stiff * response.matrices
            diagonal = inertia * self.mass.nodal + stiff * frame.springs
            change = state.solver.solve(matrices, diagonal, residual)[:, 0]
            here = float(residual @ change)
            scale = max(scale, abs(float(response.internal @ new)))
            if abs(here) <= _TOLERANCE * scale:
                state.plastic += frame.plastic_work(state.response, response)
                state.displacement, state.response = new, response
                self.velocity = v + h * ((1.0 - self.gamma) * a + self.gamma * ahead)
                self.acceleration = ahead
                return True
            # A step of small displacements is the minimum of a convex function: a line search always gets there.
            there, length, base = np.inf, 1.0, new
            for cut in range(_MOST_CUTS):
                if cut:
                    length *= min(max(here / (here - there), 0.1), 0.7)
                new = base.copy()
                new[free] += length * change
                response, ahead, residual = self._balance(new, h)
                there = float(residual @ change)
                if abs(there) <= 0.8 * abs(here):
                    break
        return False

    def _balance(self, new: np.ndarray, h: float) -> tuple[Response, np.ndarray, np.ndarray]:
        """Response at the displacements ``new`` a time ``h`` ahead, accelerations, and the forces out of balance."""
        state = self.state
        response = self.frame.respond(new, state.response.slip)
        ahead = (new - state.displacement - h * self.velocity) / (self.beta * h * h)
        ahead -= (0.5 / self.beta - 1.0) * self.acceleration
        ahead[self.frame.fixed] = 0.0
        force = (1.0 - self.alpha_f) * response.internal + self.alpha_f * state.response.internal
        mean = (1.0 - self.alpha_m) * ahead + self.alpha_m * self.acceleration
        return response, ahead, (self.loads - force - self.mass.momentum(self.frame, mean))[state.solver.free]
