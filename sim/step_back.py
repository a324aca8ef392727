"""A step that is refused: why, and the space as it was before it.

Structures put themselves back (`sim.kernels.refusal`); of all else the kernels take notes (`sim.kernels.noted`).
"""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np
import pymunk

from sim import chipmunk
from sim.chipmunk import (
    BIAS_SPIN,
    BIAS_VX,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_WORDS,
    CURRENT_STEP,
    IDLE_TIME,
    MOVING_BODIES,
    SLEEP_WORDS,
    SPACE_WORDS,
    SPIN,
    VX,
    words,
)
from sim.kernels import noted
from sim.kernels.refusal import ROUNDING
from sim.noted import Notes

# Above this, squares are not finite.
_BOUND = 1e150


class SolverError(RuntimeError):
    """A step that was refused."""


def reason(place: str, bodies: tuple[pymunk.Body, pymunk.Body], moving: Collection[pymunk.Body], step: float) -> str:
    """Why a step [s] cannot begin, and what to do, where its fault is that of a joint between two ``bodies``.

    ``place`` names the joint; ``moving`` are the bodies of its structure that were dynamic when that was built.
    """
    if not 0.0 < step < math.inf:
        return f"a step of {step:g} s cannot be taken; give one above 0, such as 1 / 60"
    for body in bodies:
        if (body.body_type == pymunk.Body.DYNAMIC) != (body in moving):
            return f"{place} has a body of another type than before; after changing body_type, call ask_for_structure()"
        if body in moving and body.space is None:
            return f"{place} has a body that is no longer in the space; take the joint out, too, or add the body again"
    return not_finite(place, bodies)


def not_finite(place: str, bodies: tuple[pymunk.Body, pymunk.Body]) -> str:
    """What is said of a joint at ``place`` between two ``bodies`` that has no finite impulse."""
    why = _out_of_bounds(bodies)
    because = f": {why}" if why else ""
    cure = "look for a body that was moved or pushed without bound, or take a shorter step or a lower stiffness"
    return f"the impulse of {place} is not finite{because}; {cure}"


def _out_of_bounds(bodies: tuple[pymunk.Body, pymunk.Body]) -> str:
    """What of a joint's bodies leads out of all bounds; velocities and forces before what follows from them."""
    for body in bodies:
        if body.body_type != pymunk.Body.DYNAMIC:
            continue
        numbers = {
            "the space has a gravity": body.space.gravity if body.space else (0.0, 0.0),
            "a body of it has a force": (*body.force, body.torque),
            "a body of it has a velocity": (*body.velocity, body.angular_velocity),
            "a body of it has a position": (*body.position, body.angle),
        }
        for what, values in numbers.items():
            if not max(map(abs, values)) <= _BOUND or not all(map(math.isfinite, values)):
                return f"{what} of ({', '.join(f'{value:g}' for value in values)})"
    return ""


class StepBack:
    """Loose bodies, contacts and Chipmunk's own constraints of a space in a step, as they were before it.

    Parameters
    ----------
    space : pymunk.Space
    step : float
        [s]
    notes : Notes
        Of this step.
    """

    def __init__(self, space: pymunk.Space, step: float, notes: Notes) -> None:
        self._space, self._step, self._notes = space, step, notes
        self._loose, self._contacts = notes.loose.copy(), notes.contacts.copy()
        self._stock = [(now, then.copy()) for now, then in zip(notes.stock, notes.numbers, strict=True)]
        stamp, ended, self._last_step = notes.table[[noted.STAMP, noted.ENDED, noted.LAST_STEP]].tolist()
        self._known = ended == stamp - 1

    def go(self) -> None:
        """Put it back; after the step."""
        for row in self._loose:
            self._put_back(row)
        for row in self._contacts:
            impulses = words(int(row[0].view(np.int64)), CONTACT_WORDS)[CONTACT_NORMAL_IMPULSE:]
            impulses[:2] = row[1:3]
        for now, before in self._stock:
            now[:] = before
        if self._space.sleep_time_threshold < math.inf:
            for one in chipmunk.listed(self._space, MOVING_BODIES).tolist():
                b = words(one, SLEEP_WORDS)
                b[IDLE_TIME] = max(b[IDLE_TIME] - self._step, 0.0)
        notes = self._notes
        if self._known:
            words(chipmunk.address(self._space._space), SPACE_WORDS, np.int64)[CURRENT_STEP] = self._last_step
            notes.table[[noted.ENDED, noted.LAST_STEP]] = notes.table[noted.STAMP], self._last_step
            notes.loose[:] = self._loose

    def _put_back(self, row: np.ndarray) -> None:
        """Put a loose body back to where the last step ended, or where it was put by hand since."""
        location, speed = int(row[0].view(np.int64)), row[noted.SPEED : noted.SPEED + 3]
        known = self._known and not math.isnan(row[noted.PLACE])
        push = row[noted.PUSH : noted.PUSH + 3] if known else np.zeros(3)
        # Where the step is no number, neither are places any more.
        with np.errstate(invalid="ignore", over="ignore"):
            place = row[noted.MOVED : noted.MOVED + 3] - self._step * (speed + push)
        then = row[noted.PLACE : noted.PLACE + 9]
        if known and not (np.abs(place - then[:3]) > ROUNDING * (1.0 + np.abs(then[:3]))).any():
            place = then
        chipmunk.put_body(location, place)
        b = words(location, SLEEP_WORDS)
        b[[VX, VX + 1, SPIN]] = speed
        b[BIAS_VX : BIAS_SPIN + 1] = push


def raise_after_step(space: pymunk.Space, error: Exception, back: StepBack | None = None) -> None:
    """Have ``space`` raise ``error`` at the end of the step that it is in, put back to before it."""
    pending = [error]

    def fail(space: pymunk.Space, key: object) -> None:  # noqa: ARG001
        # pymunk does not forget a callback that raises.
        if pending:
            if back is not None:
                back.go()
            raise pending.pop()

    space.add_post_step_callback(fail, object())
