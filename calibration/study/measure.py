"""Measuring one point: what a worker process does."""

from __future__ import annotations

import statistics
from dataclasses import asdict
from typing import Any

from calibration.comparable_push import push_model
from calibration.engines.handover import hand_over
from calibration.engines.pushing import Unstable, curve_errors
from calibration.engines.to_pymunk import Turn, module_text, push_module
from calibration.errors import compare
from calibration.study.hard_cases import let_down
from calibration.study.points import HardPoint, ModelPoint, Point
from capacity import InputError
from fem_reference import PushAnswer
from scene import Scene
from sim import SolverError

#: Each push is repeated, and the median of its processor times taken: errors do not vary, times do.
REPEATS = 3


def measure(scene: Scene, reference: PushAnswer, point: Point) -> dict[str, Any]:
    """Errors and cost of ``point``, as a dict for JSON; with ``failure`` alone when it could not be stepped."""
    try:
        if isinstance(point, HardPoint):
            return let_down(scene, point)
        if point.kind == "ductile":
            return _ductile(scene, reference, point)
        return _stock(scene, reference, point, point.kind)
    except (SolverError, Unstable, InputError) as error:  # that a rule does not fit a member is the point's failure
        return {"failure": str(error)}


def _ductile(scene: Scene, reference: PushAnswer, point: ModelPoint) -> dict[str, Any]:
    pushes = [push_model(scene, point.model, reference.displacement) for _ in range(REPEATS)]
    push = pushes[0]
    errors = compare(reference, push)
    return {
        "path_max": errors.path_max,
        "collapse_load": errors.collapse_load,
        "unconverged": push.unconverged,
        **_cost([p.seconds for p in pushes], push.simulated_seconds, push.steps, push.bodies, push.joints),
    }


def _stock(scene: Scene, reference: PushAnswer, point: ModelPoint, turn: Turn) -> dict[str, Any]:
    handover = hand_over(scene, point.model)
    assert handover.push is not None  # or there were no reference
    text = module_text(handover, turn, "")
    pushes = [push_module(text, handover, handover.push, reference.displacement) for _ in range(REPEATS)]
    push = pushes[0]
    joints = sum(not joint.name.startswith("support") for joint in handover.joints)
    return {
        **asdict(curve_errors(reference, push)),
        **_cost([p.seconds for p in pushes], push.simulated_seconds, push.steps, len(handover.bodies), joints),
    }


def _cost(seconds: list[float], simulated: float, steps: int, bodies: int, joints: int) -> dict[str, Any]:
    median = statistics.median(seconds)
    return {
        "bodies": bodies,
        "joints": joints,
        "seconds": median,
        "seconds_spread": max(seconds) - min(seconds),
        "seconds_per_simulated_second": median / simulated,
        "microseconds_per_joint_step": 1e6 * median / (steps * joints),
    }
