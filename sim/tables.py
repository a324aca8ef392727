"""The memory in which a structure is solved: arrays, and the control table that tells the kernels where they lie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymunk

from sim import chipmunk
from sim.abutting import abutting_pairs
from sim.joint import DuctileJoint
from sim.kernels import compiled_callbacks
from sim.kernels import layout as at
from sim.kernels.owners import hash_table
from sim.kernels.refusal import words_to_copy
from sim.ordering import Pattern

# Points of contact that a new structure has room for; more is made when needed.
_ROOM = 8


class Tables:
    """Arrays by their words in the control table, as `sim.kernels.layout` lists them.

    Parameters
    ----------
    joints : sequence of DuctileJoint
    bodies : sequence of pymunk.Body
        In order of elimination, held ones last.
    pattern : Pattern
        Sparsity of the factor over the bodies that are not held.
    tolerance : float
        Of Newton's method, see `Structure`.
    """

    def __init__(
        self, joints: Sequence[DuctileJoint], bodies: Sequence[pymunk.Body], pattern: Pattern, tolerance: float
    ) -> None:
        n, moving, below = len(joints), len(pattern.order), len(pattern.column_rows)
        index = {body: i for i, body in enumerate(bodies)}
        ends = np.array([[index[j.a], index[j.b]] for j in joints], dtype=np.int64)
        slots = [pattern.slot(max(e), min(e)) if max(e) < moving else -1 for e in ends.tolist()]
        # Many joints share a law.
        different = {id(j.law): j.law for j in joints}
        own = {key: (law.parameters(), law.state(), law.elastic_tangent()) for key, law in different.items()}
        parameters, states, tangents = zip(*(own[id(j.law)] for j in joints), strict=True)
        self._parameters, self._parameter_ends = _joined(parameters)
        self._states, self._state_ends = _joined(states)
        laws = np.empty((n, 5), dtype=np.int64)
        laws[:, 0] = [j.law.respond_address for j in joints]
        laws[:, 1] = [j.law.commit_address for j in joints]
        laws[:, 2] = self._parameters.ctypes.data + 8 * self._parameter_ends[:-1]
        laws[:, 3] = self._states.ctypes.data + 8 * self._state_ends[:-1]
        laws[:, 4] = np.diff(self._state_ends)
        limits = [(j.limits.elongation, j.limits.slip, j.limits.rotation, j.limits.compression_counts) for j in joints]
        settings = np.zeros(at.SETTINGS_WORDS)
        settings[[at.BETA, at.DELTA]] = settings[[at.WANTED_BETA, at.WANTED_DELTA]] = joints[0].scheme
        settings[at.TOLERANCE], settings[at.SOFT], settings[at.MOMENT] = tolerance**2, 1.0, np.nan
        abutting = abutting_pairs(joints, bodies)
        keys, values = hash_table([chipmunk.body_address(body) for body in bodies])
        per_joint = (at.DEFORMATION, at.LIGHTNESS, at.IMPULSE, at.RESIDUAL, at.SLOPE)
        velocities = (at.VELOCITY, at.WRITTEN, at.START_VELOCITY, at.LAST_VELOCITY, at.LAST_POSITION, at.BEGUN_AT)
        per_body = (*velocities, at.LAST_FORCE, at.CARRIED, at.EXTERNAL, at.CONTACT_IMPULSE, at.SOLUTION)
        self._arrays: dict[int, np.ndarray] = {}
        #: The control table.
        self.control = np.zeros(at.CONTROL_WORDS, dtype=np.int64)
        self._hold(
            {word: np.zeros((n, 3)) for word in per_joint}
            | {word: np.zeros((len(bodies), 3)) for word in per_body}
            | {
                at.BODY_AT: np.array([chipmunk.body_address(body) for body in bodies], dtype=np.int64),
                at.JOINT_AT: np.array([chipmunk.address(j._constraint) for j in joints], dtype=np.int64),
                at.JOINT_BODIES: ends,
                at.GEOMETRY: np.array([j.geometry for j in joints]),
                at.LAWS: laws,
                at.STIFFNESS: np.array(tangents, dtype=float),
                at.DAMPING: np.array([j.damping for j in joints], dtype=float),
                at.LIMITS: np.array(limits, dtype=float),
                at.SCALE: np.ones(n),
                at.SCRATCH: np.zeros(at.SCRATCH_STATE + laws[:, 4].max()),
                at.ACTIVE: np.full(n, at.UNKNOWN),
                at.COLUMN_START: pattern.column_start,
                at.COLUMN_ROWS: pattern.column_rows,
                at.FILL_TARGETS: np.append(pattern.fill_targets, 0),
                at.JOINT_SLOT: np.array(slots, dtype=np.int64),
                at.SETTINGS: settings,
                at.LEDGER: np.zeros(at.LEDGER_WORDS),
                at.GRADIENT: np.zeros((n, at.GRADIENT_WORDS)),
                at.RESPONSE: np.zeros((n, at.RESPONSE_WORDS)),
                at.WEIGHT: np.zeros((moving, at.WEIGHT_WORDS)),
                at.SHIFT: np.zeros((len(bodies), 6)),
                at.DIAGONAL: np.zeros((moving, 9)),
                at.LOWER_BLOCKS: np.zeros((below, 9)),
                at.COLUMN: np.zeros((np.diff(pattern.column_start).max(initial=0), 9)),
                at.RESULT: np.zeros((n, at.RESULT_WORDS)),
                at.BODY_KEYS: keys,
                at.BODY_VALUES: values,
                at.ABUTTING_PAIRS: np.append(abutting, 0),
            }
        )
        # Where the bodies were before is not known.
        self[at.LAST_POSITION][:] = np.nan
        self.control[[at.BODIES, at.MOVING, at.JOINTS, at.LOWER]] = len(bodies), moving, n, below
        self.control[at.FAULT], self.control[at.NEW] = -1, 1
        self.control[at.OWN_CLASS] = compiled_callbacks().functions.ctypes.data
        self.control[at.DAMPED] = int(self[at.DAMPING].any())
        self.control[at.BREAKABLE] = int(np.isfinite(self[at.LIMITS][:, :3]).any())
        self.control[at.HASH_LENGTH], self.control[at.ABUTTING] = len(keys), len(abutting)
        self.control[at.SHARED] = int(sorted(slot for slot in slots if slot >= 0) != list(range(below)))
        self.make_room(_ROOM)

    def __getitem__(self, word: int) -> np.ndarray:
        return self._arrays[word]

    def _hold(self, arrays: dict[int, np.ndarray]) -> None:
        held = dict(zip(arrays, in_one_block(list(arrays.values())), strict=True))
        self._arrays |= held
        for word, array in held.items():
            self.control[word] = array.ctypes.data

    def make_room(self, contacts: int) -> None:
        """Memory for so many points of contact; what is noted of those there are stays."""
        kinds = (at.PLACES, at.PLACE_WORDS, np.int64), (at.TOUCHES, at.TOUCH_WORDS, float), (at.PUSHES, 4, float)
        arrays = {word: np.zeros((contacts, width), dtype=kind) for word, width, kind in kinds}
        for word, array in arrays.items():
            if word in self._arrays:
                array[: len(self[word])] = self[word][:contacts]
        self._hold(arrays)
        self.control[at.ROOM] = contacts

    def copy_joint(self, other: Tables, own: int, its: int) -> None:
        """All of joint ``its`` of another structure but its law's state, for joint ``own``."""
        for word in _OF_JOINTS:
            self[word][own] = other[word][its]

    def copy_bodies(self, other: Tables, pairs: Sequence[tuple[int, int]]) -> None:
        """Of bodies, by their own index and that in another structure: how and where the last step left them."""
        own, its = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
        for word in _OF_BODIES:
            self[word][own] = other[word][its]

    def make_pattern(self) -> None:
        """Memory for a load pattern, and let it act."""
        if not self.control[at.SPREAD]:
            shape = (int(self.control[at.BODIES]), 3)
            self._hold({at.PATTERN: np.zeros(shape), at.IMAGE: np.zeros(shape)})
            self.control[at.SPREAD] = 1

    def make_copy(self) -> None:
        """Memory for what a step that is taken in parts may have to give back."""
        joints, bodies = int(self.control[at.JOINTS]), int(self.control[at.BODIES])
        self._hold({at.COPY: np.zeros(words_to_copy(joints, bodies, len(self._states)))})

    def parameters(self, joint: int) -> np.ndarray:
        """Parameters of a joint's law, to be changed in place."""
        first, last = self._parameter_ends[joint : joint + 2]
        return self._parameters[first:last]

    def state(self, joint: int) -> np.ndarray:
        """State of a joint's law, to be changed in place."""
        first, last = self._state_ends[joint : joint + 2]
        return self._states[first:last]

    def kept(self) -> dict[str, np.ndarray]:
        """Everything that the next step depends on and that the joints and bodies do not say themselves."""
        words = (*_KEPT, *((at.PATTERN, at.IMAGE) if self.control[at.SPREAD] else ()))
        arrays = {str(word): self[word].copy() for word in words}
        return arrays | {"states": self._states.copy(), "control": self.control[list(_KEPT_CONTROL)].copy()}

    def pushes(self) -> list[tuple[int, np.ndarray]]:
        """Address and pseudo-velocities of each loose body that the last step moved along."""
        rows = self[at.PUSHES][: self.control[at.PUSHED]]
        return [(int(row[:1].view(np.int64)[0]), row[1:].copy()) for row in rows]

    def restore_pushes(self, pushes: list[tuple[int, np.ndarray]]) -> None:
        """Put back what `pushes` gave, with the addresses that the bodies have now."""
        for row, (body, velocities) in zip(self[at.PUSHES], pushes, strict=False):
            row[:1].view(np.int64)[0], row[1:] = body, velocities
        self.control[at.PUSHED] = len(pushes)

    def restore(self, kept: dict[str, np.ndarray]) -> None:
        """Put back what `kept` gave."""
        if str(at.PATTERN) in kept:
            self.make_pattern()
        self._states[:] = kept["states"]
        self.control[list(_KEPT_CONTROL)] = kept["control"]
        self.make_room(int(self.control[at.ROOM]))
        for word, array in self._arrays.items():
            if str(word) in kept:
                array[:] = kept[str(word)]


# The plastic state is kept beside these. Gradient and response of the last step weigh the bodies of the next.
_OF_JOINTS = (at.ACTIVE, at.IMPULSE, at.GRADIENT, at.RESPONSE, at.RESULT, at.DEFORMATION)
_OF_BODIES = (at.LAST_VELOCITY, at.LAST_POSITION, at.LAST_FORCE, at.BEGUN_AT, at.SHIFT)
_OF_FACTOR = (at.DIAGONAL, at.LOWER_BLOCKS)
_KEPT = (*_OF_JOINTS, *_OF_BODIES, *_OF_FACTOR, at.SETTINGS, at.LEDGER)
# How many contacts there were tells a step of another length whether bodies may be moved on, see `sim.kernels.moves`.
_KEPT_CONTROL = (at.NEWTON_STEPS, at.UNCONVERGED, at.FLOWING, at.SHIFTED, at.PARTS, at.ROOM, at.CONTACTS)


# A cache line in words of 8 bytes, and how many lines of distance keep arrays of equal length from lying alike in their
# pages.
_LINE, _APART = 8, 5


def in_one_block(arrays: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Copies of arrays of 8-byte numbers in one block of memory, each beginning with a cache line.

    A large block comes in large pages, which a processor finds its way in without looking pages up; and arrays that all
    begin with a page get in each other's way in its cache.
    """
    starts = np.cumsum([0, *(_LINE * (-(-array.size // _LINE) + _APART) for array in arrays)])
    block = np.zeros(starts[-1] + _LINE)
    block = block[-(block.ctypes.data // 8) % _LINE :]
    copies = []
    for start, array in zip(starts[:-1].tolist(), arrays, strict=True):
        copy = block[start : start + array.size].view(array.dtype).reshape(array.shape)
        copy[...] = array
        copies.append(copy)
    return copies


def _joined(pieces: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """All pieces in one array, and where each begins and the last one ends."""
    ends = np.concatenate([[0], np.cumsum([len(piece) for piece in pieces])]).astype(np.int64)
    return np.concatenate([np.asarray(piece, dtype=float) for piece in pieces]), ends
