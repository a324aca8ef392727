"""Stock pymunk: pivots with gears or damped rotary springs that yield."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pymunk

from calibration.engines.handover import Handover, PushPoint
from calibration.engines.pushing import Pushed, push_rig
from calibration.engines.text import number, render

#: A gear is rigid until it yields; a spring is elastic, and explicit: it needs short steps.
Turn = Literal["gear", "spring"]
#: The pusher is this many times as heavy as everything else: its change of velocity is the force on it.
_HEAVY = 1e6


def module_text(handover: Handover, turn: Turn, notes: str) -> str:
    """A Python module that builds the scene from stock constraints."""
    return render(
        "pymunk.py.j2",
        infinite="math.inf",
        scene=handover.name,
        notes=notes,
        spring=turn == "spring",
        dt=number(handover.model.dt),
        iterations=handover.model.iterations,
        gravity=number(handover.gravity),
        bodies=handover.bodies,
        joints=handover.joints,
    )


def push_module(text: str, handover: Handover, push: PushPoint, distances: np.ndarray) -> Pushed:
    """Run a module that `module_text` wrote, and push what it builds."""
    return push_rig(_PymunkRig(text, handover, push), handover, push, distances)


class _PymunkRig:
    """A space built by the module; see `calibration.engines.pushing.Rig`."""

    def __init__(self, text: str, handover: Handover, push: PushPoint) -> None:
        module: dict[str, Any] = {}
        exec(compile(text, f"{handover.name}.py", "exec"), module)
        self.dt, self.gravity, self.push = handover.model.dt, handover.gravity, push
        self.space, self.after_step = pymunk.Space(), module["after_step"]
        self.bodies, self.yielding = module["build"](self.space)
        self.pusher: pymunk.Body | None = None

    def place(self, body: int) -> tuple[float, float, float]:
        x, y = self.bodies[body].position
        return x, y, self.bodies[body].angle

    def act(self, body: int, force: tuple[float, float], moment: float) -> None:
        self.bodies[body].apply_force_at_world_point(force, self.bodies[body].position)
        self.bodies[body].torque += moment

    def hold(self) -> None:
        node, at = self.bodies[self.push.body], self.push.point
        self.heavy = _HEAVY * sum(body.mass for body in self.bodies)
        self.pusher = pymunk.Body(self.heavy, self.heavy * 1e6)
        self.pusher.position = self.origin = node.local_to_world(at)
        dx, dy = self.push.direction
        across = (1e3 * dy, -1e3 * dx)
        groove = pymunk.GrooveJoint(self.pusher, node, across, (-across[0], -across[1]), at)
        self.space.add(self.pusher, groove)
        self.travel = 0.0

    def step(self, travel: float) -> float:
        dt, (dx, dy) = self.dt, self.push.direction
        if self.pusher is None:
            self._step()
            return 0.0
        # Chipmunk moves bodies with their velocities first, and then solves for those of the next move.
        speed = (travel - self.travel) / dt
        self.pusher.position = self.origin + self.travel * pymunk.Vec2d(dx, dy)
        self.pusher.velocity, self.pusher.angular_velocity, self.pusher.angle = (speed * dx, speed * dy), 0.0, 0.0
        self.travel = travel
        self._step()
        vx, vy = self.pusher.velocity
        change = (vx - speed * dx) * dx + (vy - speed * dy + self.gravity * dt) * dy
        return float(-self.heavy * change / dt)

    def _step(self) -> None:
        self.space.step(self.dt)
        self.after_step(self.space, self.yielding)
