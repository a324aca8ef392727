"""Pushing a scene over with rigid bodies: the load at each distance, and what it cost."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pymunk

from scene import Scene
from sim.body_loads import BodyLoad
from sim.load_driver import LoadDriver
from sim.members import assemble
from sim.model import Model
from sim.settling import settle

#: How long a push takes in the simulation [s]: slow against the vibrations of ordinary members, which the implicit
#: Euler scheme damps.
DURATION = 4.0
_EASE = 0.1


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
    assembly = assemble(scene, model, shapes=False)
    settle(scene, assembly, 1e-9 * scene.push.way())
    structure, node = assembly.structure, assembly.nodes[scene.push.node]
    turns = 1 + int(np.count_nonzero(np.diff(np.sign(np.diff(distances)))))
    steps = max(1, round(turns * DURATION / model.dt))
    progress = _eased(steps) * (len(distances) - 1)
    travel = np.interp(progress, np.arange(len(distances)), distances)
    loads = assembly.pattern or (BodyLoad(node.body, scene.push_direction(), 0.0, node.point),)
    driver = LoadDriver(structure, loads, node, scene.push_direction())
    newton_before = structure.newton_steps
    displacement, load = np.empty(steps), np.empty(steps)
    seconds = 0.0
    for k in range(steps):
        driver.aim(travel[k + 1], model.dt)
        started = time.perf_counter()
        assembly.step(model.dt)
        seconds += time.perf_counter() - started
        driver.read(model.dt)
        displacement[k], load[k] = driver.displacement, driver.factor
        if k % 64 == 0:
            watch(k / steps)
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


def _eased(steps: int) -> np.ndarray:
    """Share of the way at each step, (steps + 1,): even, but for a start without a jerk."""
    time = np.linspace(0.0, 1.0, steps + 1)
    way = np.where(time < _EASE, time**2 / (2.0 * _EASE), time - 0.5 * _EASE)
    share: np.ndarray = way / way[-1]
    return share
