"""Whether the installed pymunk lays out its structs as `sim.chipmunk` says: asked once, when `sim` is imported."""

import math

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from sim import chipmunk as at
from sim.chipmunk import (
    address,
    body_address,
    listed,
    next_move,
    sleeping_groups,
    wake_all,
    words,
)
from sim.stock import KINDS, ON_A, ON_B, POINT, TURN, Kind, cached_impulse

#: pymunk versions that the offsets were taken from.
KNOWN_VERSIONS = "7.3"


class IncompatiblePymunk(ImportError):
    """The installed pymunk lays its structs out in another way."""


def verify() -> None:
    """Check every offset against the installed pymunk, through its own setters.

    Raises
    ------
    IncompatiblePymunk
        When a field is not where it is expected; the message names the versions that work.
    """
    parts = (
        _body_fits,
        _pseudo_velocities_fit,
        _space_fits,
        _threads_fit,
        _constraints_fit,
        _contacts_fit,
        _shapes_fit,
        _lists_fit,
    )
    check(all(fits() for fits in parts))


def check(fits: bool) -> None:
    """Refuse the installed pymunk unless it fits.

    Raises
    ------
    IncompatiblePymunk
        The message names the versions that work.
    """
    if not fits:
        raise IncompatiblePymunk(
            f"pymunk {pymunk.version} lays out its bodies or constraints in a way that sim does not know; "
            f"install version {KNOWN_VERSIONS}: pip install 'pymunk>=7.3,<7.4'"
        )


def _body_fits() -> bool:
    """Whether a body's fields are where they should be."""
    body, (x, y) = pymunk.Body(3.0, 5.0), (73.0, 79.0)
    body.center_of_gravity = (x, y)
    body.angle, body.angular_velocity = 19.0, 23.0
    body.position, body.velocity = (7.0, 11.0), (13.0, 17.0)
    body.force, body.torque = (61.0, 67.0), 71.0
    cosine, sine = math.cos(19.0), math.sin(19.0)
    expected = [(at.MASS, 3.0), (at.MASS_INVERSE, 1.0 / 3.0), (at.MOMENT, 5.0), (at.MOMENT_INVERSE, 1.0 / 5.0)]
    expected += [(at.CENTRE, x), (at.CENTRE + 1, y), (at.VX, 13.0), (at.VY, 17.0)]
    expected += [(at.FORCE_X, 61.0), (at.FORCE_Y, 67.0), (at.ANGLE, 19.0), (at.SPIN, 23.0), (at.TORQUE, 71.0)]
    expected += [(at.COSINE, cosine), (at.SINE, sine), (at.MINUS_SINE, -sine), (at.COSINE_AGAIN, cosine)]
    expected += [(at.ORIGIN, 7.0), (at.ORIGIN + 1, 11.0)]
    expected += [(at.X, 7.0 + x * cosine - y * sine), (at.Y, 11.0 + x * sine + y * cosine)]
    field = words(body_address(body), at.BODY_WORDS)
    return all(abs(field[word] - value) <= 1e-12 for word, value in expected)


def _pseudo_velocities_fit() -> bool:
    """Whether what moves a body besides its velocity is where it should be: one that a fixed circle pushes aside."""
    space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
    body.position = (1.5, 0.2)
    space.add(body, pymunk.Poly.create_box(body, (2.0, 2.0)), pymunk.Circle(space.static_body, 1.0))
    space.step(0.5)
    x, angle, (velocity, spin) = body.position.x, body.angle, next_move(body)
    space.step(0.5)
    moved, turned = body.position.x - x, body.angle - angle
    return moved != 0.0 != turned and math.isclose(moved, 0.5 * velocity.x) and math.isclose(turned, 0.5 * spin)


def _space_fits() -> bool:
    """Whether a space's fields are where they should be."""
    space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
    space.collision_slop, space.gravity = 43.0, (67.0, 71.0)
    space.add(body)
    lib.cpSpaceSetTimestamp(space._space, 53)
    lib.cpSpaceSetShapeIDCounter(space._space, 59)
    fields = words(address(space._space), at.SPACE_WORDS)
    numbers = words(address(space._space), at.SPACE_WORDS, np.int64)
    space.step(0.25)
    fits = (
        fields[at.CURRENT_STEP] == 0.25
        and fields[at.SPACE_SLOP] == 43.0
        and np.array_equal(fields[at.SPACE_GRAVITY :][:2], [67.0, 71.0])
    )
    fits &= numbers[at.SPACE_STAMP] & 0xFFFFFFFF == 54 and numbers[at.SPACE_SHAPE_COUNTER] == 59
    return bool(
        fits and words(body_address(body), at.BODY_FULL_WORDS, np.int64)[at.BODY_SPACE] == address(space._space)
    )


def _threads_fit() -> bool:
    """Whether a space with threads, where the platform has any, knows how many and from when on as it should."""
    space = pymunk.Space(threaded=True)
    fields = words(address(space._space), at.THREADED_WORDS, np.int64)
    return not space.threaded or (fields[at.THREADS] == space.threads == 1 and fields[at.THREADED_FROM] == 50)


def _constraints_fit() -> bool:
    """Whether constraints know their space, their bodies and each other, and where they keep their impulse."""
    space, a, b, c, d = pymunk.Space(), *(pymunk.Body(1.0, 1.0) for _ in range(4))
    first, last = pymunk.PivotJoint(a, b, (29.0, 31.0), (37.0, 41.0)), pymunk.PivotJoint(c, d, (0.0, 0.0))
    between, unlike = pymunk.PivotJoint(b, c, (0.0, 0.0)), pymunk.GearJoint(a, d, 0.0, 1.0)
    first.max_force, first.error_bias = 73.0, 0.79
    space.add(a, b, c, d, first, last, between)
    one, two, three, four = (address(joint._constraint) for joint in (first, last, between, unlike))
    kinds = [int(words(location, 1, np.int64)[at.CONSTRAINT_CLASS]) for location in (one, two, four)]
    fields, after = words(one, at.CONTROL, np.int64), words(three, at.CONTROL, np.int64)
    fits = kinds[0] == kinds[1] != kinds[2]
    fits &= np.array_equal(words(one + 8 * at.CONTROL, 4), [29.0, 31.0, 37.0, 41.0])
    fits &= fields[at.CONSTRAINT_BODY_A] == body_address(a) and fields[at.CONSTRAINT_BODY_B] == body_address(b)
    fits &= fields[at.CONSTRAINT_SPACE] == address(space._space)
    fits &= words(one, at.CONTROL)[at.CONSTRAINT_MAX_FORCE] == 73.0
    fits &= words(one, at.CONTROL)[at.CONSTRAINT_ERROR_BIAS] == 0.79
    fits &= after[at.CONSTRAINT_NEXT_A] == one and after[at.CONSTRAINT_NEXT_B] == two
    fits &= words(body_address(a), at.BODY_FULL_WORDS, np.int64)[at.CONSTRAINTS] == one
    lib.cpConstraintSetPostSolveFunc(first._constraint, ffi.cast("cpConstraintPostSolveFunc", 73))
    fits &= fields[at.POST_SOLVE] == 73
    space.remove(first, between)
    fits &= fields[at.CONSTRAINT_SPACE] == 0
    return bool(fits) and all(_kind_fits(kind) for kind in KINDS.values())


def _kind_fits(kind: Kind) -> bool:
    """Whether a kind of Chipmunk's own constraints has its numbers where they should be: a step finds what is known."""
    space, a, b = pymunk.Space(), pymunk.Body(3.0, 5.0), pymunk.Body(7.0, 11.0)
    b.position = (13.0, 0.0)
    constraint = kind.make(a, b)
    space.add(a, b, constraint)
    space.step(0.25)
    field, spins, along = words(address(constraint._constraint), at.CONTROL + 32), 1 / 5 + 1 / 11, 1 / 3 + 1 / 7
    expected = [(kind.mass, 1.0 / (spins if kind.way == TURN else along))]
    if kind.way == POINT:
        across = along + ON_A[0] ** 2 / 5 + ON_B[0] ** 2 / 11
        expected += [(kind.mass + 1, 0.0), (kind.mass + 2, 0.0), (kind.mass + 3, 1.0 / across)]
    if kind.arms:
        expected += [(kind.arms + i, arm) for i, arm in enumerate((*ON_A, *ON_B))]
    if kind.axis:
        expected += [(kind.axis, 1.0), (kind.axis + 1, 0.0)]
    if kind.ratio:
        expected += [(kind.ratio, 1.0), (kind.ratio + 1, 1.0)]
    if kind.target:
        # The spring alone gives this velocity, and the damper takes a share of it.
        speed = 0.25 * spins if kind.way == TURN else -0.25 * (13.0 - ON_A[0] + ON_B[0]) * along
        share = 1.0 - math.exp(-0.25 * (spins if kind.way == TURN else along))
        expected += [(kind.damping, 1.0), (kind.coefficient, share), (kind.target, (1.0 - share) * speed)]
    cached_impulse(constraint)[:] = 47.0
    fits = abs(constraint.impulse - 47.0 * math.sqrt(kind.count)) <= 1e-12
    return fits and all(abs(field[word] - value) <= 1e-12 for word, value in expected)


def _contacts_fit() -> bool:
    """Whether arbiters and contacts, which pymunk itself describes, are as they should be."""
    arbiter = {"e": 0, "u": at.ARBITER_FRICTION, "surface_vr": at.ARBITER_SURFACE, "a": at.ARBITER_SHAPE_A}
    arbiter |= {"b": at.ARBITER_SHAPE_B, "body_a": at.ARBITER_BODY_A, "body_b": at.ARBITER_BODY_B}
    arbiter |= {"thread_a": at.ARBITER_NEXT_A, "thread_b": at.ARBITER_NEXT_B, "count": at.ARBITER_COUNT}
    arbiter |= {"contacts": at.ARBITER_CONTACTS, "n": at.ARBITER_NORMAL, "state": at.ARBITER_STATE}
    contact = {"r1": at.CONTACT_R1, "r2": at.CONTACT_R2, "nMass": at.CONTACT_NORMAL_MASS}
    contact |= {"tMass": at.CONTACT_TANGENT_MASS, "bounce": at.CONTACT_BOUNCE, "jnAcc": at.CONTACT_NORMAL_IMPULSE}
    contact |= {"jtAcc": at.CONTACT_TANGENT_IMPULSE, "jBias": at.CONTACT_BIAS_IMPULSE}
    contact |= {"bias": at.CONTACT_BIAS, "hash": at.CONTACT_HASH}
    whole = ffi.sizeof("struct cpContact") == at.CONTACT_BYTES == 8 * at.CONTACT_WORDS
    return whole and _begin("cpArbiter", arbiter) and _begin("struct cpContact", contact)


def _shapes_fit() -> bool:
    """Whether shapes know of what kind they are, and keep their radius, where they should."""
    body, corners = pymunk.Body(1.0, 1.0), [(0.0, 0.0), (2.0, 0.0), (0.0, 2.0)]
    shapes = (
        pymunk.Circle(body, 79.0),
        pymunk.Segment(body, corners[0], corners[1], 79.0),
        pymunk.Poly(body, corners, radius=79.0),
    )
    fits = True
    for kind, (shape, word) in enumerate(zip(shapes, at.SHAPE_RADIUS, strict=True)):
        location = address(shape._shape)
        functions = int(words(location, 1, np.int64)[at.SHAPE_CLASS])
        fits &= is_address(functions) and int(words(functions, 1, np.int64)[0]) & 0xFFFFFFFF == kind
        fits &= words(location, word + 1)[word] == 79.0
    return bool(fits)


def _begin(struct: str, expected: dict[str, int]) -> bool:
    """Whether fields of a struct begin at these words."""
    fields = dict(ffi.typeof(struct).fields)
    return all(fields[name].offset == 8 * word for name, word in expected.items())


def _lists_fit() -> bool:
    """Whether a space's lists hold what they should, awake and asleep."""
    space, bodies = pymunk.Space(), [pymunk.Body(1.0, 1.0) for _ in range(2)]
    joint = pymunk.PivotJoint(bodies[0], bodies[1], (0.0, 0.0))
    space.add(*bodies, joint, *(pymunk.Circle(body, 1.0) for body in bodies))
    space.sleep_time_threshold = 1.0
    addresses = [body_address(body) for body in bodies]
    lists = at.MOVING_BODIES, at.SLEEPING_ROOTS, at.CONSTRAINTS_OF_SPACE, at.ARBITERS_OF_SPACE
    if not all(_is_list(space, which) for which in lists):
        return False
    fits = listed(space, at.MOVING_BODIES).tolist() == addresses
    fits &= listed(space, at.CONSTRAINTS_OF_SPACE).tolist() == [address(joint._constraint)]
    joint.collide_bodies = True
    space.step(0.5)
    arbiter = int(words(addresses[0], at.BODY_FULL_WORDS, np.int64)[at.ARBITERS])
    fits &= listed(space, at.ARBITERS_OF_SPACE).tolist() == [arbiter]
    fits &= words(addresses[0], at.SLEEP_WORDS)[at.IDLE_TIME] == 0.5
    bodies[0].sleep()
    bodies[1].sleep_with_group(bodies[0])
    sleep = [words(location, at.SLEEP_WORDS, np.int64) for location in addresses]
    fits &= [int(body[at.SLEEP_ROOT]) for body in sleep] == [addresses[0], addresses[0]]
    fits &= [int(body[at.SLEEP_NEXT]) for body in sleep] == [addresses[1], 0]
    # Both go along links, which must be those for it to end.
    if not fits or sleeping_groups(space) != [addresses] or len(listed(space, at.MOVING_BODIES)) != 0:
        return False
    wake_all(space._space)
    return sorted(listed(space, at.MOVING_BODIES).tolist()) == sorted(addresses)


def _is_list(space: pymunk.Space, which: int) -> bool:
    """Whether a word of a space can be the address of a short list, so that the list may be read at all."""
    where = int(words(address(space._space), at.SPACE_WORDS, np.int64)[which])
    if not is_address(where):
        return False
    head = words(where, at.LIST_WORDS, np.int64)
    return int(head[at.LIST_COUNT]) & 0xFFFFFFFF < 10 and is_address(int(head[at.LIST_ITEMS]))


def is_address(word: int) -> bool:
    """Whether a word can be where a struct lies, on a processor of 64 bits."""
    return 1 << 16 < word < 1 << 47 and word % 8 == 0
