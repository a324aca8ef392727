"""When bodies first touched something, and how deep they went into it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pymunk


class ContactWatch:
    """Contacts of ``bodies`` with anything that is not one of them.

    Attributes
    ----------
    first : float
        Time of the first contact [s]; nan before it.
    overlap : float
        Greatest depth of a contact as the bodies lie now [m].
    """

    def __init__(self, bodies: Sequence[pymunk.Body]) -> None:
        self._bodies = bodies
        self.first, self.overlap = math.nan, 0.0

    def note(self, time: float) -> None:
        """Look at the contacts of the step that ended; a contact that is new was first at ``time``."""
        depths: list[float] = []
        for body in self._bodies:
            body.each_arbiter(self._look, depths)
        self.overlap = max(depths, default=0.0)
        if depths and math.isnan(self.first):
            self.first = time

    def _look(self, arbiter: pymunk.Arbiter, depths: list[float]) -> None:
        if any(shape.body not in self._bodies for shape in arbiter.shapes):
            depths.extend(-point.distance for point in arbiter.contact_point_set.points)


def is_touching(body: pymunk.Body) -> bool:
    """Whether the body had a contact in the last step."""
    found: list[pymunk.Arbiter] = []
    body.each_arbiter(found.append)
    return bool(found)
