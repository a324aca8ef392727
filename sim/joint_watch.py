"""Watching all ductile joints of a space: what they bear now, and the most they bore."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pymunk

from sim.energy import Energy
from sim.joint import DuctileJoint
from sim.structure import Structure

#: Columns of `JointWatch.state`: N, Q, M, share of the plastic capacity used, 1 when broken.
FORCE, USED, BROKEN = slice(0, 3), 3, 4


class JointWatch:
    """Joints of a space in the order in which they were first seen.

    Attributes
    ----------
    joints : list of DuctileJoint
    peak : (n, 3) float
        Largest N, Q [N] and M [N m] in any step, without sign.
    """

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space
        self.joints: list[DuctileJoint] = []
        self.peak = np.zeros((0, 3))
        self._state = np.zeros((0, 5))
        self._row: dict[DuctileJoint, int] = {}
        self._rows: dict[Structure, np.ndarray] = {}
        self._constraints: list[pymunk.Constraint] = []
        self._present: list[DuctileJoint] = []
        self._spent = Energy()

    def note(self) -> None:
        """Take note of a step."""
        constraints, gone = list(self._space.constraints), self._present
        if constraints != self._constraints:
            self._constraints = constraints
            self._present = [constraint for constraint in constraints if isinstance(constraint, DuctileJoint)]
            self._meet(self._present)
        current = {joint.structure for joint in self._present}
        # Also of joints that have just gone: one may have been made and broken within this step.
        before = current if gone is self._present else {joint.structure for joint in gone}
        for structure in before | current:
            if structure is not None and structure not in self._rows:
                # One may have come and broken since the last step.
                self._meet(structure.joints)
                self._rows[structure] = np.array([self._row[joint] for joint in structure.joints])
        # A structure that is no more is read a last time, for the step in which it broke; what has passed on to
        # another is then read from that.
        for past in [structure for structure in self._rows if structure not in current]:
            self._read(past)
            del self._rows[past]
            self._spent += _without_what_passes_on(past.energy)
        for structure in self._rows:
            self._read(structure)

    def _meet(self, joints: Iterable[DuctileJoint]) -> None:
        """Give joints that are new a row."""
        for joint in joints:
            if joint not in self._row:
                self._row[joint] = len(self.joints)
                self.joints.append(joint)
        new = len(self.joints) - len(self.peak)
        self.peak, self._state = (np.pad(array, ((0, new), (0, 0))) for array in (self.peak, self._state))

    def state(self) -> np.ndarray:
        """What each joint bears, (n, 5); no force in one that was taken out of the space."""
        state = self._state.copy()
        gone = np.ones(len(state), dtype=bool)
        gone[[self._row[joint] for joint in self._present]] = False
        state[gone, FORCE] = 0.0
        return state

    def ledger(self) -> Energy:
        """Ledger of all structures that there are or were; bodies that come off take their kinetic energy with them."""
        return sum((structure.energy for structure in self._rows), self._spent)

    def _read(self, structure: Structure) -> None:
        rows, force, used = self._rows[structure], structure.force, structure.capacity_used
        self.peak[rows] = np.maximum(self.peak[rows], np.abs(force))
        self._state[rows, FORCE] = force
        self._state[rows, USED] = used
        self._state[rows, BROKEN] = (used >= 1.0) & ~structure.active


def _without_what_passes_on(energy: Energy) -> Energy:
    """Of a structure that is no more: its successors begin with what is kinetic and elastic, as given from outside."""
    return replace(energy, external=energy.external - energy.kinetic - energy.elastic, kinetic=0.0, elastic=0.0)
