"""Structures: joints that share bodies, and the memory in which they are solved together."""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Sequence
from weakref import WeakValueDictionary

import numpy as np
import pymunk

from sim import chipmunk
from sim.joint import DuctileJoint
from sim.kernels import layout as at
from sim.kernels.contacts import PLACE_WORDS, TOUCH_WORDS, hash_table
from sim.laws import Law
from sim.ordering import minimum_degree

_TOLERANCE = 1e-9
# Points of contact that a new structure has room for; more is made when needed.
_ROOM = 8


class SolverError(RuntimeError):
    """A step that was refused."""


class Structure:
    """Joints that are solved as one; views of what they bear, as arrays over the joints.

    Made by itself in the first step of a space (see `DuctileJoint.structure`), or from joints at hand to have the
    arrays before.

    Parameters
    ----------
    joints : sequence of DuctileJoint
        At least one; those that already were in a structure keep their plastic state.
    tolerance : float
        Newton's method ends when the residual impulses, as velocities, are below this share of the bodies' own.

    Raises
    ------
    ValueError
        When there is no joint, or the joints do not have the same time integration.
    """

    def __init__(self, joints: Sequence[DuctileJoint], tolerance: float = _TOLERANCE) -> None:
        if not joints:
            raise ValueError("a structure needs at least one joint")
        if len({joint.scheme for joint in joints}) > 1:
            raise ValueError("the joints of a structure must have the same time integration scheme")
        self.joints = tuple(joints)
        bodies = list(dict.fromkeys(body for joint in self.joints for body in (joint.a, joint.b)))
        moving = [body for body in bodies if body.body_type == pymunk.Body.DYNAMIC]
        held = [body for body in bodies if body.body_type != pymunk.Body.DYNAMIC]
        index = {body: i for i, body in enumerate(moving)}
        pairs = [(index[j.a], index[j.b]) for j in self.joints if j.a in index and j.b in index]
        self._pattern = minimum_degree(len(moving), pairs)
        #: Bodies of the structure: dynamic ones in order of elimination, then the others.
        self.bodies = tuple([moving[i] for i in self._pattern.order] + held)
        self._lay_out(len(moving), tolerance)
        self._take_over()

    def _lay_out(self, moving: int, tolerance: float) -> None:
        """All memory that the kernels work on, and the control table that points to it."""
        n, joints, pattern = len(self.joints), self.joints, self._pattern
        index = {body: i for i, body in enumerate(self.bodies)}
        ends = np.array([[index[j.a], index[j.b]] for j in joints], dtype=np.int64)
        slots = [pattern.slot(max(e), min(e)) if max(e) < moving else -1 for e in ends.tolist()]
        parameters = [np.ascontiguousarray(j.law.parameters(), dtype=float) for j in joints]
        states = [np.ascontiguousarray(j.law.state(), dtype=float) for j in joints]
        self._parameters, self._parameter_ends = _joined(parameters)
        self._states, self._state_ends = _joined(states)
        laws = np.empty((n, 5), dtype=np.int64)
        laws[:, 0] = [j.law.respond_address for j in joints]
        laws[:, 1] = [j.law.commit_address for j in joints]
        laws[:, 2] = self._parameters.ctypes.data + 8 * self._parameter_ends[:-1]
        laws[:, 3] = self._states.ctypes.data + 8 * self._state_ends[:-1]
        laws[:, 4] = np.diff(self._state_ends)
        limits = [(j.limits.elongation, j.limits.slip, j.limits.rotation, j.limits.compression_counts) for j in joints]
        below = len(pattern.column_rows)
        keys, values = hash_table([chipmunk.body_address(body) for body in self.bodies])
        self._settings = np.zeros(at.SETTINGS_WORDS)
        self._settings[[at.BETA, at.DELTA]] = joints[0].scheme
        self._settings[at.TOLERANCE] = tolerance**2
        self._result = np.zeros((n, at.RESULT_WORDS))
        self._active = np.ones(n, dtype=np.int64)
        self._arrays: dict[int, np.ndarray] = {
            at.BODY_AT: np.array([chipmunk.body_address(body) for body in self.bodies], dtype=np.int64),
            at.JOINT_AT: np.array([chipmunk.address(j._constraint) for j in joints], dtype=np.int64),
            at.JOINT_BODIES: ends,
            at.GEOMETRY: np.array([j.geometry for j in joints]),
            at.LAWS: laws,
            at.STIFFNESS: np.array([j.law.elastic_tangent() for j in joints]),
            at.DAMPING: np.array([j.damping for j in joints], dtype=float),
            at.LIMITS: np.array(limits, dtype=float),
            at.SCALE: np.ones(n),
            at.SCRATCH: np.zeros(laws[:, 4].max()),
            at.ACTIVE: self._active,
            at.COLUMN_START: pattern.column_start,
            at.COLUMN_ROWS: pattern.column_rows,
            at.FILL_TARGETS: np.append(pattern.fill_targets, 0),
            at.JOINT_SLOT: np.array(slots, dtype=np.int64),
            at.SETTINGS: self._settings,
            at.JACOBIAN: np.zeros((n, 18)),
            at.DEFORMATION: np.zeros((n, 3)),
            at.LIGHTNESS: np.zeros((n, 3)),
            at.IMPULSE: np.zeros((n, 3)),
            at.RESIDUAL: np.zeros((n, 3)),
            at.SLOPE: np.zeros((n, 3)),
            at.RESPONSE: np.zeros((n, at.RESPONSE_WORDS)),
            at.VELOCITY: np.zeros((len(self.bodies), 3)),
            at.START_VELOCITY: np.zeros((len(self.bodies), 3)),
            at.LAST_VELOCITY: np.zeros((len(self.bodies), 3)),
            at.SOLUTION: np.zeros((len(self.bodies), 3)),
            at.DIAGONAL: np.zeros((moving, 9)),
            at.LOWER_BLOCKS: np.zeros((below, 9)),
            at.SCALED_BLOCKS: np.zeros((below, 9)),
            at.RESULT: self._result,
            at.PATTERN: np.zeros((len(self.bodies), 3)),
            at.IMAGE: np.zeros((len(self.bodies), 3)),
            at.BODY_KEYS: keys,
            at.BODY_VALUES: values,
        }
        self._control = np.zeros(at.CONTROL_WORDS, dtype=np.int64)
        self._control[[at.BODIES, at.MOVING, at.JOINTS, at.LOWER]] = len(self.bodies), moving, n, below
        self._control[at.FAULT] = -1
        self._control[at.BREAKABLE] = int(np.isfinite(self._arrays[at.LIMITS][:, :3]).any())
        self._control[at.NOTICE] = int(ctypes.cast(_notice, ctypes.c_void_p).value or 0)
        self._control[at.KEY] = next(_keys)
        _structures[int(self._control[at.KEY])] = self
        self._control[at.HASH_LENGTH] = len(keys)
        for word, array in self._arrays.items():
            self._control[word] = array.ctypes.data
        self._make_room(_ROOM)

    def _make_room(self, contacts: int) -> None:
        """Memory for so many points of contact."""
        new = {
            at.PLACES: np.zeros((contacts, PLACE_WORDS), dtype=np.int64),
            at.TOUCHES: np.zeros((contacts, TOUCH_WORDS)),
            at.OPERATOR: np.zeros((2 * contacts, 2 * contacts)),
            at.CONTACT_VELOCITY: np.zeros(2 * contacts),
            at.CONTACT_CHANGE: np.zeros(2 * contacts),
        }
        self._arrays |= new
        for word, array in new.items():
            self._control[word] = array.ctypes.data
        self._control[at.ROOM] = contacts

    def _take_over(self) -> None:
        """Make the joints this structure's, with the plastic state they had in another.

        Bodies that were in another structure, or are joined to one or to a kinematic body, keep moving as they do; a
        structure that is new and tied to the world at most begins to move with its first step.
        """
        moved = {
            body: old._arrays[at.LAST_VELOCITY][i]
            for old in {joint.structure for joint in self.joints if joint.structure is not None}
            for i, body in enumerate(old.bodies)
        }
        if moved or any(body.body_type == pymunk.Body.KINEMATIC for body in self.bodies):
            for i, body in enumerate(self.bodies):
                present = (*body.velocity, body.angular_velocity)
                self._arrays[at.LAST_VELOCITY][i] = moved.get(body, present)
        for i, joint in enumerate(self.joints):
            old = joint.structure
            if old is not None:
                k = joint.index
                self._result[i] = old._result[k]
                self._active[i] = old._active[k]
                first, last = old._state_ends[k : k + 2]
                self._states[self._state_ends[i] : self._state_ends[i + 1]] = old._states[first:last]
            joint.join(self, i)
            chipmunk.assign(joint._constraint, self._control, i)

    def change_law(self, joint: int, law: Law) -> None:
        """Give a joint new numbers for the law it has; its plastic state stays.

        Raises
        ------
        ValueError
            When ``law`` is of another kind or size.
        """
        values = law.parameters()
        first, last = self._parameter_ends[joint : joint + 2] if joint >= 0 else self._parameter_ends[joint - 1 :][:2]
        if type(law) is not type(self.joints[joint].law) or len(values) != last - first:
            raise ValueError(f"joint {joint} has a law of another kind or size")
        self._parameters[first:last] = values
        self._arrays[at.STIFFNESS][joint] = law.elastic_tangent()
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
        self._arrays[at.PATTERN][:] = pattern
        self._settings[at.SPREAD_STIFFNESS] = stiffness
        self._settings[at.SPREAD_GAP] = gap
        self._control[at.SPREAD] = 1

    @property
    def pattern_response(self) -> np.ndarray:
        """Change of the bodies' velocities for a unit impulse of the driven pattern, joints included, (bodies, 3)."""
        return self._arrays[at.IMAGE].copy()

    @property
    def load_factor(self) -> float:
        """Load factor of the driven pattern in the last step [-]."""
        return float(self._settings[at.SPREAD_IMPULSE] / self._settings[at.STEP])

    @property
    def scheme(self) -> tuple[float, float]:
        """β and δ of the time integration; may be changed between steps."""
        beta, delta = self._settings[[at.BETA, at.DELTA]].tolist()
        return beta, delta

    @scheme.setter
    def scheme(self, scheme: tuple[float, float]) -> None:
        self._settings[[at.BETA, at.DELTA]] = scheme
        for joint in self.joints:
            joint.scheme = scheme

    @property
    def deformation(self) -> np.ndarray:
        """Extension, slip and rotation of each joint at the end of the last step, (n, 3) [m, m, rad]."""
        return self._result[:, 0:3].copy()

    @property
    def force(self) -> np.ndarray:
        """N, Q and M that each joint bore in the last step, (n, 3) [N, N, N m]; signs as in `scene`."""
        return self._result[:, at.RESULT_FORCE : at.RESULT_FORCE + 3].copy()

    @property
    def utilisation(self) -> np.ndarray:
        """|N| / N_max, |Q| / Q_max and |M| / M_max of each joint in the last step, (n, 3); 0 without a limit."""
        capacities = np.array([joint.law.capacities() for joint in self.joints])
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.abs(self.force) / capacities
        return np.where((capacities > 0.0) & self.active[:, None], share, 0.0)

    @property
    def plastic_deformation(self) -> np.ndarray:
        """Plastic elongation, shortening, slip and rotation, each summed without sign, (n, 4) [m, m, m, rad]."""
        return self._result[:, at.RESULT_PLASTIC : at.RESULT_PLASTIC + 4].copy()

    @property
    def elastic_deformation(self) -> np.ndarray:
        """Deformation that the force explains without viscous damping, (n, 3) [m, m, rad]; 0 in a broken joint."""
        upper, damping = self._arrays[at.STIFFNESS], self._arrays[at.DAMPING]
        rates = np.array([joint.rate() for joint in self.joints]) if damping.any() else np.zeros((len(upper), 3))
        # Where a joint has no stiffness it has no force either.
        stiffness = upper[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
        elastic: np.ndarray = np.linalg.pinv(stiffness, hermitian=True) @ (self.force - damping * rates)[:, :, None]
        return np.where(self.active[:, None], elastic[:, :, 0], 0.0)

    @property
    def yielding(self) -> np.ndarray:
        """Whether the axial, shear and rotational part of each joint gave way in the last step, (n, 3) bool."""
        reach = self._settings[at.STEP] * (self._settings[at.BETA] + self._settings[at.DELTA])
        viscous = self._arrays[at.DAMPING] / reach if reach > 0.0 else 0.0
        tangent = self._arrays[at.RESPONSE][:, [at.TANGENT, at.TANGENT + 3, at.TANGENT + 5]] - viscous
        elastic = self._arrays[at.STIFFNESS][:, [0, 3, 5]]
        yields: np.ndarray = (tangent < (1.0 - 1e-9) * elastic) & self.active[:, None] & (reach > 0.0)
        return yields

    @property
    def elastic_energy(self) -> np.ndarray:
        """Elastic energy in each joint, (n,) [J]."""
        return self._result[:, at.RESULT_ELASTIC].copy()

    @property
    def dissipated(self) -> np.ndarray:
        """Plastic work done in each joint so far, (n,) [J]; with what was stored in it when it broke."""
        return self._result[:, at.RESULT_DISSIPATED].copy()

    @property
    def viscous_work(self) -> np.ndarray:
        """Work done against viscous damping in each joint so far, (n,) [J]."""
        return self._result[:, at.RESULT_VISCOUS].copy()

    @property
    def capacity_used(self) -> np.ndarray:
        """Share of each joint's plastic capacity used, (n,), 1 when broken."""
        return self._result[:, at.RESULT_USED].copy()

    @property
    def active(self) -> np.ndarray:
        """Whether each joint still holds, (n,) bool; not when it is broken or was taken out of the space."""
        return self._active.astype(bool)

    @property
    def residual(self) -> float:
        """Residual impulses of the last solve, as velocities, as a share of the bodies' own [-]."""
        return float(self._settings[at.LAST_RESIDUAL])

    @property
    def newton_steps(self) -> int:
        """Newton steps taken so far."""
        return int(self._control[at.NEWTON_STEPS])

    @property
    def unconverged(self) -> int:
        """How many solves so far ended above the tolerance."""
        return int(self._control[at.UNCONVERGED])

    def _told(self) -> None:
        """Something happened in a step that the space has not left yet."""
        fault = int(self._control[at.FAULT])
        if fault >= 0:
            self._control[at.FAULT] = -1
            joint = self.joints[fault]
            x, y = joint.at
            error = SolverError(
                f"the step was refused: the impulse of joint {fault} (made at {x:g}, {y:g}) is not finite; look for a "
                "body that was moved or pushed without bound, or take a shorter step or a lower stiffness"
            )
            _raise_after_step(_space_of(joint), error)
            return
        if self._control[at.MISSED] > 0:
            # Chipmunk solved these by itself in this step; in the next there is room for them.
            self._make_room(2 * int(self._control[at.ROOM] + self._control[at.MISSED]))
        if self._control[at.BROKE] == 0:
            return
        for joint in self.joints:
            if joint.broken and joint.structure is self:
                space = _space_of(joint)
                if joint in space.constraints:
                    space.remove(joint)
                    if joint.on_break is not None:
                        joint.on_break(joint)
            elif joint.structure is self:
                joint.ask_for_structure()


def group(constraint: pymunk.Constraint, space: pymunk.Space) -> None:  # noqa: ARG001
    """Group all ductile joints of ``space`` into structures; those whose company has not changed stay as they are."""
    joints = [c for c in space.constraints if isinstance(c, DuctileJoint) and not c.broken]
    parent: dict[pymunk.Body, pymunk.Body] = {}

    def root(body: pymunk.Body) -> pymunk.Body:
        while parent.setdefault(body, body) is not body:
            parent[body] = parent[parent[body]]
            body = parent[body]
        return body

    for joint in joints:
        ends = [body for body in (joint.a, joint.b) if body.body_type == pymunk.Body.DYNAMIC]
        if len(ends) == 2:
            parent[root(ends[0])] = root(ends[1])
    groups: dict[pymunk.Body, list[DuctileJoint]] = {}
    for joint in joints:
        body = joint.a if joint.a.body_type == pymunk.Body.DYNAMIC else joint.b
        groups.setdefault(root(body), []).append(joint)
    for members in groups.values():
        old = members[0].structure
        if old is not None and set(old.joints) == set(members):
            for joint in members:
                joint.pre_solve = None
        else:
            Structure(members)


_structures: WeakValueDictionary[int, Structure] = WeakValueDictionary()
_keys = itertools.count(1)


def _tell(key: int) -> None:
    _structures[key]._told()


#: `_tell` as a C function, for the kernels to call.
_notice = ctypes.CFUNCTYPE(None, ctypes.c_int64)(_tell)


def _space_of(joint: DuctileJoint) -> pymunk.Space:
    body = joint.a if joint.a.body_type == pymunk.Body.DYNAMIC else joint.b
    assert body.space is not None
    return body.space


def _raise_after_step(space: pymunk.Space, error: Exception) -> None:
    pending = [error]

    def fail(space: pymunk.Space, key: object) -> None:  # noqa: ARG001
        # pymunk does not forget a callback that raises.
        if pending:
            raise pending.pop()

    space.add_post_step_callback(fail, object())


def _joined(pieces: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """All pieces in one array, and where each begins and the last one ends."""
    ends = np.concatenate([[0], np.cumsum([len(piece) for piece in pieces])]).astype(np.int64)
    return np.concatenate(pieces), ends
