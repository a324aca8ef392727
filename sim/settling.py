"""A scene at rest under what bears on it all the time."""

from __future__ import annotations

from collections.abc import Callable

import pymunk

from scene import Scene
from sim.members import Assembly
from sim.step_back import SolverError

#: Step while a scene settles [s]; long, for the longer it is the more it damps.
SETTLING_STEP = 1.0 / 60.0
# Weight, dead loads and settlements grow over so many steps: at once they would bear down with twice their size.
_LOADING_STEPS = 120
_MOST_STEPS = 10_000


def settle(
    scene: Scene,
    assembly: Assembly,
    rest: float,
    before_step: Callable[[float, float], None] = lambda dt, share: None,
) -> None:
    """Let ``assembly`` come to rest under own weight, dead loads and settlements.

    Parameters
    ----------
    scene : Scene
    assembly : Assembly
        Of that scene.
    rest : float
        Way per step that counts as rest [m].
    before_step : callable
        Told the step [s] and the share of the dead loads that acts in it.

    Raises
    ------
    SolverError
        When it does not come to rest.
    """
    if scene.gravity == 0.0 and not assembly.dead_loads and not assembly.settlements:
        return
    # What it swings is not of interest, and to be damped as much as can be.
    assembly.structure.whole_steps_only = True
    for k in range(_MOST_STEPS):
        before, share = min(1.0, k / _LOADING_STEPS), min(1.0, (k + 1) / _LOADING_STEPS)
        assembly.space.gravity = (0.0, -share * scene.gravity)
        for support in assembly.settlements:
            way = pymunk.Vec2d(*support.way)
            support.body.velocity = (share - before) / SETTLING_STEP * way
            support.body.position = share * way
        assembly.refine()
        before_step(SETTLING_STEP, share)
        assembly.step(SETTLING_STEP, share)
        speed = max(body.velocity.length for body in assembly.structure.bodies)
        if share == 1.0 and speed * SETTLING_STEP < rest:
            assembly.structure.whole_steps_only = False
            return
    raise SolverError("the scene does not come to rest under its own weight; support it, or make it stronger")
