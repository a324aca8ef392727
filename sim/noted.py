"""The memory in which a step notes what it changes of a space beside its structures (`sim.kernels.noted`)."""

from __future__ import annotations

import weakref

import numpy as np
import pymunk

from sim import chipmunk
from sim.chipmunk import ARBITERS_OF_SPACE, CONSTRAINT_CLASS, CONSTRAINTS_OF_SPACE, CONTROL, MOVING_BODIES
from sim.joint import DuctileJoint
from sim.kernels import noted as at
from sim.kernels.ties import CONSTRAINT, KIND, PLACE, TIE_WORDS
from sim.stock import KIND_CLASS, kinds, own_numbers, starts_from_last

# Contacts that there is room for at first, and over those that there are.
_ROOM, _SPARE = 16, 2


class Notes:
    """What all structures of a space share; `look` makes it that of a space.

    Attributes
    ----------
    table : (n,) int64
        As the kernels know it.
    loose : (bodies, words) float
        Their rows.
    stock : list of array
        Numbers of Chipmunk's own constraints, as they are now.
    """

    def __init__(self) -> None:
        self.table = np.zeros(at.NOTES_WORDS, dtype=np.int64)
        self.table[[at.STAMP, at.ENDED, at.LOOKED, at.BOUND]] = -1
        self._kinds, self._ties = kinds(), np.zeros((0, TIE_WORDS), np.int64)
        self.table[[at.KINDS, at.KINDS_COUNT]] = self._kinds.ctypes.data, len(self._kinds)
        self.loose = np.zeros((0, at.LOOSE_WORDS))
        self.stock: list[np.ndarray] = []
        self._own, self._numbers, self._contacts = (
            np.zeros((0, 2), np.int64),
            np.zeros(0),
            np.zeros((0, at.CONTACT_ROW)),
        )
        self._lists: list[np.ndarray] = []

    def look(self, space: pymunk.Space) -> None:
        """Look through ``space``, in a step that has begun; what was noted of bodies in the last one stays."""
        table, known = self.table, {int(row[0].view(np.int64)): row for row in self.loose}
        table[at.LOOKED] = chipmunk.steps_begun(space)
        self._lists = [chipmunk.listed(space, which).copy() for which in (MOVING_BODIES, CONSTRAINTS_OF_SPACE)]
        table[at.LISTS : at.LISTS + 2] = [one.ctypes.data for one in self._lists]
        table[at.LENGTHS : at.LENGTHS + 2] = [len(one) for one in self._lists]
        joints = [c for c in space.constraints if isinstance(c, DuctileJoint)]
        joined = {
            chipmunk.body_address(body)
            for joint in joints
            for body in (joint.a, joint.b)
            if body.body_type == pymunk.Body.DYNAMIC
        }
        addresses = [one for one in self._lists[0].tolist() if one not in joined]
        self.loose = np.full((len(addresses), at.LOOSE_WORDS), np.nan)
        for row, one in zip(self.loose, addresses, strict=True):
            row[:] = known.get(one, row)
        self.loose[:, 0].view(np.int64)[:] = addresses
        others = [c for c in space.constraints if starts_from_last(c)]
        self.stock = [own_numbers(c) for c in others]
        own = [
            (chipmunk.address(c._constraint) + 8 * CONTROL, len(one)) for c, one in zip(others, self.stock, strict=True)
        ]
        before, self._own = self._own, np.array(own, dtype=np.int64).reshape(-1, at.STOCK_WORDS)
        if not np.array_equal(self._own, before):
            self._numbers = np.zeros(sum(map(len, self.stock)))
        own_joints = {chipmunk.address(joint._constraint) for joint in joints}
        ties = [(place, one) for place, one in enumerate(self._lists[1].tolist()) if one not in own_joints]
        self._ties = np.zeros((len(ties), TIE_WORDS), dtype=np.int64)
        self._ties[:, [PLACE, CONSTRAINT]] = np.array(ties, dtype=np.int64).reshape(-1, 2)
        self._ties[:, KIND] = [self._kind_of(one) for _, one in ties]
        table[[at.TIES, at.TIES_COUNT]] = self._ties.ctypes.data, len(ties)
        arbiters = chipmunk.listed(space, ARBITERS_OF_SPACE).tolist()
        count = sum(len(chipmunk.contacts_of(arbiter)) for arbiter in arbiters)
        begun = self.contacts
        self._contacts = np.zeros((_ROOM + _SPARE * max(count, len(begun)), at.CONTACT_ROW))
        self._contacts[: len(begun)] = begun
        table[[at.LOOSE, at.LOOSE_COUNT]] = self.loose.ctypes.data, len(self.loose)
        table[[at.STOCK, at.STOCK_COUNT, at.STOCK_NUMBERS]] = (
            self._own.ctypes.data,
            len(self._own),
            self._numbers.ctypes.data,
        )
        table[[at.CONTACTS, at.CONTACTS_ROOM]] = self._contacts.ctypes.data, len(self._contacts)

    def outdate(self) -> None:
        """Have the space looked through in the next step, whatever it has then."""
        self.table[at.LENGTHS] = -1

    def _kind_of(self, constraint: int) -> int:
        """Where the row of the kind of one of Chipmunk's own constraints is, or 0."""
        functions = int(chipmunk.words(constraint, 1, np.int64)[CONSTRAINT_CLASS])
        same = np.flatnonzero(self._kinds[:, KIND_CLASS] == functions)
        return self._kinds.ctypes.data + int(same[0]) * self._kinds.strides[0] if len(same) else 0

    @property
    def numbers(self) -> list[np.ndarray]:
        """Numbers of Chipmunk's own constraints when the step began."""
        return np.split(self._numbers, np.cumsum([len(one) for one in self.stock])[:-1]) if self.stock else []

    @property
    def contacts(self) -> np.ndarray:
        """Rows of the contacts that were noted."""
        return self._contacts[: self.table[at.CONTACTS_COUNT]]


_of_spaces: weakref.WeakKeyDictionary[pymunk.Space, Notes] = weakref.WeakKeyDictionary()


def notes_known(space: pymunk.Space) -> Notes | None:
    """Those of ``space`` as its last step left them, if a structure has ever taken any."""
    return _of_spaces.get(space)


def notes_of(space: pymunk.Space) -> Notes:
    """Those of ``space``, as they are; new ones know nothing of it yet."""
    return _of_spaces.setdefault(space, Notes())
