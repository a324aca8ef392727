"""Motion of a frame in time: falls, impacts and sudden loads, step by step with `stepper.Stepper`.

An impact is plastic: a body shares its momentum with the mass that is lumped at its node, which vanishes as elements
shrink, and stays on it. A support stops what it holds in an instant; a bearing pushes while it touches.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from capacity import InputError
from fem_reference.frame import Frame
from fem_reference.frame_mesh import build_frame
from fem_reference.hinge_times import HingeTime, hinge_times, with_time_errors
from fem_reference.member_results import MemberResult, member_results
from fem_reference.modes import Masses, masses
from fem_reference.paths import State, Trace
from fem_reference.stepper import Stepper
from scene import Motion, Scene
from scene.actions import unit_vector

#: Estimated error that is aimed at when nothing else is said.
TOLERANCE = 0.01
#: Share of the largest displacement of any node that is rounding.
_NOTHING = 1e-9
_COARSEST = (10, 24, 250)
#: Times at which whole members are kept.
_STATES = 26
_MOST_FIBRES = 48
_MOST_REFINEMENTS = 4


@dataclass(frozen=True)
class MotionResult:
    """A motion in time; k points.

    Every error estimate is the difference from a model with half the elements, plus that from one with steps twice
    as long: the two may be of opposite sign, and one model that is coarser in both would hide them.

    Attributes
    ----------
    method : str
    node : str
        Whose displacement is watched.
    time : (k,) float
        [s]
    displacement : (k,) float
        Of that node along the watched direction [m].
    displacements : dict[str, (k, 2) float]
        Displacements x, y of every node since the start [m].
    members : dict[str, MemberResult]
        Forces, strains and shapes at the times ``member_time``; the end forces are without the inertia of the last
        element.
    member_time : (j,) float
        [s]
    hinges : tuple of HingeTime
        In the order in which they form.
    kinetic, elastic, plastic, external : (k,) float
        Energies of motion and stored, plastic work, and work of the loads since the start [J].
    peak, peak_time : float
        Largest displacement by size [m], and when [s].
    peak_error : float
        Of the peak [m].
    residual : dict[str, (float, float)]
        Displacements x, y of each node once it has come to rest under dead and step loads, from the end of the motion
        on [m]; at that end, where nothing holds the structure.
    residual_error : float
        Largest error of any of them [m].
    energy_error : float
        Largest error of any energy, and what the integration itself has dissipated, over the largest energy [-].
    error_estimate : float
        Largest error of the watched displacement at any time, over the peak [-].
    elements, fibres, steps : int
        Of the finest model.
    seconds : float
        Time that all models took.
    """

    method: str
    node: str
    time: np.ndarray
    displacement: np.ndarray
    displacements: dict[str, np.ndarray]
    members: dict[str, MemberResult]
    member_time: np.ndarray
    hinges: tuple[HingeTime, ...]
    kinetic: np.ndarray
    elastic: np.ndarray
    plastic: np.ndarray
    external: np.ndarray
    peak: float
    peak_time: float
    peak_error: float
    residual: dict[str, tuple[float, float]]
    residual_error: float
    energy_error: float
    error_estimate: float
    elements: int
    fibres: int
    steps: int
    seconds: float


def motion(
    scene: Scene,
    tolerance: float = TOLERANCE,
    dissipation: float = 0.8,
    watch: Callable[[float], None] = lambda share: None,
) -> MotionResult:
    """Follow ``scene``'s motion with finer models and steps until the estimated error is at most ``tolerance``.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Largest error of the watched displacement, over its peak [-].
    dissipation : float
        ρ of `stepper`: 1 dissipates nothing; the default takes out what a step cannot resolve.
    watch : callable
        Told the finished share of the current model's time.

    Returns
    -------
    MotionResult
        From the finest model; its ``error_estimate`` says whether ``tolerance`` was met within four refinements.

    Raises
    ------
    InputError
        When the scene has no motion, ``dissipation`` is not between 0 and 1, or the watched node does not move in the
        watched direction.
    NotConverged
        When the dead loads, or a time step, find no equilibrium.
    """
    if scene.motion is None:
        raise InputError("motion", "the scene has none", 'add [motion] with duration = "0.2 s"')
    if not 0.0 <= dissipation <= 1.0:
        raise InputError("dissipation", f"{dissipation:g} is not between 0 and 1", "0.8 is ordinary")
    started = time.perf_counter()
    asked = scene.motion
    elements, fibres, steps = _COARSEST
    for _ in range(_MOST_REFINEMENTS):
        elements, fibres, steps = 2 * elements, min(2 * fibres, _MOST_FIBRES), 2 * steps
        fine = _follow(scene, asked, elements, fibres, steps, dissipation, watch)
        others = (
            _follow(scene, asked, elements // 2, fibres // 2, steps, dissipation, watch),
            _follow(scene, asked, elements, fibres, steps // 2, dissipation, watch),
        )
        node = asked.watch or max(fine.moved, key=lambda name: float(np.ptp(fine.moved[name], axis=0).max()))
        direction = np.array(unit_vector(asked.direction))
        path = fine.moved[node] @ direction
        at = int(np.argmax(np.abs(path)))
        scale = float(np.abs(path[at]))
        if scale <= _NOTHING * max(float(np.abs(moved).max()) for moved in fine.moved.values()):
            raise InputError("motion.direction", f'node "{node}" does not move that way', "watch another way or node")
        error = sum(_gap(path, other.moved[node] @ direction) for other in others) / scale
        if error <= tolerance:
            break
    balance = fine.energies @ (1.0, 1.0, 1.0, -1.0)
    most = float(np.abs(fine.energies).max())
    peaks = [abs(float(np.abs(other.moved[node] @ direction).max()) - scale) for other in others]
    residuals = [
        max(float(np.abs(np.subtract(other.rest[k], fine.rest[k])).max()) for k in fine.rest) for other in others
    ]
    energies = [_gap(fine.energies, other.energies) for other in others]
    kinetic, elastic, plastic, external = fine.energies.T
    return MotionResult(
        method=f"displacement-based fibre beam elements, generalised-α with ρ = {dissipation:g}, consistent mass",
        node=node,
        time=np.linspace(0.0, asked.duration, steps + 1),
        displacement=path,
        displacements=fine.moved,
        members=fine.members,
        member_time=np.linspace(0.0, asked.duration, _STATES),
        hinges=with_time_errors(fine.hinges, [other.hinges for other in others]),
        kinetic=kinetic,
        elastic=elastic,
        plastic=plastic,
        external=external,
        peak=float(path[at]),
        peak_time=at * asked.duration / steps,
        peak_error=sum(peaks),
        residual=fine.rest,
        residual_error=sum(residuals),
        energy_error=max(sum(energies), float(np.abs(balance - balance[0]).max())) / most,
        error_estimate=error,
        elements=elements,
        fibres=fibres,
        steps=steps,
        seconds=time.perf_counter() - started,
    )


def _gap(fine: np.ndarray, other: np.ndarray) -> float:
    """Largest difference of two histories, one of which may have twice the steps."""
    stride = (len(fine) - 1) // (len(other) - 1)
    return float(np.abs(fine[::stride] - other).max())


@dataclass(frozen=True)
class _Followed:
    """One model's motion: displacements by node, energies (k, 4), where it comes to rest, and its hinges."""

    moved: dict[str, np.ndarray]
    energies: np.ndarray
    rest: dict[str, tuple[float, float]]
    members: dict[str, MemberResult]
    hinges: tuple[HingeTime, ...]


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
    if any(asked.velocity):
        state.release_dead_loads()
    else:
        state.carry_dead_loads()
    state.load = 1.0
    stepper, step = Stepper(state, mass, dissipation), asked.duration / steps
    stepper.start(_velocity(scene, asked, frame, mass), step)
    start = state.displacement.copy()
    moved = {name: np.zeros((steps + 1, 2)) for name in scene.nodes}
    energies = np.zeros((steps + 1, 4))
    energies[0] = stepper.energies()
    states = Trace()
    state.record(states, 0.0)
    stress = [state.response.stress]
    for k in range(steps):
        stepper.advance(step)
        for name, dofs in frame.node_dofs.items():
            moved[name][k + 1] = (state.displacement - start)[dofs[:2]]
        energies[k + 1] = stepper.energies()
        stress.append(state.response.stress)
        if (k + 1) * (_STATES - 1) % steps < _STATES - 1:
            state.record(states, 0.0)
        watch((k + 1) / steps)
    energies[:, 3] -= energies[0, 3]
    within = np.append(0.0, (np.arange(1, steps + 1) - stepper.alpha_f) * step)
    hinges = hinge_times(frame, scene, within, np.array(stress))
    if frame.bearings.any() or frame.springs.any() or any(any(node.held) for node in scene.nodes.values()):
        stepper.come_to_rest(step)
    rest = {name: (state.displacement - start)[dofs[:2]] for name, dofs in frame.node_dofs.items()}
    return _Followed(
        moved,
        energies,
        {name: (float(x), float(y)) for name, (x, y) in rest.items()},
        member_results(scene, frame, states),
        hinges,
    )


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
