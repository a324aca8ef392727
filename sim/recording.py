"""Recording a run: watching a space, and keeping what it shows at times an even distance apart."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields

import numpy as np
import pymunk
from pymunk import batch

from sim import chipmunk
from sim.energy import Energy
from sim.joint import DuctileJoint
from sim.joint_watch import BROKEN, FORCE, USED, JointWatch
from sim.kernels import layout as at
from sim.outlines import outlines_of
from sim.recorded import BodyKind, Contacts, RecordedBody, RecordedJoint, Recording
from sim.system_ledger import SystemLedger

__all__ = ["Recorder", "Recording"]

# What is asked of all bodies of a space, and of all pairs of them that are in touch.
_FIELDS = batch.BodyFields.BODY_ID | batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY
_BODIES = batch.ArbiterFields.BODY_A_ID | batch.ArbiterFields.BODY_B_ID
# x, y, angle and velocity in a body's memory, in the same order.
_MOTION = [chipmunk.ORIGIN, chipmunk.ORIGIN + 1, chipmunk.ANGLE, chipmunk.VX, chipmunk.VY]
# Share of a step by which a time may be missed and still count as reached.
_ROUNDING = 1e-6
_KINDS: dict[int, BodyKind] = {
    pymunk.Body.STATIC: "static",
    pymunk.Body.KINEMATIC: "kinematic",
    pymunk.Body.DYNAMIC: "dynamic",
}


@dataclass(frozen=True)
class _Sample:
    """One moment: x, y, angle, v_x, v_y of each body known by then; N, Q, M, share used, broken of each joint."""

    time: float
    motion: np.ndarray
    state: np.ndarray
    contacts: np.ndarray
    energy: Energy


class _Seen:
    """A body: its shapes when it was first seen, and its memory.

    Attributes
    ----------
    outlines : tuple of Outline
    fields : (words,) float
        Chipmunk's own.
    row : int
        Its place among the recorded bodies.
    """

    def __init__(self, body: pymunk.Body, row: int) -> None:
        self.row = row
        self.outlines = outlines_of(body)
        location = chipmunk.body_address(body)
        self.fields = chipmunk.words(location, chipmunk.BODY_FULL_WORDS)
        self._lists = chipmunk.words(location, chipmunk.BODY_FULL_WORDS, np.int64)

    @property
    def touches(self) -> bool:
        """Whether another body is in touch."""
        return bool(self._lists[chipmunk.ARBITERS])


class Recorder:
    """Watches a space and samples it.

    Bodies, shapes and joints are found by themselves, also those that are added or removed during the run.

    Parameters
    ----------
    space : pymunk.Space
        As it is before its first step; that moment is the first sample.
    every : float
        Simulated time between two samples [s]; when steps are longer, every step is one.
    labels : mapping from DuctileJoint to str, optional
        What to call joints; others are called by where they were made. Read in the end.

    Raises
    ------
    ValueError
        When ``every`` is not a positive number.
    """

    def __init__(
        self, space: pymunk.Space, every: float = 1.0 / 30.0, labels: Mapping[DuctileJoint, str] | None = None
    ) -> None:
        if not (math.isfinite(every) and every > 0.0):
            raise ValueError(f"a sample every {every} s: name a positive time")
        self._space, self._every = space, every
        self._labels = {} if labels is None else labels
        self._now = self._step = 0.0
        # In the order in which they were first seen.
        self._bodies: dict[pymunk.Body, _Seen] = {}
        # Those in the space, by Chipmunk's numbers, and their rows.
        self._known: dict[int, pymunk.Body] = {}
        self._present, self._rows = np.zeros(0, dtype=np.uintp), np.zeros(0, dtype=int)
        # Those in no space, and how many joints were asked for them.
        self._supports: list[pymunk.Body] = []
        self._held = 0
        self._buffer = batch.Buffer()
        self._joints = JointWatch(space)
        self._ledger = SystemLedger(space, self._joints)
        self._samples: list[_Sample] = []
        self._joints.note()
        self._meet()
        self._keep()

    def sample(self, elapsed: float | None = None) -> None:
        """Note what the space has done; to be called after each step.

        Parameters
        ----------
        elapsed : float, optional
            Simulated time since the last call [s]; that of the space's last step by default.
        """
        step = self._space.current_time_step if elapsed is None else elapsed
        periods_before = math.floor(self._now / self._every + _ROUNDING)
        self._now += step
        self._step = step
        self._joints.note()
        self._ledger.note()
        if math.floor((self._now + _ROUNDING * step) / self._every) > periods_before:
            self._keep()

    def finish(self, title: str = "") -> Recording:
        """Everything that was sampled, up to the last step."""
        if self._samples[-1].time < self._now:
            self._keep()
        samples, bodies, joints = self._samples, list(self._bodies), self._joints.joints
        index = {body: i for i, body in enumerate(bodies)}
        held = {body for joint in joints for body in (joint.a, joint.b)}
        motion = _stacked([sample.motion for sample in samples], len(bodies), math.nan)
        state = _stacked([sample.state for sample in samples], len(joints), 0.0)
        touching = np.concatenate([sample.contacts for sample in samples])
        return Recording(
            title=title,
            time=np.array([sample.time for sample in samples]),
            settings={
                "step": self._step,
                "gravity": self._space.gravity.y,
                "iterations": float(self._space.iterations),
            },
            bodies=tuple(
                RecordedBody(_KINDS[body.body_type], seen.outlines, body in held) for body, seen in self._bodies.items()
            ),
            pose=motion[:, :, :3],
            velocity=motion[:, :, 3:],
            joints=tuple(self._described(i, joint, index) for i, joint in enumerate(joints)),
            force=state[:, :, FORCE],
            capacity_used=state[:, :, USED],
            broken=state[:, :, BROKEN].astype(bool),
            peak=self._joints.peak,
            contacts=Contacts(
                start=np.cumsum([0, *(len(sample.contacts) for sample in samples)]),
                point=touching[:, :2],
                force=touching[:, 2:],
            ),
            energy={
                account.name: np.array([getattr(sample.energy, account.name) for sample in samples])
                for account in fields(Energy)
            },
        )

    def _keep(self) -> None:
        """Keep the present moment."""
        self._buffer.clear()
        batch.get_space_bodies(self._space, _FIELDS, self._buffer)
        present = np.frombuffer(self._buffer.int_buf(), dtype=np.uintp)
        if not np.array_equal(present, self._present):
            self._present = present.copy()
            self._meet()
        self._meet_supports()
        motion = np.full((len(self._bodies), len(_MOTION)), math.nan)
        motion[self._rows] = np.frombuffer(self._buffer.float_buf(), dtype=float).reshape(-1, len(_MOTION))
        for body in (self._space.static_body, *self._supports):
            motion[self._bodies[body].row] = self._bodies[body].fields[_MOTION]
        self._samples.append(
            _Sample(
                time=self._now,
                motion=motion,
                state=self._joints.state(),
                contacts=self._contacts(),
                energy=self._ledger.energy,
            )
        )

    def _meet(self) -> None:
        """Find the rows of the bodies that are in the space now, in Chipmunk's order."""
        # Chipmunk counts the static body in once something is fixed to it.
        self._known = {body.id: body for body in (self._space.static_body, *self._space.bodies)}
        for body in self._known.values():
            if body not in self._bodies:
                self._bodies[body] = _Seen(body, len(self._bodies))
        self._rows = np.array([self._bodies[self._known[i]].row for i in self._present.tolist()], dtype=int)

    def _meet_supports(self) -> None:
        """Find the bodies that are in no space: supports that settle."""
        for joint in self._joints.joints[self._held :]:
            if joint.a.body_type == pymunk.Body.KINEMATIC and joint.a not in self._bodies:
                self._bodies[joint.a] = _Seen(joint.a, len(self._bodies))
                self._supports.append(joint.a)
        self._held = len(self._joints.joints)

    def _contacts(self) -> np.ndarray:
        """Contacts as they are now, (n, 4): point x, y and force x, y."""
        if self._now == 0.0:
            return np.zeros((0, 4))
        self._buffer.clear()
        batch.get_space_arbiters(self._space, _BODIES, self._buffer)
        # Of all arbiters, those that have just parted are among them, too.
        near = dict.fromkeys(np.frombuffer(self._buffer.int_buf(), dtype=np.uintp).tolist())
        touched = [body for i in near if (body := self._known.get(i)) is not None and self._bodies[body].touches]
        touched = [body for body in touched if body.body_type == pymunk.Body.DYNAMIC]
        touched.sort(key=lambda body: self._bodies[body].row)
        contacts = _touching(touched, self._space.current_time_step)
        return np.array(contacts, dtype=float).reshape(-1, 4)

    def _described(self, i: int, joint: DuctileJoint, index: Mapping[pymunk.Body, int]) -> RecordedJoint:
        geometry = joint.geometry
        anchors = [
            np.array(geometry[first : first + 2]) + body.center_of_gravity
            for body, first in ((joint.a, at.ANCHOR_A), (joint.b, at.ANCHOR_B))
        ]
        n, q, m = joint.law.capacities()
        x, y = joint.at
        return RecordedJoint(
            label=self._labels.get(joint, f"joint {i + 1} ({x:.4g} m, {y:.4g} m)"),
            bodies=(index[joint.a], index[joint.b]),
            anchors=np.array(anchors),
            rest=(geometry[at.REST_A], geometry[at.REST_B]),
            turn=geometry[at.TURN],
            maxima=(float(n), float(q), float(m)),
        )


def _touching(bodies: Iterable[pymunk.Body], step: float) -> list[tuple[float, float, float, float]]:
    """Middle of every pair of shapes in touch, and the force on the body that comes first."""
    found: dict[frozenset[pymunk.Shape], tuple[float, float, float, float]] = {}

    def note(arbiter: pymunk.Arbiter) -> None:  # told of each pair as the body at hand meets it
        pair = frozenset(arbiter.shapes)
        points = arbiter.contact_point_set.points
        if pair in found or not points:
            return
        x, y = sum((point.point_a + point.point_b for point in points), pymunk.Vec2d.zero()) / (2 * len(points))
        force = arbiter.total_impulse / step
        found[pair] = (x, y, force.x, force.y)

    for body in bodies:
        body.each_arbiter(note)
    return list(found.values())


def _stacked(samples: list[np.ndarray], count: int, absent: float) -> np.ndarray:
    """Samples one after the other, the earlier ones filled up for what was not there yet."""
    whole = np.full((len(samples), count, samples[0].shape[1]), absent)
    for k, sample in enumerate(samples):
        whole[k, : len(sample)] = sample
    return whole
