"""What the next step of a space depends on beside its joints, and pymunk does not save.

A space with ductile joints is pickled and copied with it: by the table of `copyreg`, which `pickle` and `copy` ask for
how to take a class apart, so that a user's own classes of spaces are saved alike.
"""

from __future__ import annotations

import copyreg
import weakref
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from sim import chipmunk
from sim.chipmunk import ARBITERS_OF_SPACE, CONSTRAINTS_OF_SPACE, MOVING_BODIES
from sim.collision_tree import CollisionTrees
from sim.contact_graph import ContactGraph
from sim.stock import own_numbers, starts_from_last

if TYPE_CHECKING:
    from sim.structure import Structure

# Of `pickle`: objects are made empty, then given their state.
_PROTOCOL = 2


_looked_after: weakref.WeakSet[pymunk.Space] = weakref.WeakSet()


def look_after(space: pymunk.Space) -> None:
    """Have a space that gets ductile joints saved with its `SpaceState`, solved in one thread, and awake when it goes.

    Bodies and constraints that sleep while Python takes them and their space apart would call on memory that is gone.
    """
    kind = type(space)
    if kind not in copyreg.dispatch_table:
        copyreg.pickle(kind, _take_apart)
    if space not in _looked_after:
        _looked_after.add(space)
        chipmunk.solve_in_one_thread(space)
        weakref.finalize(space, chipmunk.wake_all, space._space)


@dataclass(frozen=True)
class SpaceState:
    """Numbers to the last bit, and everything in the order in which Chipmunk goes through it.

    Attributes
    ----------
    bodies : list of (pymunk.Body, array)
        Transforms, pseudo-velocities and times at rest, too.
    corners : list of (pymunk.Poly, list of points)
        In their order, by which Chipmunk knows points of contact again: a polygon that is made anew begins at any.
    stock : list of (pymunk.Constraint, array)
        Numbers of Chipmunk's own constraints, with their impulses in the last step.
    moving : list of pymunk.Body
        Those that are awake, in order.
    asleep : list of list of pymunk.Body
        Those that sleep, group by group.
    constraints : list of pymunk.Constraint
        Those between bodies that are awake, in order.
    shapes : list of pymunk.Shape
        By which the following know them.
    contacts : ContactGraph
    pushes : list of (Structure, list of (pymunk.Body, array))
        Loose bodies that structures moved along in the last step.
    trees : CollisionTrees
    """

    bodies: list[tuple[pymunk.Body, np.ndarray]]
    corners: list[tuple[pymunk.Poly, list[pymunk.Vec2d]]]
    stock: list[tuple[pymunk.Constraint, np.ndarray]]
    moving: list[pymunk.Body]
    asleep: list[list[pymunk.Body]]
    constraints: list[pymunk.Constraint]
    shapes: list[pymunk.Shape]
    contacts: ContactGraph
    pushes: list[tuple[Structure, list[tuple[pymunk.Body, np.ndarray]]]]
    trees: CollisionTrees

    @classmethod
    def of(cls, space: pymunk.Space) -> SpaceState:
        """State of ``space`` between two steps."""
        bodies, shapes, constraints = [*space.bodies, space.static_body], list(space.shapes), space.constraints
        body_at = {chipmunk.body_address(body): body for body in bodies}
        constraint_at = {chipmunk.address(c._constraint): c for c in constraints}
        return cls(
            [(body, chipmunk.save_body(body)) for body in bodies],
            [(shape, shape.get_vertices()) for shape in shapes if isinstance(shape, pymunk.Poly)],
            [(c, own_numbers(c).copy()) for c in constraints if starts_from_last(c)],
            [body_at[one] for one in chipmunk.listed(space, MOVING_BODIES).tolist()],
            [[body_at[one] for one in group] for group in chipmunk.sleeping_groups(space)],
            [constraint_at[one] for one in chipmunk.listed(space, CONSTRAINTS_OF_SPACE).tolist()],
            shapes,
            ContactGraph.of(space, bodies, shapes),
            _pushes(constraints, body_at),
            CollisionTrees.of(space, shapes),
        )

    def restore(self, space: pymunk.Space) -> None:
        """Put it back to a space that pymunk has restored."""
        for body, numbers in self.bodies:
            chipmunk.restore_body(body, numbers)
        for polygon, corners in self.corners:
            polygon.unsafe_set_vertices(corners)
        for shape in self.shapes:
            shape.cache_bb()
        for constraint, numbers in self.stock:
            own_numbers(constraint)[:] = numbers
        bodies = [body for body, _ in self.bodies]
        touching = self.contacts.restore(space, bodies, self.shapes)
        self._put_to_sleep(space)
        chipmunk.list_anew(space, MOVING_BODIES, [chipmunk.body_address(body) for body in self.moving])
        order = [chipmunk.address(constraint._constraint) for constraint in self.constraints]
        chipmunk.list_anew(space, CONSTRAINTS_OF_SPACE, order)
        chipmunk.list_anew(space, ARBITERS_OF_SPACE, touching)
        for body, numbers in self.bodies:
            chipmunk.restore_body(body, numbers)
        for structure, pushes in self.pushes:
            structure.tables.restore_pushes([(chipmunk.body_address(body), by) for body, by in pushes])
        self.trees.restore(space, self.shapes)
        look_after(space)

    def _put_to_sleep(self, space: pymunk.Space) -> None:
        threshold = space.sleep_time_threshold
        space.sleep_time_threshold = 1.0
        for root, *others in self.asleep:
            root.sleep()
            # Each goes in behind the first.
            for body in reversed(others):
                body.sleep_with_group(root)
        space.sleep_time_threshold = threshold


def _pushes(
    constraints: Iterable[pymunk.Constraint], body_at: dict[int, pymunk.Body]
) -> list[tuple[Structure, list[tuple[pymunk.Body, np.ndarray]]]]:
    from sim.joint import DuctileJoint

    joints = [c for c in constraints if isinstance(c, DuctileJoint)]
    structures = dict.fromkeys(joint.structure for joint in joints if joint.structure is not None)
    return [
        (structure, [(body_at[body], by) for body, by in structure.tables.pushes() if body in body_at])
        for structure in structures
    ]


def _take_apart(space: pymunk.Space) -> Any:
    """As `pickle` would, with the `SpaceState` beside what pymunk saves."""
    from sim.joint import DuctileJoint

    parts = space.__reduce_ex__(_PROTOCOL)
    if space not in _looked_after and not any(isinstance(one, DuctileJoint) for one in space.constraints):
        return parts  # it has no joints, and never had any
    state = parts[2]
    return _empty, (type(space),), (state, SpaceState.of(space))


def _empty(kind: type[pymunk.Space]) -> pymunk.Space:
    """A space that waits for what `_take_apart` gave."""
    return object.__new__(_resuming(kind))  # type: ignore[arg-type]  # a class can be hashed


@cache
def _resuming(kind: type[pymunk.Space]) -> type[pymunk.Space]:
    """A class of spaces that turn into ``kind`` once they have their state."""

    def __setstate__(self: pymunk.Space, state: tuple[Any, SpaceState]) -> None:  # noqa: N807
        self.__class__ = kind
        self.__setstate__(state[0])
        state[1].restore(self)

    return type(kind.__name__, (kind,), {"__setstate__": __setstate__})
