"""Structures: joints that share bodies, solved together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pymunk

from capacity import InputError
from sim import chipmunk
from sim.far_side import turn_round
from sim.joint import DuctileJoint
from sim.kernels import layout as at
from sim.laws import Law
from sim.leaving import take_out_broken
from sim.near import Surroundings
from sim.noted import Notes, notes_known
from sim.notices import listen
from sim.ordering import minimum_degree
from sim.readings import Readings
from sim.refused_step import RefusedStep
from sim.space_state import look_after
from sim.succession import take_bodies, take_joints, take_ledger
from sim.tables import Tables

_TOLERANCE = 1e-9


class Structure(Readings):
    """Joints that are solved as one; views of what they bear, as arrays over the joints.

    Made by itself in the first step of a space (see `DuctileJoint.structure`), or from joints at hand to have the
    arrays before. It is saved and copied along with the space that it is in.

    Parameters
    ----------
    joints : sequence of DuctileJoint
        At least one; those that already were in a structure keep their plastic state.
    tolerance : float
        Newton's method ends when the residual impulses, as velocities, are below this share of the bodies' own.
    after : Structure, optional
        Whose bodies these are, though its joints may all have been replaced.

    Raises
    ------
    ValueError
        When there is no joint.
    InputError
        When the joints do not have the same time integration.
    """

    #: The memory that the kernels work on.
    tables: Tables
    #: See the parameter.
    tolerance: float
    #: Bodies of the structure: dynamic ones in order of elimination, then the others.
    bodies: tuple[pymunk.Body, ...]
    #: Whether it has ended, and others have taken over its joints.
    superseded = False
    #: How many of its bodies have not taken their share of its ledger to another.
    to_pass_on: int
    # While it is restored: what was saved, and how many joints are back.
    _saved: dict[str, Any] | None = None
    _restored = 0
    # What is noted of the space in a step; once it has been looked through.
    _notes: Notes

    def __init__(
        self, joints: Sequence[DuctileJoint], tolerance: float = _TOLERANCE, after: Structure | None = None
    ) -> None:
        if not joints:
            raise ValueError("a structure needs at least one joint")
        if len({joint.scheme for joint in joints}) > 1:
            places = {joint.scheme: joint.at for joint in joints}
            (one, (x, y)), (other, (u, v)), *_ = places.items()
            fault = f"they share bodies, and one has the time integration {one}, the other {other}"
            raise InputError(f"joints at {x:g}, {y:g} and {u:g}, {v:g}", fault, "give both the same scheme=")
        self._build(tuple(joints), tolerance)
        self._take_over(after)

    def _build(self, joints: tuple[DuctileJoint, ...], tolerance: float) -> None:
        """Find an order of elimination, and lay out the memory."""
        self.joints, self.tolerance = joints, tolerance
        bodies = list(dict.fromkeys(body for joint in self.joints for body in (joint.a, joint.b)))
        moving = [body for body in bodies if body.body_type == pymunk.Body.DYNAMIC]
        held = [body for body in bodies if body.body_type != pymunk.Body.DYNAMIC]
        index = {body: i for i, body in enumerate(moving)}
        pairs = [(index[j.a], index[j.b]) for j in self.joints if j.a in index and j.b in index]
        pattern = minimum_degree(len(moving), pairs)
        self.bodies = tuple([moving[i] for i in pattern.order] + held)
        for space in {body.space for body in bodies if body.space is not None}:
            look_after(space)
            notes = notes_known(space)
            if notes is not None:
                notes.outdate()
        self.tables = Tables(joints, self.bodies, pattern, tolerance)
        self._control = self.tables.control
        self._control[[at.NOTICE, at.KEY]] = listen(self)
        self._surroundings = Surroundings()
        self._refused = RefusedStep()
        self._settings, self._result = self.tables[at.SETTINGS], self.tables[at.RESULT]
        self.to_pass_on = len(moving)

    def _take_over(self, after: Structure | None) -> None:
        """Make the joints this structure's, to go on from where others have left them and their bodies."""
        olds = dict.fromkeys([after, *(joint.structure for joint in self.joints)])
        before = [old for old in olds if old is not None and not old.superseded]
        take_joints(self, before)
        take_bodies(self, before, after is None)
        take_ledger(self, before, after is not None)
        for i in range(len(self.joints)):
            self._adopt(i)

    def _adopt(self, index: int) -> None:
        joint = self.joints[index]
        joint.join(self, index)
        chipmunk.assign(joint._constraint, self._control, index)

    def __getstate__(self) -> dict[str, Any]:
        """What is needed to go on from here: joints, and what they and their space (`SpaceState`) do not say."""
        return {
            "joints": self.joints,
            "tolerance": self.tolerance,
            "kept": self.tables.kept(),
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._saved = state
        self._complete()

    def restore_joint(self) -> None:
        """One more of the structure's joints has been restored; called by the joint."""
        self._restored += 1
        self._complete()

    def _complete(self) -> None:
        """Go on from the saved state, once it and all joints are back, in whichever order they came."""
        state = self._saved
        if state is None or self._restored < len(state["joints"]):
            return
        del self._saved, self._restored
        self._build(tuple(state["joints"]), state["tolerance"])
        self.tables.restore(state["kept"])
        for i, joint in enumerate(self.joints):
            asks = joint.pre_solve is not None
            self._adopt(i)
            if asks:
                joint.ask_for_structure()

    def is_of(self, joints: Sequence[DuctileJoint]) -> bool:
        """Whether these are its joints, all of which hold, and it knows what moves."""
        return self.knows_what_moves and set(self.joints) == set(joints) and bool(self.active.all())

    @property
    def knows_what_moves(self) -> bool:
        """Whether the bodies that were dynamic when the structure was built still are, and no others."""
        moving = int(self._control[at.MOVING])
        return all((b.body_type == pymunk.Body.DYNAMIC) == (i < moving) for i, b in enumerate(self.bodies))

    def know(self, notes: Notes) -> None:
        """Use what is noted of the space in a step."""
        self._notes = notes
        self._control[at.NOTES] = notes.table.ctypes.data

    def change_law(self, joint: int, law: Law) -> None:
        """Give a joint new numbers for the law it has; its plastic state stays.

        Raises
        ------
        ValueError
            When ``law`` is of another kind or size.
        """
        values = law.parameters()
        parameters = self.tables.parameters(joint % len(self.joints))
        if type(law) is not type(self.joints[joint].law) or len(values) != len(parameters):
            raise ValueError(f"joint {joint} has a law of another kind or size")
        parameters[:] = values
        self.tables[at.STIFFNESS][joint] = law.elastic_tangent()
        self.joints[joint].law = law

    def drive(self, pattern: np.ndarray, stiffness: float, gap: float) -> None:
        """Drive a load pattern in the next step, by a spring between the displacement it works on and a wanted one.

        Parameters
        ----------
        pattern : (bodies, 3) float
            Force x, y [N] and moment [N m] on each of `bodies` for a load factor of 1.
        stiffness : float
            Load factor over displacement [1/m, when the displacement is in N m].
        gap : float
            Wanted displacement at the end of the step, less the present one, Σ pattern · movement [N m].
        """
        self.tables.make_pattern()
        self.tables[at.PATTERN][:] = pattern
        self._settings[at.SPREAD_STIFFNESS] = stiffness
        self._settings[at.SPREAD_GAP] = gap

    @property
    def pattern_response(self) -> np.ndarray:
        """Change of the bodies' velocities for a unit impulse of the driven pattern, joints included, (bodies, 3)."""
        return self.tables[at.IMAGE].copy()

    @property
    def load_factor(self) -> float:
        """Load factor of the driven pattern in the last step [-]."""
        return float(self._settings[at.SPREAD_IMPULSE] / self._settings[at.STEP])

    @property
    def scheme(self) -> tuple[float, float]:
        """β and δ of the time integration; may be changed between steps."""
        beta, delta = self._settings[[at.WANTED_BETA, at.WANTED_DELTA]].tolist()
        return beta, delta

    @scheme.setter
    def scheme(self, scheme: tuple[float, float]) -> None:
        self._settings[[at.BETA, at.DELTA]] = self._settings[[at.WANTED_BETA, at.WANTED_DELTA]] = scheme
        for joint in self.joints:
            joint.scheme = scheme

    @property
    def whole_steps_only(self) -> bool:
        """Whether no step is taken in parts, whatever happens in it."""
        return bool(self._settings[at.WHOLE_ONLY])

    @whole_steps_only.setter
    def whole_steps_only(self, wanted: bool) -> None:
        self._settings[at.WHOLE_ONLY] = wanted

    def told(self) -> None:
        """Something happened in a step that the space has not left yet; called by the kernels."""
        if self._control[at.ASKED]:
            self._surroundings.answer(self, self._notes)
            return
        if not self._control[at.NOTES]:
            from sim.grouping import look_through

            space = next((body.space for body in self.bodies if body.space is not None), None)
            if space is not None:
                self.know(look_through(space))
            return
        fault = int(self._control[at.FAULT])
        if fault >= 0:
            self._refused.told(self, self.joints[fault], self._notes)
            return
        if self._control[at.PARTS] > 1 and not self._control[at.COPY]:
            self.tables.make_copy()
            return
        if self._control[at.ASTRAY] > 0:
            turn_round(self.bodies[: int(self._control[at.MOVING])], self.step)
        if self._control[at.MISSED] > 0:
            self.tables.make_room(2 * int(self._control[at.ROOM] + self._control[at.MISSED]))
        if self._control[at.BROKE] > 0:
            take_out_broken(self)
