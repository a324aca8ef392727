"""Chipmunk's structs: the only file that knows where their fields lie, but for trees and its own constraints.

Those are in `sim.tree_fields` and `sim.stock`.

A Chipmunk constraint is a C struct whose first field points to a table of four functions. `adopt` takes an ordinary
pymunk constraint and gives it a table of our own, so that Chipmunk's solver calls our functions in its place.

Offsets are in 8-byte words, for 64-bit builds of pymunk 7. `sim.installed` holds them against the pymunk that there is.
"""

import math
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib
from pymunk.arbiter import _arbiter_from_dict, _arbiter_to_dict

BODY_WORDS = 23
MASS, MASS_INVERSE = 2, 3
MOMENT, MOMENT_INVERSE = 4, 5
X, Y = 8, 9
VX, VY = 10, 11
FORCE_X, FORCE_Y = 12, 13
ANGLE = 14
SPIN = 15
TORQUE = 16
# The body's transform: cos, sin, -sin, cos of the angle, and where its own origin is.
COSINE, SINE, MINUS_SINE, COSINE_AGAIN, ORIGIN = 17, 18, 19, 20, 21
CENTRE = 6
# Beyond what every kernel reads: pseudo-velocities that take out overlap, and the list of contacts.
BIAS_VX, BIAS_SPIN = 24, 26
BODY_SPACE = 27
ARBITERS, CONSTRAINTS = 29, 30
BODY_FULL_WORDS = 31
# How bodies sleep: the first of those that do so together, the next of them, and for how long one has been at rest.
SLEEP_ROOT, SLEEP_NEXT, IDLE_TIME = 31, 32, 33
SLEEP_WORDS = 34

# cpSpace: gravity, and how much shapes may overlap; lists of bodies that move, of the first ones of those that sleep,
# of constraints and of arbiters; the trees of shapes, static ones first.
SPACE_GRAVITY, SPACE_SLOP = 1, 6
MOVING_BODIES, SLEEPING_ROOTS, CONSTRAINTS_OF_SPACE, ARBITERS_OF_SPACE = 12, 15, 19, 20
SPACE_SHAPES, SPACE_WORDS = 17, 21
# Between them: how many steps there were, the length of the last one, and how many shapes.
SPACE_STAMP, CURRENT_STEP, SPACE_SHAPE_COUNTER = 10, 11, 16
# cpHastySpace, a space with threads: how many, and from how many constraints and contacts on all of them solve.
THREADS, THREADED_FROM, THREADED_WORDS = 71, 73, 74
# cpArray: how many, as half a word; where they are.
LIST_COUNT, LIST_ITEMS, LIST_WORDS = 0, 1, 2

# cpArbiter: the contacts between two shapes.
ARBITER_FRICTION, ARBITER_SURFACE = 1, 2
ARBITER_SHAPE_A, ARBITER_SHAPE_B = 5, 6
ARBITER_BODY_A, ARBITER_BODY_B = 7, 8
ARBITER_NEXT_A, ARBITER_NEXT_B = 9, 11
ARBITER_COUNT, ARBITER_CONTACTS, ARBITER_NORMAL = 13, 14, 15
# Its state is half of this word; `FIRST` where the shapes did not touch in the last step. Chipmunk does not apply the
# impulses again then that the contacts may have kept from some steps ago.
ARBITER_STATE, FIRST = 22, 0
ARBITER_WORDS = 23

# cpShape: the function table, which begins with the kind of shape as half a word; of circles, segments and polygons, in
# this order, the radius by which they are rounded.
SHAPE_CLASS = 0
SHAPE_RADIUS = 28, 36, 24

# cpContact: one point of contact.
CONTACT_R1, CONTACT_R2 = 0, 2
CONTACT_NORMAL_MASS, CONTACT_TANGENT_MASS, CONTACT_BOUNCE = 4, 5, 6
CONTACT_NORMAL_IMPULSE, CONTACT_TANGENT_IMPULSE = 7, 8
CONTACT_BIAS_IMPULSE, CONTACT_BIAS, CONTACT_HASH = 9, 10, 11
CONTACT_WORDS, CONTACT_BYTES = 12, 96

# In cpConstraint: the function table first; the first words past its end belong to the kind of joint, here a pivot
# joint's anchors, which nobody reads once its functions are replaced.
CONSTRAINT_CLASS, CLASS_BYTES = 0, 32
CONSTRAINT_SPACE = 1
CONSTRAINT_BODY_A, CONSTRAINT_BODY_B = 2, 3
CONSTRAINT_NEXT_A, CONSTRAINT_NEXT_B = 4, 5
CONSTRAINT_MAX_FORCE, CONSTRAINT_ERROR_BIAS = 6, 7
# What Chipmunk calls when a step's impulses are final.
POST_SOLVE = 11
CONTROL = 13
CONSTRAINT_WORDS = 15


def address(pointer: object) -> int:
    """A cffi pointer as an integer."""
    return int(ffi.cast("intptr_t", pointer))


def body_address(body: pymunk.Body) -> int:
    """Where a body's struct lies."""
    return address(body._body)


def centre_of(body: pymunk.Body) -> tuple[float, float]:
    """Where a body's centre of gravity is [m]."""
    x, y = words(body_address(body), BODY_WORDS)[X : Y + 1].tolist()
    return x, y


def words(location: int, count: int, kind: type = np.float64) -> np.ndarray:
    """``count`` 8-byte words at ``location`` as an array that shares the memory."""
    return np.frombuffer(ffi.buffer(ffi.cast("char *", location), 8 * count), dtype=kind)


def pivot(a: pymunk.Body, b: pymunk.Body) -> object:
    """A new cpConstraint of Chipmunk's own between two bodies, for `adopt`."""
    return lib.cpPivotJointNew2(a._body, b._body, (0.0, 0.0), (0.0, 0.0))


def adopt(constraint: object, functions: np.ndarray) -> None:
    """Make Chipmunk call ``functions`` for ``constraint``; `assign` must have given it something to work on by then.

    Parameters
    ----------
    constraint : cffi pointer
        From `pivot`.
    functions : int64
        Addresses of preStep, applyCachedImpulse, applyImpulse and getImpulse; must outlive the constraint.
    """
    words(address(constraint), 1, np.int64)[CONSTRAINT_CLASS] = functions.ctypes.data


def assign(constraint: object, control: np.ndarray, index: int) -> None:
    """Give a constraint's functions their control table, which must outlive it, and its place in that."""
    words(address(constraint), CONTROL + 2, np.int64)[CONTROL:] = control.ctypes.data, index


def call_before_step(constraint: object) -> None:
    """Have a constraint's `pre_solve` called with the space that what moves of it is in, or None.

    pymunk's own way is the space of its first body, and a static one need not be in any.
    """
    lib.cpConstraintSetPreSolveFunc(constraint, _before_step)


@ffi.callback("cpConstraintPreSolveFunc")  # type: ignore[untyped-decorator]
def _before_step(constraint: object, space: object) -> None:  # noqa: ARG001
    own = ffi.from_handle(lib.cpConstraintGetUserData(constraint))
    spaces = (body.space for body in (own.a, own.b) if body.body_type == pymunk.Body.DYNAMIC)
    own.pre_solve(own, next((space for space in spaces if space is not None), None))


def steps_begun(space: pymunk.Space) -> int:
    """How many steps a space has begun."""
    return int(words(address(space._space), SPACE_WORDS, np.int64)[SPACE_STAMP])


def solve_in_one_thread(space: pymunk.Space) -> None:
    """Have no other thread at work while a structure is solved, whatever `Space.threads` says."""
    if space.threaded:
        words(address(space._space), THREADED_WORDS, np.int64)[THREADED_FROM] = np.iinfo(np.int64).max


def release(constraint: object) -> None:
    """Leave a constraint's functions without anything to work on: they do nothing."""
    words(address(constraint), CONTROL + 1, np.int64)[CONTROL] = 0


def place_of(body: pymunk.Body) -> np.ndarray:
    """Where a body's centre of gravity is, and its angle, (3,) [m, m, rad]."""
    place: np.ndarray = words(body_address(body), BODY_WORDS)[[X, Y, ANGLE]]
    return place


def place_before_step(body: pymunk.Body) -> np.ndarray:
    """The same before the step that its space is in, if any, has moved it by its velocity."""
    space = body.space
    moved = space.current_time_step if space is not None and space._locked else 0.0
    return place_of(body) - moved * words(body_address(body), BODY_WORDS)[[VX, VY, SPIN]]


def next_move(body: pymunk.Body) -> tuple[pymunk.Vec2d, float]:
    """Velocity and spin by which a body is moved next: its own, and pseudo-velocities."""
    raw = words(body_address(body), BODY_FULL_WORDS)
    pushed = pymunk.Vec2d(float(raw[BIAS_VX]), float(raw[BIAS_VX + 1]))
    return body.velocity + pushed, body.angular_velocity + float(raw[BIAS_SPIN])


def push_apart(body: pymunk.Body, velocity: np.ndarray | float) -> None:
    """Set a body's pseudo-velocity x, y [m/s] and spin [rad/s]."""
    words(body_address(body), BODY_FULL_WORDS)[BIAS_VX : BIAS_SPIN + 1] = velocity


def overlap(one: pymunk.Shape, other: pymunk.Shape) -> bool:
    """Whether two shapes overlap where their bodies are; pymunk's own test takes it for granted."""
    return bool(lib.cpShapesCollide(one._shape, other._shape).count)


def save_body(body: pymunk.Body) -> np.ndarray:
    """A body's numbers to the last bit, with those that pymunk does not save.

    These are its transform, its pseudo-velocities, and for how long it has been at rest.
    """
    raw = words(body_address(body), SLEEP_WORDS)
    return np.concatenate([raw[MASS:BODY_WORDS], raw[BIAS_VX : BIAS_SPIN + 1], raw[[IDLE_TIME]]])


def restore_body(body: pymunk.Body, saved: np.ndarray) -> None:
    """Put back what `save_body` gave."""
    raw = words(body_address(body), SLEEP_WORDS)
    raw[MASS:BODY_WORDS], raw[BIAS_VX : BIAS_SPIN + 1] = saved[: BODY_WORDS - MASS], saved[BODY_WORDS - MASS : -1]
    raw[IDLE_TIME] = saved[-1]


def put_body(location: int, place: np.ndarray) -> None:
    """Put the body at an address to x, y and an angle, with the six words of its transform if they are there, too."""
    raw = words(location, BODY_WORDS)
    raw[[X, Y, ANGLE]] = place[:3]
    if len(place) > 3:
        raw[COSINE:BODY_WORDS] = place[3:]
        return
    c, s = math.cos(place[2]), math.sin(place[2])
    x, y = raw[CENTRE : CENTRE + 2]
    raw[COSINE:BODY_WORDS] = c, s, -s, c, place[0] - (c * x - s * y), place[1] - (s * x + c * y)


def listed(space: pymunk.Space, which: int) -> np.ndarray:
    """Addresses in one of a space's lists, in order, to be changed in place."""
    head = words(int(words(address(space._space), SPACE_WORDS, np.int64)[which]), LIST_WORDS, np.int64)
    count = int(head[LIST_COUNT]) & 0xFFFFFFFF
    return words(int(head[LIST_ITEMS]), count, np.int64) if count else np.zeros(0, dtype=np.int64)


def list_anew(space: pymunk.Space, which: int, order: list[int]) -> None:
    """Put one of a space's lists into another order, or leave out some of it."""
    listed(space, which)[: len(order)] = order
    head = words(int(words(address(space._space), SPACE_WORDS, np.int64)[which]), LIST_WORDS, np.int32)
    head[LIST_COUNT] = len(order)


def shape_at(location: int) -> pymunk.Shape:
    """The shape whose struct lies at an address."""
    shape = pymunk.Shape._from_cp_shape(ffi.cast("cpShape *", location))
    assert shape is not None
    return shape


def contacts_of(arbiter: int) -> list[np.ndarray]:
    """Contacts of the arbiter at an address, to be changed in place."""
    w = words(arbiter, ARBITER_WORDS, np.int64)
    first, count = int(w[ARBITER_CONTACTS]), int(w[ARBITER_COUNT]) & 0xFFFFFFFF
    return [words(first + CONTACT_BYTES * k, CONTACT_WORDS) for k in range(count)]


def arbiters_known(space: pymunk.Space) -> list[int]:
    """Addresses of the arbiters that pymunk saves with a space."""
    return [address(arbiter) for arbiter in space._get_arbiters()]


def save_arbiter(location: int, space: pymunk.Space) -> dict[str, Any]:
    """An arbiter as pymunk saves it."""
    return _arbiter_to_dict(ffi.cast("cpArbiter *", location), space)


def add_arbiter(saved: dict[str, Any], space: pymunk.Space) -> None:
    """Put an arbiter back that `save_arbiter` gave."""
    lib.cpSpaceAddCachedArbiter(space._space, _arbiter_from_dict(saved, space))


def sleeping_groups(space: pymunk.Space) -> list[list[int]]:
    """Addresses of the bodies that sleep, by those that do so together, the first one first."""
    groups = []
    for root in listed(space, SLEEPING_ROOTS).tolist():
        group, body = [], root
        while body:
            group.append(body)
            body = int(words(body, SLEEP_WORDS, np.int64)[SLEEP_NEXT])
        groups.append(group)
    return groups


def wake_all(space: object) -> None:
    """Wake all bodies of a cpSpace."""
    roots = words(int(words(address(space), SPACE_WORDS, np.int64)[SLEEPING_ROOTS]), LIST_WORDS, np.int64)
    while int(roots[LIST_COUNT]) & 0xFFFFFFFF:
        lib.cpBodyActivate(ffi.cast("cpBody *", int(words(int(roots[LIST_ITEMS]), 1, np.int64)[0])))


def constraints_on(body: pymunk.Body) -> list[pymunk.Constraint]:
    """Constraints that hold a body; pymunk goes on to count those that have left the space, as joints that broke."""
    return [c for c in body.constraints if words(address(c._constraint), CONSTRAINT_WORDS, np.int64)[CONSTRAINT_SPACE]]
