"""A scene's motion in time with rigid bodies: where a node goes after a blow, a fall or a sudden load."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pymunk

from capacity import InputError
from scene import Motion, Scene
from scene.actions import unit_vector
from scene.watched import extreme
from sim.borne_forces import forces_on
from sim.joint import IMPLICIT_EULER, DuctileJoint
from sim.member_joints import JointPlace
from sim.members import Assembly, assemble
from sim.model import Model
from sim.settling import SETTLING_STEP, settle
from sim.step_back import SolverError

# What counts as rest after a motion, as a share of its peak a step; and for how many steps it is waited for.
_REST = 1e-7
_MOST_STEPS_TO_REST = 20_000
_LENGTHEN = 1.02


@dataclass(frozen=True)
class Course:
    """A node's motion in time.

    Attributes
    ----------
    node : str
        Whose displacement it is.
    time : (k,) float
        [s], from 0.
    displacement : (k,) float
        Along the watched direction since the start [m].
    peak, peak_time : float
        Largest displacement by size [m], and when [s]; between steps where it lies there.
    residual : dict[str, (float, float)]
        Displacements x, y of each node once it is at rest under dead and step loads [m].
    force : (k, joints, 3) float
        N [N], Q [N] and M [N m] of the members' joints after each step.
    places : tuple of JointPlace
        Where these joints are.
    bodies, joints : int
        Dynamic bodies, and joints of the members.
    steps : int
        Steps taken until the end of ``time``.
    seconds : float
        Processor time that those steps took.
    newton_steps : float
        Newton steps a step, on average.
    unconverged : int
        Solves that ended above the solver's tolerance.
    dissipated : float
        Plastic work in the joints, until rest [J].
    """

    node: str
    time: np.ndarray
    displacement: np.ndarray
    peak: float
    peak_time: float
    residual: dict[str, tuple[float, float]]
    force: np.ndarray
    places: tuple[JointPlace, ...]
    bodies: int
    joints: int
    steps: int
    seconds: float
    newton_steps: float
    unconverged: int
    dissipated: float

    @property
    def seconds_per_simulated_second(self) -> float:
        """Time that a second of simulation takes; its inverse is the real-time factor."""
        return self.seconds / float(self.time[-1])


def follow(scene: Scene, model: Model, watch: Callable[[float], None] = lambda share: None) -> Course:
    """Follow ``scene``'s motion: from rest under dead loads, with the velocities and step loads that set it going.

    Parameters
    ----------
    scene : Scene
    model : Model
        Its ``scheme`` decides how much the time integration damps; its ``dt`` what it can resolve.
    watch : callable
        Told the finished share of the motion, 0 to 1.

    Raises
    ------
    InputError
        When the scene has no motion.
    SolverError
        When a step cannot be taken, or the scene does not come to rest before the motion or after it.
    """
    asked = scene.motion
    if asked is None:
        raise InputError("motion", "the scene has none", 'add [motion] with duration = "0.2 s"')
    assembly = assemble(scene, model, shapes=False)
    assembly.structure.scheme = IMPLICIT_EULER
    settle(scene, assembly, 1e-12)
    assembly.structure.scheme = model.scheme
    set_going(scene, asked, assembly)
    steps = max(1, round(float(asked.duration) / model.dt))
    start = {name: np.array(node.now()) for name, node in assembly.nodes.items()}
    paths = {name: np.zeros((steps + 1, 2)) for name in assembly.nodes}
    seconds, newton_before = 0.0, assembly.structure.newton_steps
    bearing: list[tuple[tuple[DuctileJoint, ...], np.ndarray]] = []
    for k in range(steps):
        began = time.thread_time()
        assembly.step(model.dt, sudden=True)
        seconds += time.thread_time() - began
        bearing.append((assembly.joints, assembly.structure.force))
        for name, point in assembly.nodes.items():
            paths[name][k + 1] = point.ahead(model.dt) - start[name]
        if k % 64 == 0:
            watch(k / steps)
    along = {name: path @ unit_vector(asked.direction) for name, path in paths.items()}
    node = asked.watch or max(along, key=lambda name: float(np.ptp(along[name])))
    peak, peak_at = extreme(along[node])
    newton_steps = (assembly.structure.newton_steps - newton_before) / steps
    joints, places = assembly.joints[: len(assembly.places)], assembly.places
    times, unconverged = model.dt * np.arange(steps + 1), assembly.structure.unconverged
    _come_to_rest(assembly, model.dt, _REST * abs(peak))
    structure = assembly.structure
    rest = {name: np.array(point.now()) - start[name] for name, point in assembly.nodes.items()}
    return Course(
        node=node,
        time=times,
        displacement=along[node],
        peak=peak,
        peak_time=model.dt * peak_at,
        residual={name: (float(x), float(y)) for name, (x, y) in rest.items()},
        force=forces_on(joints, bearing),
        places=places,
        bodies=sum(body.body_type == pymunk.Body.DYNAMIC for body in structure.bodies),
        joints=len(places),
        steps=steps,
        seconds=seconds,
        newton_steps=newton_steps,
        unconverged=unconverged,
        dissipated=float(structure.dissipated.sum()),
    )


def set_going(scene: Scene, asked: Motion, assembly: Assembly) -> None:
    """Give the pieces the motion's velocity; a body fixed to a node brings its momentum to what the node is made of."""
    for piece in assembly.pieces:
        piece.body.velocity = (float(asked.velocity[0]), float(asked.velocity[1]))
    for name, point in assembly.nodes.items():
        node = scene.nodes[name]
        if point.body in {piece.body for piece in assembly.pieces}:
            continue
        share = float(node.mass) / point.body.mass
        own, brought = np.array(asked.velocity, dtype=float), np.array(node.velocity, dtype=float)
        if not any(node.velocity):
            brought = own
        x, y = share * brought + (1.0 - share) * own
        point.body.velocity = (float(x), float(y))


def _come_to_rest(assembly: Assembly, dt: float, rest: float) -> None:
    """Steps of implicit Euler, longer and longer: each damps the vibrations that it is long for, and no other."""
    assembly.structure.scheme = IMPLICIT_EULER
    for _ in range(_MOST_STEPS_TO_REST):
        dt = min(_LENGTHEN * dt, SETTLING_STEP)
        assembly.step(dt, sudden=True)
        fastest = max(body.velocity.length for body in assembly.structure.bodies)
        if dt == SETTLING_STEP and dt * fastest < rest:
            return
    raise SolverError("the scene does not come to rest after its motion; support it")
