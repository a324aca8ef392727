"""Pushing a scene over with rigid bodies: the load at each distance, and what it cost."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pymunk

from scene import Scene
from sim.laws import ElasticPlastic
from sim.members import Assembly, Model, assemble
from sim.structure import SolverError

#: How long a push takes in the simulation [s]: slow against the vibrations of ordinary members, which the implicit
#: Euler scheme damps.
DURATION = 4.0
_EASE = 0.1
#: Step while a scene settles under its own weight [s]; long, for the longer it is the more it damps.
SETTLING_STEP = 1.0 / 60.0
# Weight and dead loads grow over so many steps: applied at once they would bear down with twice their size.
_LOADING_STEPS = 120
_MOST_SETTLING_STEPS = 10_000


@dataclass(frozen=True)
class Push:
    """A load–displacement curve from rigid bodies, and what it cost.

    Attributes
    ----------
    displacement : (k,) float
        Displacement of the pushed node along the push after each step [m], from 0.
    load : (k,) float
        Force on it along the push [N].
    progress : (k,) float
        How far along the given distances the node had come: 2.5 is halfway between the third and the fourth [-].
    bodies, joints : int
        Dynamic bodies, and joints of the members.
    steps : int
        Steps taken.
    seconds : float
        Time that the steps took.
    simulated_seconds : float
        Time that passed in the simulation.
    newton_steps : float
        Newton steps a step, on average.
    unconverged : int
        Solves that ended above the solver's tolerance.
    dissipated : float
        Plastic work in the joints [J].
    """

    displacement: np.ndarray
    load: np.ndarray
    progress: np.ndarray
    bodies: int
    joints: int
    steps: int
    seconds: float
    simulated_seconds: float
    newton_steps: float
    unconverged: int
    dissipated: float

    @property
    def seconds_per_simulated_second(self) -> float:
        """Time that a second of simulation takes; its inverse is the real-time factor."""
        return self.seconds / self.simulated_seconds

    @property
    def microseconds_per_joint_step(self) -> float:
        """Time that a joint takes in a step [µs], the whole step's time shared out."""
        return 1e6 * self.seconds / (self.steps * self.joints)


def push_over(
    scene: Scene,
    model: Model,
    distances: np.ndarray,
    watch: Callable[[float], None] = lambda share: None,
) -> Push:
    """Push ``scene`` with rigid bodies under displacement control.

    The scene first settles under its own weight; the displacement after that counts as 0.

    Parameters
    ----------
    scene : Scene
    model : Model
    distances : (k,) float
        Distances of the pusher one after the other, from 0 [m]; each gets an equal share of the time, the first
        ones a larger one; every way from one turn to the next takes `DURATION`.
    watch : callable
        Told the finished share of the push, 0 to 1.

    Returns
    -------
    Push

    Raises
    ------
    SolverError
        When a step cannot be taken.
    """
    assembly, origin = _settled(scene, model)
    structure = assembly.structure
    direction = np.array(scene.push_direction())
    turns = 1 + int(np.count_nonzero(np.diff(np.sign(np.diff(distances)))))
    steps = max(1, round(turns * DURATION / model.dt))
    progress = _eased(steps) * (len(distances) - 1)
    travel = np.interp(progress, np.arange(len(distances)), distances)
    newton_before = structure.newton_steps
    started = time.perf_counter()
    drive = _by_pattern if assembly.pattern else _by_pusher
    displacement, load = drive(assembly, origin, direction, travel, model.dt, watch)
    seconds = time.perf_counter() - started
    # Where the node was, not where it was wanted; on a way that turns, though, one place is passed more than once.
    passed = np.interp(displacement, distances, np.arange(len(distances))) if turns == 1 else progress[1:]
    return Push(
        displacement=np.append(0.0, displacement),
        load=np.append(0.0, load),
        progress=np.append(0.0, passed),
        bodies=sum(body.body_type == pymunk.Body.DYNAMIC for body in structure.bodies),
        joints=len(assembly.places),
        steps=steps,
        seconds=seconds,
        simulated_seconds=steps * model.dt,
        newton_steps=(structure.newton_steps - newton_before) / steps,
        unconverged=structure.unconverged,
        dissipated=float(structure.dissipated.sum()),
    )


def _by_pusher(
    assembly: Assembly,
    origin: np.ndarray,
    direction: np.ndarray,
    travel: np.ndarray,
    dt: float,
    watch: Callable[[float], None],
) -> tuple[np.ndarray, np.ndarray]:
    """Push the node itself; displacement and force after each step."""
    structure, pusher, steps = assembly.structure, assembly.pusher, len(travel) - 1
    gap, force = np.empty(steps), np.empty(steps)
    for k in range(steps):
        # Chipmunk moves bodies first and solves for the velocities of the next move: the pusher is put one move back,
        # so that it stands at travel[k] when the forces are sought that hold at travel[k + 1].
        speed = (travel[k + 1] - travel[k]) / dt
        pusher.position = tuple(origin + (2.0 * travel[k] - travel[k + 1]) * direction)
        pusher.velocity = (speed * direction[0], speed * direction[1])
        assembly.step(dt)
        gap[k], force[k] = structure.deformation[-1, 0], structure.force[-1, 0]
        if k % 64 == 0:
            watch(k / steps)
    return travel[1:] + gap, -force


def _by_pattern(
    assembly: Assembly,
    origin: np.ndarray,
    direction: np.ndarray,
    travel: np.ndarray,
    dt: float,
    watch: Callable[[float], None],
) -> tuple[np.ndarray, np.ndarray]:
    """Drive the proportional loads so that the node goes its way; its displacement and the load factor at each step.

    What is prescribed is the displacement w that the loads work on, for which the solver's energy stays convex. With y
    the velocities that a unit impulse of the pattern p gives, and g the node's displacement over the bodies', the node
    goes on by g·y / p·y for a unit of w.
    """
    structure, steps = assembly.structure, len(travel) - 1
    index = {body: i for i, body in enumerate(structure.bodies)}
    last = structure.joints[-1]
    node, anchor = last.b, last.geometry[2:4]
    structure.change_law(len(structure.joints) - 1, ElasticPlastic((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    stiffness = max(joint.law.elastic_tangent()[0] for joint in structure.joints[: len(assembly.places)])
    size = sum(load.force[0] ** 2 + load.force[1] ** 2 + load.moment**2 for load in assembly.pattern)
    displacement, factor = np.empty(steps), np.empty(steps)
    ratio = 0.0
    for k in range(steps):
        pattern = _pattern(assembly, index, dt)
        arm = _ahead(node, anchor, dt) - _ahead(node, (0.0, 0.0), dt)
        probe = np.array([*direction, arm[0] * direction[1] - arm[1] * direction[0]])
        here = float((_ahead(node, anchor, dt) - origin) @ direction)
        # The first step, without a way to go, finds the ratio.
        structure.drive(pattern, stiffness / size, ratio * (travel[k + 1] - here) if k else 1e-9 * size**0.5)
        assembly.step(dt)
        response = structure.pattern_response
        along_node = float(probe @ response[index[node]])
        if along_node > 0.0:
            ratio = float(np.sum(pattern * response)) / along_node
        displacement[k] = (_ahead(node, anchor, dt) - origin) @ direction
        factor[k] = structure.load_factor
        if k % 64 == 0:
            watch(k / steps)
    return displacement, factor


def _ahead(body: pymunk.Body, anchor: Sequence[float], dt: float) -> np.ndarray:
    """Where a point of a body will be when the body has moved for ``dt`` [m]."""
    angle = body.angle + dt * body.angular_velocity
    c, s = math.cos(angle), math.sin(angle)
    x = body.position.x + dt * body.velocity.x + c * anchor[0] - s * anchor[1]
    y = body.position.y + dt * body.velocity.y + s * anchor[0] + c * anchor[1]
    return np.array([x, y])


def _pattern(assembly: Assembly, index: dict[pymunk.Body, int], dt: float) -> np.ndarray:
    """Forces and moments of the proportional loads about the bodies' centres, where these will be after the move."""
    pattern = np.zeros((len(index), 3))
    for load in assembly.pattern:
        (fx, fy), (px, py) = load.force, load.point
        angle = load.body.angle + dt * load.body.angular_velocity
        c, s = math.cos(angle), math.sin(angle)
        moment = load.moment + (c * px - s * py) * fy - (s * px + c * py) * fx
        pattern[index[load.body]] += fx, fy, moment
    return pattern


def _eased(steps: int) -> np.ndarray:
    """Share of the way at each step, (steps + 1,): even, but for a start without a jerk."""
    time = np.linspace(0.0, 1.0, steps + 1)
    way = np.where(time < _EASE, time**2 / (2.0 * _EASE), time - 0.5 * _EASE)
    share: np.ndarray = way / way[-1]
    return share


def _settled(scene: Scene, model: Model) -> tuple[Assembly, np.ndarray]:
    """The scene at rest under its own weight, with the pusher at the pushed node; and where that is."""
    assembly = assemble(scene, model)
    place = np.array(scene.nodes[scene.push.node].at)
    settles = any(node.settlement != (0.0, 0.0) for node in scene.nodes.values())
    if scene.gravity == 0.0 and not assembly.dead_loads and not settles:
        return assembly, place
    structure, last = assembly.structure, len(assembly.structure.joints) - 1
    spring = structure.joints[last].law
    structure.change_law(last, ElasticPlastic((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    for k in range(_MOST_SETTLING_STEPS):
        share = min(1.0, (k + 1) / _LOADING_STEPS)
        assembly.space.gravity = (0.0, -share * scene.gravity)
        assembly.step(SETTLING_STEP, share)
        speed = max(body.velocity.length for body in structure.bodies)
        if share == 1.0 and speed * SETTLING_STEP < 1e-9 * scene.push.way():
            break
    else:
        raise SolverError("the scene does not come to rest under its own weight; support it, or make it stronger")
    place = np.array(assembly.pushed_point())
    structure.change_law(last, spring)
    return assembly, place
