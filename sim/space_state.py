"""What the next step of a space depends on beside its joints, and pymunk does not save."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pymunk

from sim import chipmunk


@dataclass(frozen=True)
class SpaceState:
    """Numbers to the last bit.

    Attributes
    ----------
    bodies : list of (pymunk.Body, array)
        Transforms and pseudo-velocities, too.
    corners : list of (pymunk.Poly, list of points)
        In their order, by which Chipmunk knows points of contact again: a polygon that is made anew begins at any.
    impulses : list of (pymunk.Constraint, array)
        Of Chipmunk's own constraints in the last step.
    """

    bodies: list[tuple[pymunk.Body, np.ndarray]]
    corners: list[tuple[pymunk.Poly, list[pymunk.Vec2d]]]
    impulses: list[tuple[pymunk.Constraint, np.ndarray]]

    @classmethod
    def of(cls, bodies: Iterable[pymunk.Body]) -> SpaceState:
        """State of the space that ``bodies`` are in; or of them alone, when they are in none."""
        bodies = list(bodies)
        space = next((body.space for body in bodies if body.space is not None), None)
        shapes, constraints = ([], []) if space is None else (space.shapes, space.constraints)
        return cls(
            [(body, chipmunk.save_body(body)) for body in (bodies if space is None else space.bodies)],
            [(shape, shape.get_vertices()) for shape in shapes if isinstance(shape, pymunk.Poly)],
            [(c, chipmunk.cached_impulse(c).copy()) for c in constraints if type(c) in chipmunk.CACHED_IMPULSE],
        )

    def restore(self) -> None:
        """Put it back."""
        for body, numbers in self.bodies:
            chipmunk.restore_body(body, numbers)
        for shape, corners in self.corners:
            shape.unsafe_set_vertices(corners)
        for constraint, impulse in self.impulses:
            chipmunk.cached_impulse(constraint)[:] = impulse
