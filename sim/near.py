"""What is near a structure in a step that may be taken in parts: pairs of shapes, and where they come to touch.

Chipmunk's own functions are asked, for copies of the shapes, so that nothing which it keeps of the shapes themselves is
touched. A copy rounded by some more is touched that much sooner, and the same points are nearest: so surfaces are found
before they meet.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
import pymunk

from sim import chipmunk, shape_copies
from sim.first_touch import pass_each_other, rounding
from sim.inner_edges import pass_inner_edges
from sim.joint import DuctileJoint
from sim.kernels import layout as at
from sim.kernels.noted import MATE
from sim.kernels.reached import MOST_LINKED

if TYPE_CHECKING:
    from sim.noted import Notes
    from sim.structure import Structure

# A shape of a structure's, or another one beside it; the other one; how far each reaches from its body's centre [m].
Pair = tuple[pymunk.Shape, pymunk.Shape, float, float]

# Bodies may go so many times as far in a step as the fastest of them does by its velocity.
_FASTER = 2.0
# By how much corners are moved out of line, over how far a shape reaches.
_IN_LINE = 1e-8
# Of a box: left, bottom, right, top.
_OUTWARDS = np.array([-1.0, -1.0, 1.0, 1.0])
# Points of contact of two shapes, at most.
_POINTS = 2


class Surroundings:
    """Pairs of a shape of a structure's and one of another body's that may touch within the step."""

    def __init__(self) -> None:
        self._pairs: list[tuple[pymunk.Shape, pymunk.Shape]] = []
        self._copies: dict[tuple[pymunk.Shape, int], object] = {}
        self._impulses: list[np.ndarray] = []

    def answer(self, structure: Structure, notes: Notes) -> None:
        """Do what the kernels ask for, see `sim.kernels.near`."""
        asked = int(structure.tables.control[at.ASKED])
        if asked == at.GATHER:
            control = structure.tables.control
            index = {body: i for i, body in enumerate(structure.bodies[: int(control[at.MOVING])])}
            self._add(structure, list(_pairs(structure, index)), index)
        elif asked == at.GATHER_BESIDE:
            self._add(structure, list(_pairs_beside(structure, notes)), {})
        elif asked == at.LOOK:
            self._look(structure)
        else:
            # The contacts themselves are read until the next step begins.
            self._pairs, self._copies = [], {}

    def _add(self, structure: Structure, pairs: list[Pair], index: Mapping[pymunk.Body, int]) -> None:
        """Add pairs to those that are listed, and make two contacts of each that are not seen yet."""
        tables = structure.tables
        if tables.control[at.NEAR] == 0:
            # All of an earlier step may have been forgotten within it.
            self._pairs, self._copies, self._impulses = [], {}, []
        self._pairs += [(own, other) for own, other, _, _ in pairs]
        first, count = int(tables.control[at.CONTACTS]), _POINTS * len(pairs)
        if first + count > tables.control[at.ROOM]:
            tables.make_room(first + 2 * count)
        tables.control[at.NEAR] += count
        impulses = np.zeros((count, chipmunk.CONTACT_WORDS))
        self._impulses.append(impulses)
        places, touches = tables[at.PLACES][first : first + count], tables[at.TOUCHES][first : first + count]
        places[:], touches[:] = 0, 0.0
        places[:, at.WHERE] = impulses.ctypes.data + chipmunk.CONTACT_BYTES * np.arange(count)
        touches[:, at.GAP] = at.FAR
        for k, (own, other, *reach) in enumerate(pairs):
            rows = slice(_POINTS * k, _POINTS * (k + 1))
            assert own.body is not None
            assert other.body is not None
            if own.body in index:
                places[rows, at.OWNER_A], places[rows, at.INDEX_A] = tables.control.ctypes.data, index[own.body]
            places[rows, at.BODY_A] = chipmunk.body_address(own.body)
            places[rows, at.BODY_B] = chipmunk.body_address(other.body)
            touches[rows, at.FRICTION] = own.friction * other.friction
            touches[rows, at.RETURN] = own.elasticity * other.elasticity
            touches[rows, at.REACH : at.REACH + 2] = reach
            touches[rows, at.ROUNDED : at.ROUNDED + 2] = rounding(own), rounding(other)
            # What rolls keeps its point where it is below its centre.
            touches[rows, at.MEETING] = 0.5 + 0.5 * (isinstance(other, pymunk.Circle) - isinstance(own, pymunk.Circle))

    def _look(self, structure: Structure) -> None:
        """Find where the surfaces of the pairs are nearest, up to a margin."""
        tables = structure.tables
        margin = float(tables[at.SETTINGS][at.MARGIN])
        # Some may have been forgotten since, but not before the last time.
        count = _POINTS * len(self._pairs)
        first = int(tables.control[at.CONTACTS]) - count
        touches, boxes, centres = tables[at.TOUCHES][first : first + count], {}, {}
        for shape, side in dict.fromkeys((pair[side], side) for pair in self._pairs for side in range(2)):
            if (shape, side) not in self._copies:
                self._copies[shape, side] = shape_copies.copy_of(shape)
            if side == 0:
                shape_copies.grow(shape, self._copies[shape, side], margin)
            assert shape.body is not None
            boxes[shape, side] = shape_copies.bring_up_to_date(self._copies[shape, side])
            centres[shape] = chipmunk.centre_of(shape.body)
        touches[:, at.GAP] = at.FAR
        for k, (own, other) in enumerate(self._pairs):
            if not boxes[own, 0].intersects(boxes[other, 1]):
                continue
            (nx, ny), points = self._nearest(own, other, _IN_LINE * float(touches[_POINTS * k, at.REACH]))
            ux, uy = np.subtract(other.surface_velocity, own.surface_velocity).tolist()
            (x, y), (u, v) = centres[own], centres[other]
            for touch, (ax, ay, bx, by) in zip(touches[_POINTS * k :], points, strict=False):
                ax, ay = ax - margin * nx, ay - margin * ny
                touch[at.NORMAL : at.NORMAL + 2] = nx, ny
                touch[at.ARM_A : at.ARM_A + 2], touch[at.ARM_B : at.ARM_B + 2] = (ax - x, ay - y), (bx - u, by - v)
                touch[at.SURFACE], touch[at.GAP] = -ny * ux + nx * uy, (bx - ax) * nx + (by - ay) * ny
        shapes = [pair for pair in self._pairs for _ in range(_POINTS)]
        pass_inner_edges(shapes, tables[at.PLACES][first : first + count], touches)

    def _nearest(
        self, own: pymunk.Shape, other: pymunk.Shape, enough: float
    ) -> tuple[tuple[float, float], list[tuple[float, float, float, float]]]:
        """As `nearest_points`, which takes a corner for its edge where another lies right in line with that.

        Points that do not face each other tell. So the other shape is moved out of line by next to nothing, ``enough``.
        """
        one, two = self._copies[own, 0], self._copies[other, 1]
        normal, points = shape_copies.nearest_points(one, two)
        if _face(normal, points, enough):
            return normal, points
        assert other.body is not None
        for way in (enough, -enough):
            shape_copies.shift(two, other.body, way * normal[0], way * normal[1])
            there, found = shape_copies.nearest_points(one, two)
            if _face(there, found, 10.0 * enough):
                break
        else:
            there, found = normal, []
        shape_copies.bring_up_to_date(two)
        return there, found


def _face(normal: tuple[float, float], points: list[tuple[float, float, float, float]], most: float) -> bool:
    """Whether points of two shapes face each other along the normal, but for so much."""
    return all(abs((by - ay) * normal[0] - (bx - ax) * normal[1]) <= most for ax, ay, bx, by in points)


def _pairs(structure: Structure, index: Collection[pymunk.Body]) -> Iterator[Pair]:
    """Pairs of shapes whose boxes may overlap within the step, and how far each reaches from its body's centre.

    In an order that does not depend on how they are found.
    """
    shapes = [shape for body in index for shape in sorted(body.shapes, key=_number) if not shape.sensor]
    space = next(iter(index)).space if index else None
    if not shapes or space is None:
        return
    h = float(structure.tables[at.SETTINGS][at.WHOLE_STEP])
    boxes, reaches, speeds = (np.array(column) for column in zip(*map(_extent, shapes), strict=True))
    touching = structure.tables[at.PLACES][: structure.tables.control[at.CONTACTS], [at.BODY_A, at.BODY_B]]
    fastest = max([speeds.max(), *(_speed_at(body) for body in np.unique(touching).tolist())])
    boxes += _FASTER * h * fastest * _OUTWARDS
    around = pymunk.BB(*boxes[:, :2].min(axis=0), *boxes[:, 2:].max(axis=0))
    there = sorted(space.bb_query(around, pymunk.ShapeFilter()), key=_number)
    there = [shape for shape in there if shape.body not in index and not shape.sensor]
    free = {shape.body for shape in there if _is_free(shape.body, index, touching)}
    free |= _linked_beside(there, free, touching)
    others = [(shape, *_extent(shape)) for shape in there if shape.body in free]
    if not others:
        return
    _, their_boxes, their_reaches, their_speeds = zip(*others, strict=True)
    ways = np.array(their_boxes) + _FASTER * h * np.outer(their_speeds, _OUTWARDS)
    meet = (boxes[:, None, :2] <= ways[:, 2:]).all(axis=2) & (ways[:, :2] <= boxes[:, None, 2:]).all(axis=2)
    for i, j in np.argwhere(meet).tolist():
        if _collide(space, shapes[i], others[j][0]):
            yield shapes[i], others[j][0], float(reaches[i]), their_reaches[j]


def _pairs_beside(structure: Structure, notes: Notes) -> Iterator[Pair]:
    """Pairs of a held shape, or of one of a structure's mates, and one of its mates'; as `_pairs`.

    Its mates are the loose bodies that go through the parts with it, see `sim.kernels.beside`.
    """
    marked = notes.loose[notes.loose[:, MATE] == 1.0, 0].copy().view(np.int64).tolist()
    space = next(body.space for body in structure.bodies if body.space is not None)
    mates = {body: marked.index(one) for body in space.bodies if (one := chipmunk.body_address(body)) in marked}
    h = float(structure.tables[at.SETTINGS][at.WHOLE_STEP])
    for body in sorted(mates, key=mates.__getitem__):
        for shape in sorted(body.shapes, key=_number):
            (left, bottom, right, top), reach, speed = _extent(shape)
            way = _FASTER * h * speed
            around = pymunk.BB(left - way, bottom - way, right + way, top + way)
            for other in sorted(space.bb_query(around, pymunk.ShapeFilter()), key=_number):
                assert other.body is not None
                held = other.body.body_type != pymunk.Body.DYNAMIC
                if (
                    (held or mates.get(other.body, -1) > mates[body])
                    and not (shape.sensor or other.sensor)
                    and _collide(space, other, shape)
                ):
                    yield other, shape, _extent(other)[1], reach


def _speed_at(body: int) -> float:
    """How fast the body at an address moves [m/s]."""
    return float(np.hypot(*chipmunk.words(body, chipmunk.BODY_WORDS)[[chipmunk.VX, chipmunk.VY]]))


def _number(shape: pymunk.Shape) -> int:
    return shape._hashid


def _extent(shape: pymunk.Shape) -> tuple[tuple[float, float, float, float], float, float]:
    """Box of a shape, how far it reaches from its body's centre at most [m], and how fast it moves [m/s]."""
    body, box = shape.body, shape.bb
    assert body is not None
    x, y = chipmunk.centre_of(body)
    reach = float(np.hypot(max(x - box.left, box.right - x), max(y - box.bottom, box.top - y)))
    return (box.left, box.bottom, box.right, box.top), reach, abs(body.velocity) + abs(body.angular_velocity) * reach


def _is_free(body: pymunk.Body | None, index: Collection[pymunk.Body], touching: np.ndarray) -> bool:
    """Whether a body may be solved with a structure within a step.

    Of those on constraints the ones at the addresses that are ``touching`` when it begins, and what constraints link to
    them, or to the bodies of its ``index``; for others see `_linked_beside`.
    """
    if body is None or body.is_sleeping:
        return False
    if body.body_type != pymunk.Body.DYNAMIC or not (constraints := chipmunk.constraints_on(body)):
        return True
    for joint in constraints:
        if isinstance(joint, DuctileJoint) and joint.structure is not None:
            control = joint.structure.tables.control
            # That one has listed this one's shapes among its own already, if it was first.
            return not (control[at.NEAR] > 0 or control[at.SPREAD] or joint.structure.whole_steps_only)
    return any(one in index or chipmunk.body_address(one) in touching for one in _linked(body))


def _linked_beside(
    there: Iterable[pymunk.Shape], free: Collection[pymunk.Body | None], touching: np.ndarray
) -> set[pymunk.Body]:
    """Bodies that nothing touches yet, and what constraints link to them: they go through the parts with all of that.

    A vehicle that a structure threw back may meet it again within the step. None, where all would be too many.
    """
    found: set[pymunk.Body] = set()
    for body in {shape.body: None for shape in there if shape.body not in free}:
        if body is None or body in found or body.is_sleeping or body.body_type != pymunk.Body.DYNAMIC:
            continue
        linked = _linked(body)
        if not any(isinstance(joint, DuctileJoint) for one in linked for joint in chipmunk.constraints_on(one)):
            found.update(linked)
    if not found:
        return found
    loose = sum(body is not None and not chipmunk.constraints_on(body) for body in free)
    return found if len(found) + loose + len(np.unique(touching)) <= MOST_LINKED else set()


def _linked(body: pymunk.Body) -> list[pymunk.Body]:
    """A body and all dynamic ones that constraints link to it."""
    found = {body: None}
    for one in (reached := [body]):
        for joint in chipmunk.constraints_on(one):
            for other in () if isinstance(joint, DuctileJoint) else (joint.a, joint.b):
                if other not in found and other.body_type == pymunk.Body.DYNAMIC:
                    found[other] = None
                    reached.append(other)
    return reached


def _collide(space: pymunk.Space, one: pymunk.Shape, other: pymunk.Shape) -> bool:
    """Whether Chipmunk would have two shapes collide, and asks nobody else whether they shall."""
    a, b = one.filter, other.filter
    assert one.body is not None
    assert other.body is not None
    if (a.group == b.group != 0) or not (a.categories & b.mask and b.categories & a.mask):
        return False
    types = one.collision_type, other.collision_type
    kinds = {types, types[::-1], (types[0], None), (types[1], None), (None, None)}
    handlers = [handler for key, handler in space._handlers.items() if key in kinds]
    asks = any(handler.begin is not None or handler.pre_solve is not None for handler in handlers)
    return not asks and not pass_each_other(one.body, other.body)
