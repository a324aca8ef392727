"""How loose bodies have gone through a step, and what structures did to them in it, for a ledger."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pymunk

from sim.chipmunk import steps_begun
from sim.kernels import noted
from sim.noted import notes_known


class LooseMotion(NamedTuple):
    """Rows for bodies; for those that structures took along in parts of the step, as they have noted.

    Attributes
    ----------
    way : (n, 3) float
        Along which forces act [m, rad].
    given : (n,) float
        Energy that came with going back to when something touched [J].
    by_structures : (n,) float
        Work of contacts that were solved with structures [J].
    mean, last : (n, 3) float
        Mean velocities in the step, and in its last part.
    lost : (n,) float
        By those of them that loose bodies have with each other and with held ones [J].
    begun : dict
        By their addresses, normal and tangential impulses of contacts before the parts; no numbers for those that went
        through them.
    """

    way: np.ndarray
    given: np.ndarray
    by_structures: np.ndarray
    mean: np.ndarray
    last: np.ndarray
    lost: np.ndarray
    begun: dict[int, tuple[float, float]]


def motion_of(
    space: pymunk.Space, addresses: np.ndarray, order: np.ndarray, start: np.ndarray, now: np.ndarray
) -> LooseMotion:
    """That of the bodies at ``addresses``, sorted by ``order``, in the step that ended, with these velocities."""
    n, mean = len(now), 0.5 * (start + now)
    motion = LooseMotion(space.current_time_step * mean, np.zeros(n), np.zeros(n), mean, mean.copy(), np.zeros(n), {})
    notes = notes_known(space)
    if notes is None or not n:
        return motion
    stamp, rows = steps_begun(space), notes.loose
    rows = rows[(rows[:, noted.WORKED] == stamp) | (rows[:, noted.IN_PARTS] == stamp)]
    of = order[np.searchsorted(addresses, rows[:, 0].copy().view(np.int64), sorter=order)]
    worked, parts = rows[:, noted.WORKED] == stamp, rows[:, noted.IN_PARTS] == stamp
    motion.by_structures[of[worked]], motion.lost[of[worked]] = rows[worked, noted.WORK], rows[worked, noted.LOST]
    of, rows = of[parts], rows[parts]
    motion.way[of], motion.given[of] = rows[:, noted.WAY : noted.WAY + 3], rows[:, noted.GIVEN]
    motion.mean[of] = motion.way[of] / rows[:, [noted.SPAN]]
    motion.last[of] = 0.5 * (rows[:, noted.LAST : noted.LAST + 3] + now[of])
    if len(of):
        motion.begun.update({int(row[0].view(np.int64)): (float(row[3]), float(row[4])) for row in notes.contacts})
    return motion
