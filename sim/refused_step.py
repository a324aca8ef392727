"""A structure whose kernels refuse a step: all others of its space refuse it, too, and the space is put back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pymunk

from sim.joint import DuctileJoint
from sim.kernels import layout as at
from sim.noted import Notes
from sim.step_back import SolverError, StepBack, not_finite, raise_after_step, reason

if TYPE_CHECKING:
    from sim.structure import Structure


class RefusedStep:
    """What is known of a refused step between its beginning and its end."""

    def __init__(self) -> None:
        self._why = ""
        self._back: StepBack | None = None

    def told(self, structure: Structure, joint: DuctileJoint, notes: Notes) -> None:
        """The kernels found a fault in ``joint``, or have come to the end of the step in which they did."""
        x, y = joint.at
        place = f"joint {joint.index} (made at {x:g}, {y:g})"
        control = structure.tables.control
        if control[at.LEADER]:
            bodies = joint.a, joint.b
            if control[at.FRESH] == 1:
                self._why = reason(place, bodies, structure.bodies[: int(control[at.MOVING])], structure.step)
            else:
                self._why = not_finite(place, bodies)
            self._back = _step_back(structure, space_of(joint), notes)
            return
        control[at.FAULT] = -1
        error = SolverError(f"the step was refused: {self._why}")
        raise_after_step(space_of(joint), error, self._back)
        self._why, self._back = "", None


def _step_back(structure: Structure, space: pymunk.Space, notes: Notes) -> StepBack:
    """Have all other structures of the space refuse the step, too, and note how all else was."""
    others = {joint.structure for joint in space.constraints if isinstance(joint, DuctileJoint)}
    for other in others:
        if other is not None and other.tables.control[at.FAULT] < 0 and not other.bodies[0].is_sleeping:
            other.tables.control[at.FAULT] = at.WITH_OTHERS
    return StepBack(space, float(structure.tables[at.SETTINGS][at.WHOLE_STEP]), notes)


def space_of(joint: DuctileJoint) -> pymunk.Space:
    """The space that a joint's moving bodies are in."""
    body = joint.a if joint.a.body_type == pymunk.Body.DYNAMIC else joint.b
    assert body.space is not None
    return body.space
