"""How bodies have moved in the structures that they were in, for one that takes their joints over."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
import pymunk

from sim import chipmunk
from sim.body_places import led_aside
from sim.kernels import layout as at

if TYPE_CHECKING:
    from sim.structure import Structure


def steps_begun(bodies: Iterable[pymunk.Body]) -> int:
    """How many steps the space of ``bodies`` has begun."""
    return next((chipmunk.steps_begun(body.space) for body in bodies if body.space is not None), 0)


class Predecessors:
    """Structures that let go of their joints now.

    Parameters
    ----------
    structures : iterable of Structure
        Of the joints. A joint that comes back may have been left in one that others took over long ago.
    now : int
        In which step; see `steps_begun`.

    Attributes
    ----------
    structures : tuple of Structure
    velocity, force, aside : dict of arrays (3,), by body
        With which each moved on, the forces on it from outside, and how far it was led past where its velocity leads.
    """

    def __init__(self, structures: Iterable[Structure], now: int) -> None:
        self.structures = tuple(old for old in structures if not old.superseded or old.left_at == now)
        self.velocity: dict[pymunk.Body, np.ndarray] = {}
        self.force: dict[pymunk.Body, np.ndarray] = {}
        self.aside: dict[pymunk.Body, np.ndarray] = {}
        for old in self.structures:
            stepped, aside, velocities = old.has_stepped, led_aside(old.tables), old.let_go(now)
            if not stepped:
                continue
            # What nothing held any more has moved as it liked.
            held = set(old.tables[at.JOINT_BODIES][old.active].ravel().tolist())
            self.velocity |= {body: velocities[i] for i, body in enumerate(old.bodies) if i in held}
            self.force |= dict(zip(old.bodies, old.tables[at.LAST_FORCE], strict=True))
            self.aside |= dict(zip(old.bodies, aside, strict=True))
