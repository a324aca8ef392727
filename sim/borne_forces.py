"""What joints have borne, step by step, where members are cut anew on the way."""

from __future__ import annotations

import itertools

import numpy as np

from sim.joint import DuctileJoint


def forces_on(
    joints: tuple[DuctileJoint, ...], bearing: list[tuple[tuple[DuctileJoint, ...], np.ndarray]]
) -> np.ndarray:
    """N [N], Q [N] and M [N m] of ``joints`` at the start, 0, and after each step, (k + 1, joints, 3).

    Parameters
    ----------
    joints : tuple of DuctileJoint
    bearing : list of (tuple of DuctileJoint, (j, 3) float)
        The joints that there were after each step, with their forces; a joint that was not yet there bore nothing.
    """
    force, column = np.zeros((len(bearing) + 1, len(joints), 3)), {joint: i for i, joint in enumerate(joints)}
    k = 1
    for there, steps in itertools.groupby(bearing, key=lambda step: step[0]):
        own = [(i, column[joint]) for i, joint in enumerate(there) if joint in column]
        rows = np.array([row for _, row in steps])
        force[k : k + len(rows), [c for _, c in own]] = rows[:, [i for i, _ in own]]
        k += len(rows)
    return force
