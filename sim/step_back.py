"""A step that has to be refused before it has begun: why, and the space as it was before it.

Structures put themselves back (`sim.kernels.refusal`).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np
import pymunk

from sim import chipmunk
from sim.chipmunk import (
    ANGLE,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_WORDS,
    ARBITERS_OF_SPACE,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONTACT_BYTES,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_WORDS,
    MOVING_BODIES,
    SPIN,
    VX,
    X,
    words,
)

# Above this, squares are not finite.
_BOUND = 1e150


def reason(place: str, bodies: tuple[pymunk.Body, pymunk.Body], moving: Collection[pymunk.Body], step: float) -> str:
    """Why a step [s] cannot begin, and what to do, where its fault is that of a joint between two ``bodies``.

    ``place`` names the joint; ``moving`` are the bodies of its structure that were dynamic when that was built.
    """
    for body in bodies:
        if (body.body_type == pymunk.Body.DYNAMIC) != (body in moving):
            return f"{place} has a body of another type than before; after changing body_type, call ask_for_structure()"
        if body in moving and body.space is None:
            return f"{place} has a body that is no longer in the space; take the joint out, too, or add the body again"
    return not_finite(place, _out_of_bounds(bodies, step))


def not_finite(place: str, why: str = "") -> str:
    """What is said of a joint at ``place`` that has no finite impulse."""
    because = f": {why}" if why else ""
    cure = "look for a body that was moved or pushed without bound, or take a shorter step or a lower stiffness"
    return f"the impulse of {place} is not finite{because}; {cure}"


def _out_of_bounds(bodies: tuple[pymunk.Body, pymunk.Body], step: float) -> str:
    """What of a joint's bodies, or of the step [s], leads out of all bounds."""
    if not 0.0 < step < math.inf:
        return f"a step of {step:g} s cannot be taken; give one above 0"
    for body in bodies:
        if body.body_type != pymunk.Body.DYNAMIC:
            continue
        numbers = {
            "position": (*body.position, body.angle),
            "velocity": (*body.velocity, body.angular_velocity),
            "force": (*body.force, body.torque),
        }
        for what, values in numbers.items():
            if max(map(abs, values)) > _BOUND or not all(map(math.isfinite, values)):
                return f"a body of it has a {what} of ({', '.join(f'{value:g}' for value in values)})"
    return "its bodies' velocities are beyond all bounds"


class StepBack:
    """Velocities, contact impulses and those of Chipmunk's own constraints, noted once a step has moved the bodies.

    Parameters
    ----------
    space : pymunk.Space
        In a step, before any velocity has changed.
    step : float
        [s]
    own : collection of int
        Addresses of the bodies that put themselves back.
    pushes : mapping of int to (3,) array
        By address, pseudo-velocities with which bodies went into the move.
    """

    def __init__(
        self, space: pymunk.Space, step: float, own: Collection[int], pushes: Mapping[int, np.ndarray]
    ) -> None:
        body_at = {chipmunk.body_address(body): body for body in space.bodies}
        self._bodies = []
        for one in chipmunk.listed(space, MOVING_BODIES).tolist():
            if one not in own:
                b = words(one, BODY_WORDS)
                velocity, pushed = b[[VX, VX + 1, SPIN]], pushes.get(one, np.zeros(3))
                # Where the step is no number, neither are places any more.
                with np.errstate(invalid="ignore"):
                    place = b[[X, X + 1, ANGLE]] - step * (velocity + pushed)
                self._bodies.append((body_at[one], place, velocity, pushed))
        contacts = [contact for one in chipmunk.listed(space, ARBITERS_OF_SPACE).tolist() for contact in _contacts(one)]
        self._contacts = [(contact, contact.copy()) for contact in contacts]
        own_impulses = [chipmunk.cached_impulse(constraint) for constraint in space.constraints]
        self._impulses = [(impulse, impulse.copy()) for impulse in own_impulses]

    def go(self) -> None:
        """Put it back; after the step."""
        for body, (x, y, angle), (vx, vy, spin), pushed in self._bodies:
            body.position, body.angle = (x, y), angle
            body.velocity, body.angular_velocity = (vx, vy), spin
            words(chipmunk.body_address(body), BODY_FULL_WORDS)[BIAS_VX : BIAS_SPIN + 1] = pushed
        for now, before in [*self._contacts, *self._impulses]:
            now[:] = before


def _contacts(arbiter: int) -> list[np.ndarray]:
    """Normal and tangential impulses of an arbiter's contacts, to be changed in place."""
    w = words(arbiter, ARBITER_WORDS, np.int64)
    first, count = int(w[ARBITER_CONTACTS]), int(w[ARBITER_COUNT]) & 0xFFFFFFFF
    pair = slice(CONTACT_NORMAL_IMPULSE, CONTACT_NORMAL_IMPULSE + 2)
    return [words(first + CONTACT_BYTES * k, CONTACT_WORDS)[pair] for k in range(count)]


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
