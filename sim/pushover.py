"""Pushing a scene over with rigid bodies: the load at each distance, and what it cost."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import pymunk
from numpy.typing import ArrayLike

from capacity import InputError
from scene import Scene
from sim.borne_forces import forces_on
from sim.joint import DuctileJoint
from sim.load_driver import EASE, LONGEST_WAIT, LoadDriver
from sim.member_joints import JointPlace
from sim.members import assemble
from sim.model import Model
from sim.second_order import SecondOrder
from sim.settling import settle
from sim.step_back import SolverError

# Where inertia bears too much, a push takes longer, up to so many times.
_LONGEST = 8.0
# By how much of the largest load a push in more time may differ from the one before it. A member that buckles takes
# time for it, in which inertia bears little; where two pushes differ by more, the longest time is taken.
_ALIKE = 0.01
# Share of a way over which it is seen what inertia bears, short enough for a strut that gives way at once.
_SEEN = 0.02
# A push of which more steps than this share found no solution is none.
_MOST_UNCONVERGED = 0.02


@dataclass(frozen=True)
class Pace:
    """How fast a structure is pushed.

    Attributes
    ----------
    duration : float
        Time for every way from one turn to the next, but for what the node then still needs to get there [s]: slow
        against the vibrations of ordinary members, which the implicit Euler scheme damps.
    most_inertia : float
        Where inertia bears more of the largest load than this, on some fiftieth of the way, the push is taken again in
        more time, if that finds solutions [-].
    """

    duration: float = 4.5
    most_inertia: float = 1e-3


#: A pace for all.
PACE = Pace()


@dataclass(frozen=True)
class Push:
    """A load–displacement curve from rigid bodies, and what it cost.

    Attributes
    ----------
    displacement : (k,) float
        Displacement of the pushed node along the push after each step [m], from 0.
    load : (k,) float
        Force on it along the push [N].
    load_at_distances : (n,) float
        Load at each of the distances that were given, where the node itself passed it [N].
    force : (k, joints, 3) float
        N [N], Q [N] and M [N m] of the members' joints after each step; 0 before a joint was there.
    places : tuple of JointPlace
        Where these joints are; those that there are in the end.
    bodies, joints : int
        Dynamic bodies, and joints of the members.
    steps : int
        Steps taken.
    seconds : float
        Processor time that Chipmunk's steps took, which other work on the machine lengthens little.
    simulated_seconds : float
        Time that passed in the simulation.
    newton_steps : float
        Newton steps a step, on average.
    unconverged : int
        Solves that ended above the solver's tolerance.
    dissipated : float
        Plastic work in the joints [J].
    duration : float
        Time for every way from one turn to the next [s].
    inertia : float
        What speeding the bodies up adds to the load on some fiftieth of the way, over the largest load [-].
    """

    displacement: np.ndarray
    load: np.ndarray
    load_at_distances: np.ndarray
    force: np.ndarray
    places: tuple[JointPlace, ...]
    bodies: int
    joints: int
    steps: int
    seconds: float
    simulated_seconds: float
    newton_steps: float
    unconverged: int
    dissipated: float
    duration: float
    inertia: float

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
    distances: ArrayLike,
    watch: Callable[[float], None] = lambda share: None,
    *,
    second_order: float = 0.0,
    pace: Pace = PACE,
) -> Push:
    """Push ``scene`` with rigid bodies under displacement control.

    The scene first settles under its own weight; the displacement after that counts as 0.

    Parameters
    ----------
    scene : Scene
    model : Model
    distances : (k,) float
        Distances of the pusher one after the other, from 0 [m]; each gets about an equal share of the time, those at
        a turn a larger one.
    watch : callable
        Told the finished share of the push, 0 to 1.
    second_order : float
        How many times more the second-order moments act than exact positions make them; see `sim.second_order` [-].
    pace : Pace

    Returns
    -------
    Push

    Raises
    ------
    InputError
        When ``scene`` has no push, or ``distances`` are no way from 0.
    SolverError
        When a step cannot be taken, too many find no solution, or the pushed node leaves its way.
    """
    way = np.asarray(distances, dtype=float)
    if way.ndim != 1 or not np.isfinite(way).all() or not way.any() or way[0] != 0.0:
        raise InputError("distances", "they are no way from 0", "give e.g. [0.0, 0.01, 0.02], in metres")
    push = _push(scene, model, way, watch, second_order, pace.duration)
    longest = _LONGEST * PACE.duration
    if push.inertia > pace.most_inertia and pace.duration < longest:
        longer = min(longest, 1.1 * pace.duration * math.sqrt(push.inertia / pace.most_inertia))
        # Where joints all along a member bear Q_max, that may find no solution: then the one before stands, as it says.
        with suppress(SolverError):
            before, push = push, _push(scene, model, way, watch, second_order, longer)
            if longer < longest and _differ(before, push) > _ALIKE:
                push = _push(scene, model, way, watch, second_order, longest)
    return push


def _differ(first: Push, second: Push) -> float:
    """Largest difference of the loads of two pushes through the same distances, over the largest load."""
    loads = second.load_at_distances
    return float(np.abs(loads - first.load_at_distances).max() / np.abs(loads).max())


def _push(
    scene: Scene,
    model: Model,
    distances: np.ndarray,
    watch: Callable[[float], None],
    second_order: float,
    duration: float,
) -> Push:
    assembly = assemble(scene, model, shapes=False)
    moments = SecondOrder(assembly, scene.push.node, scene.push_direction(), second_order)
    settle(scene, assembly, 1e-9 * scene.push.way(), moments.act)
    turns = [0, *(1 + np.flatnonzero(np.diff(np.sign(np.diff(distances))))).tolist(), len(distances) - 1]
    legs = [distances[a : b + 1] for a, b in itertools.pairwise(turns)]
    steps_a_leg = max(1, round(duration / model.dt))
    planned = steps_a_leg * len(legs)
    way = float(np.abs(distances).max())
    driver = LoadDriver(assembly, scene.push.node, scene.push_direction(), way)
    newton_before, unconverged_before = assembly.structure.newton_steps, assembly.structure.unconverged
    taken, factors, ways, kinetic, ends = [0.0], [0.0], [0.0], [0.0], [0]
    bearing: list[tuple[tuple[DuctileJoint, ...], np.ndarray]] = []
    seconds = 0.0
    for leg in legs:
        for wanted in _wanted(leg, steps_a_leg, driver):
            driver.aim(wanted, model.dt)
            moments.act(model.dt, factor=driver.factor)
            assembly.act()
            started = time.thread_time()
            assembly.space.step(model.dt)
            seconds += time.thread_time() - started
            driver.read(model.dt)
            taken.append(driver.displacement)
            factors.append(driver.factor)
            structure = assembly.structure
            ways.append(driver.way)
            kinetic.append(structure.energy.kinetic)
            bearing.append((assembly.joints, structure.force))
            count, so_far = structure.unconverged - unconverged_before, len(bearing)
            if count > _MOST_UNCONVERGED * planned:
                raise SolverError(
                    f"{count} of the first {so_far} steps found no solution; shorten them, or take fewer joints"
                )
            if len(bearing) % 64 == 0:
                watch(min(1.0, len(bearing) / planned))
        ends.append(len(bearing))
    displacement, load, steps = np.array(taken), np.array(factors), len(bearing)
    passed = [load[:1]]
    for leg, (first, last) in zip(legs, itertools.pairwise(ends), strict=True):
        passed.append(_passed(leg, displacement[first : last + 1], load[first : last + 1]))
    return Push(
        displacement=displacement,
        load=load,
        load_at_distances=np.concatenate(passed),
        force=forces_on(assembly.joints[: len(assembly.places)], bearing),
        places=assembly.places,
        bodies=sum(body.body_type == pymunk.Body.DYNAMIC for body in structure.bodies),
        joints=len(assembly.places),
        steps=steps,
        seconds=seconds,
        simulated_seconds=steps * model.dt,
        newton_steps=(structure.newton_steps - newton_before) / steps,
        unconverged=structure.unconverged,
        dissipated=float(structure.dissipated.sum()),
        duration=duration,
        inertia=_inertia(np.array(kinetic), np.array(ways), ends, float(np.abs(load).max())),
    )


def _inertia(kinetic: np.ndarray, way: np.ndarray, ends: list[int], load: float) -> float:
    """Kinetic energy gained or lost on a bit of the way, over the work of ``load`` on it."""
    most = 0.0
    for first, last in itertools.pairwise(ends):
        window = max(1, round(_SEEN * (last - first)))
        gained, worked = (
            np.abs(values[first + window : last + 1] - values[first : last + 1 - window])
            for values in (kinetic, load * way)
        )
        most = max(most, float((gained / np.maximum(worked, 0.5 * worked.mean())).max()))
    return most


def _wanted(leg: np.ndarray, steps: int, driver: LoadDriver) -> Iterator[float]:
    """Where the node shall be after each step: along ``leg`` in ``steps``, then at its end until it is there."""
    yield from _eased(leg, steps)
    for _ in range(round(LONGEST_WAIT * steps)):
        if driver.is_at(leg[-1]):
            return
        yield leg[-1]


def _eased(leg: np.ndarray, steps: int) -> np.ndarray:
    """Distances after each of ``steps`` through those of ``leg``, with speeds averaged so that nothing jerks."""
    window = min(steps, max(1, round(EASE * steps)))
    speeds = np.diff(np.interp(np.linspace(0.0, len(leg) - 1.0, steps - window + 2), np.arange(len(leg)), leg))
    way: np.ndarray = leg[0] + np.cumsum(np.convolve(speeds, np.full(window, 1.0 / window)))
    return way


def _passed(leg: np.ndarray, displacement: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Loads at the distances of ``leg`` but its first, from those at the displacements that the node took."""
    way = 1.0 if leg[-1] >= leg[0] else -1.0
    passed: np.ndarray = np.interp(way * leg[1:], np.maximum.accumulate(way * displacement), load)
    return passed
