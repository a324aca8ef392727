"""The ledger of a whole space: its structures, and the loose bodies beside them."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from sim import chipmunk
from sim.energy import Energy
from sim.joint import DuctileJoint
from sim.joint_watch import JointWatch
from sim.kernels import compiled_callbacks
from sim.kernels.loose import HELD, JOINED, LOOSE, TIED, read, touching
from sim.loose_motion import LooseMotion, motion_of


class LooseLedger:
    """Where the energy of the dynamic bodies goes that no ductile joint holds.

    Reckoned as a structure's is (`sim.kernels.energy`): with the means of the velocities before and after a step, and
    over the parts of one that is taken in parts with a structure. What structures do to loose bodies at contacts is
    external work here, and the same with the other sign there: theirs to the last digit (`sim.kernels.noted`).

    Parameters
    ----------
    space : pymunk.Space
        As it is before a step; the bodies' kinetic energy then counts as given from outside.

    Attributes
    ----------
    energy : Energy
        So far.
    """

    def __init__(self, space: pymunk.Space) -> None:
        self._space = space
        self.energy = Energy()
        self._bodies: list[pymunk.Body] = []
        self._addresses = self._order = np.zeros(0, dtype=np.int64)
        # Addresses, kinds and velocities of bodies after the last step; by arbiter, hash and bodies, contacts' impulses
        # and when.
        self._last = self._addresses, np.zeros(0, dtype=np.int64), np.zeros((0, 3))
        self._impulses: dict[tuple[int, ...], tuple[int, float, float]] = {}
        self._step, self._stamp = 0.0, 0
        # By which a ductile joint is known, once there is one.
        self._functions = 0
        kind, velocity, *_ = self._look()
        # Before the first step Chipmunk does not know yet what will be a structure, and may break within it.
        held = {body for c in space.constraints if isinstance(c, DuctileJoint) for body in (c.a, c.b)}
        joined = np.array([body in held for body in self._bodies], dtype=bool)
        self._last = self._addresses, np.where(joined & (kind != HELD), JOINED, kind), velocity

    def note(self) -> None:
        """Take note of a step."""
        h, last = self._space.current_time_step, self._last
        self._stamp += 1
        kind, now, mass, places, touches = self._look()
        was, start = self._listed_now(last, now)
        loose = (kind == LOOSE) | (kind == TIED)
        stayed = loose & ((was == LOOSE) | (was == TIED))
        moving = np.where(loose[:, None], mass, 0.0)
        gained = 0.5 * np.sum(moving * (now - start) * (now + start), axis=1)
        motion = motion_of(self._space, self._addresses, self._order, start, now)
        weight = motion.given + np.sum(moving[:, :2] * motion.way[:, :2] * self._space.gravity, axis=1)
        # What came off a structure in this step was in it when it was struck.
        struck = np.where(was == JOINED, JOINED, kind)
        by_contacts, by_others, lost = self._contacts(struck, motion, places, touches, h)
        by_structures = np.where(stayed, motion.by_structures, 0.0)
        by_contacts, lost = by_contacts + by_structures, lost + float(motion.lost.sum())
        by_others += float(by_structures.sum() + motion.lost.sum())
        # All that changed a body's motion beside its weight and contacts.
        rest = np.where(stayed, gained - weight - by_contacts, 0.0)
        tied = kind == TIED
        kinetic = 0.5 * float(np.sum(moving * now**2))
        # Bodies that came off a structure, or into the space, bring their energy, and those that went take theirs.
        came = kinetic - self.energy.kinetic - float(gained[stayed].sum())
        external = float(weight[stayed].sum() + rest[~tied].sum()) + by_others + came
        self.energy += Energy(
            external=external, kinetic=kinetic - self.energy.kinetic, contact=lost, stock=-float(rest[tied].sum())
        )
        self._step = h

    def _look(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Kinds, velocities and masses of the bodies, and their contacts, which are kept for the next step."""
        bodies = list(self._space.bodies)
        if bodies != self._bodies:
            self._bodies = bodies
            self._addresses = np.array([chipmunk.body_address(body) for body in bodies], dtype=np.int64)
            self._order = np.argsort(self._addresses)
        if self._functions == 0 and any(isinstance(c, DuctileJoint) for c in self._space.constraints):
            self._functions = compiled_callbacks().functions.ctypes.data
        kind, velocity, mass = read(self._addresses, self._functions)
        self._last = self._addresses, kind, velocity
        return kind, velocity, mass, *touching(self._addresses, self._order, kind)

    def _listed_now(
        self, last: tuple[np.ndarray, np.ndarray, np.ndarray], now: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Kinds and velocities after the last step, in today's order; new bodies count as joined, as fast as now."""
        addresses, kind, velocity = last
        if addresses is self._addresses:
            return kind, velocity
        row = {address: i for i, address in enumerate(addresses.tolist())}
        at = np.array([row.get(address, len(row)) for address in self._addresses.tolist()], dtype=np.int64)
        new = at == len(row)
        kinds, velocities = np.append(kind, JOINED)[at], np.vstack([velocity, np.zeros(3)])[at]
        return kinds, np.where(new[:, None], now, velocities)

    def _contacts(
        self, kind: np.ndarray, motion: LooseMotion, places: np.ndarray, touches: np.ndarray, h: float
    ) -> tuple[np.ndarray, float, float]:
        """Work of contacts on each loose body, of held bodies, and what was lost; but for those with structures."""
        work, by_others, lost = np.zeros(len(kind)), 0.0, 0.0
        ratio = h / self._step if self._step > 0.0 else 1.0
        kept, self._impulses = self._impulses, {}
        in_parts = (motion.mean != motion.last).any(axis=1)
        for (arbiter, hashed, a, b, first, where), (nx, ny, ax, ay, bx, by, jn, jt) in zip(
            places.tolist(), touches.tolist(), strict=True
        ):
            # Chipmunk uses an arbiter again for other shapes.
            key = arbiter, hashed, *(int(self._addresses[i]) if i >= 0 else -1 for i in (a, b))
            self._impulses[key] = self._stamp, jn, jt
            if JOINED in (kind[i] for i in (a, b) if i >= 0) or math.isnan(motion.begun.get(where, (0.0, 0.0))[0]):
                continue
            # What a contact keeps has the last steps' impulse in it, of which Chipmunk has applied a share.
            share = 0.0 if first else ratio
            early, late = (jn, jt), (0.0, 0.0)
            if share != 1.0 and key in kept:
                _, kn, kt = kept[key]
                early = jn + (share - 1.0) * kn, jt + (share - 1.0) * kt
            if any(i >= 0 and in_parts[i] for i in (a, b)):
                late = jn - motion.begun[where][0], jt - motion.begun[where][1]
                early = early[0] - late[0], early[1] - late[1]
            for velocity, (n, t) in ((motion.mean, early), (motion.last, late)):
                x, y = n * nx - t * ny, n * ny + t * nx
                for i, rx, ry, sign in ((a, ax, ay, -1.0), (b, bx, by, 1.0)):
                    u, v, w = velocity[i].tolist() if i >= 0 else (0.0, 0.0, 0.0)
                    done = sign * (x * (u - w * ry) + y * (v + w * rx))
                    lost -= done
                    if i >= 0 and kind[i] in (LOOSE, TIED):
                        work[i] += done
                    else:
                        by_others -= done
        # Chipmunk keeps contacts for some steps in which shapes do not touch.
        oldest = self._stamp - self._space.collision_persistence
        self._impulses = {key: one for key, one in kept.items() if one[0] > oldest} | self._impulses
        return work, by_others, lost


class SystemLedger:
    """Where the energy of a space goes: that of all structures there are or were, and of the loose bodies.

    Parameters
    ----------
    space : pymunk.Space
        As it is before a step.
    joints : JointWatch, optional
        One that is kept up to date already.
    """

    def __init__(self, space: pymunk.Space, joints: JointWatch | None = None) -> None:
        self._own = joints is None
        self._joints = JointWatch(space) if joints is None else joints
        self._loose = LooseLedger(space)
        if self._own:
            self._joints.note()

    def __getstate__(self) -> None:
        raise TypeError("a SystemLedger cannot be saved or copied; make one of the resumed space, which begins anew")

    def note(self) -> None:
        """Take note of a step; to be called after each."""
        if self._own:
            self._joints.note()
        self._loose.note()

    @property
    def energy(self) -> Energy:
        """So far [J]; ``external`` is the sum of all the others, to rounding."""
        return self._joints.ledger() + self._loose.energy
