"""Contacts of bodies that went past the middle of what they hit within one step, or deep between two pieces of it.

Chipmunk parts shapes that overlap by the shortest way, which then leads through to the far side, or into a gap. Where
they have come from is known: from where their velocities would have had them at the start of the step. There they
touched first, at one point and along one normal, and those the contact is given. How deep it is, is then how far they
have gone since, by which structures know when that was (`sim.kernels.late`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymunk
import shapely

from sim.chipmunk import (
    ARBITER_COUNT,
    ARBITER_NORMAL,
    ARBITER_SHAPE_A,
    ARBITER_SHAPE_B,
    ARBITER_WORDS,
    CONTACT_BIAS,
    CONTACT_BOUNCE,
    CONTACT_NORMAL_MASS,
    CONTACT_R1,
    CONTACT_R2,
    contacts_of,
    next_move,
    shape_at,
    words,
)
from sim.contact_graph import arbiters_of
from sim.first_touch import moved, rounding

_RESTITUTION = 0
_MOST_ADVANCES = 60


def turn_round(bodies: Sequence[pymunk.Body], step: float) -> None:
    """Give the contacts of ``bodies`` that are marked the side they came from; where none is found they stay.

    All others of a loose body that came from elsewhere are looked into, too: they would lead it out sideways.
    """
    marked = {arbiter: body.space for body in bodies for arbiter in arbiters_of(body) if _is_marked(arbiter)}
    for arbiter, space in list(marked.items()):
        for word in (ARBITER_SHAPE_A, ARBITER_SHAPE_B):
            other = shape_at(int(words(arbiter, ARBITER_WORDS, np.int64)[word])).body
            assert other is not None
            if other not in bodies and other.body_type == pymunk.Body.DYNAMIC:
                marked |= dict.fromkeys(arbiters_of(other), space)
    for arbiter, space in marked.items():
        assert space is not None
        _turn(arbiter, space, step)


def _is_marked(arbiter: int) -> bool:
    return any(contact[CONTACT_NORMAL_MASS] < 0.0 for contact in contacts_of(arbiter))


def _turn(arbiter: int, space: pymunk.Space, step: float) -> None:
    """Make the first touch of an arbiter's two shapes its only contact, if there was one in this step."""
    w = words(arbiter, ARBITER_WORDS, np.int64)
    for contact in contacts_of(arbiter):
        contact[CONTACT_NORMAL_MASS] = abs(contact[CONTACT_NORMAL_MASS])
    a, b = (shape_at(int(w[word])) for word in (ARBITER_SHAPE_A, ARBITER_SHAPE_B))
    time = _touch_time(a, b, step, 0.01 * space.collision_slop)
    if time is None:
        return
    w[ARBITER_COUNT] = (int(w[ARBITER_COUNT]) & ~0xFFFFFFFF) | 1
    contact = contacts_of(arbiter)[0]
    line = shapely.shortest_line(moved(a, time), moved(b, time))
    on_a, on_b = (pymunk.Vec2d(*point) for point in shapely.get_coordinates(line))
    normal = (on_b - on_a).normalized()
    arms, velocities = [], []
    for shape, point in ((a, on_a + rounding(a) * normal), (b, on_b - rounding(b) * normal)):
        assert shape.body is not None
        velocity, spin = next_move(shape.body)
        centre = shape.body.local_to_world(shape.body.center_of_gravity)
        arm = (point - centre - velocity * time).rotated(-spin * time)
        arms.append((centre, arm))
        velocities.append(velocity + spin * arm.perpendicular())
    (centre_a, arm_a), (centre_b, arm_b) = arms
    depth = (centre_b + arm_b - centre_a - arm_a).dot(normal) + space.collision_slop
    contact[CONTACT_R1 : CONTACT_R1 + 2], contact[CONTACT_R2 : CONTACT_R2 + 2] = arm_a, arm_b
    f = words(arbiter, ARBITER_WORDS)
    f[ARBITER_NORMAL : ARBITER_NORMAL + 2] = normal
    contact[CONTACT_BOUNCE] = (velocities[1] - velocities[0]).dot(normal) * f[_RESTITUTION]
    # All of it at once, where the step is not taken in parts: the next one would find the wrong side again.
    contact[CONTACT_BIAS] = -min(0.0, depth) / step


def _touch_time(a: pymunk.Shape, b: pymunk.Shape, step: float, enough: float) -> float | None:
    """When two shapes came nearer than ``enough`` within the last ``step``, below 0; None if they were that before.

    By conservative advancement, as `sim.first_touch` looks ahead.
    """
    approach = abs(_velocity(a) - _velocity(b)) + _fastest_turn(a) + _fastest_turn(b)
    time = -step
    for _ in range(_MOST_ADVANCES):
        distance = shapely.distance(moved(a, time), moved(b, time)) - rounding(a) - rounding(b)
        if distance <= enough:
            return None if time == -step else time
        # Not all the way, so that there is a direction in which they are apart.
        time += (distance - 0.5 * enough) / approach
        if time >= 0.0:
            return None
    return time


def _velocity(shape: pymunk.Shape) -> pymunk.Vec2d:
    assert shape.body is not None
    return next_move(shape.body)[0]


def _fastest_turn(shape: pymunk.Shape) -> float:
    """Greatest speed with which turning moves a point of the shape [m/s]."""
    body = shape.body
    assert body is not None
    centre = body.local_to_world(body.center_of_gravity)
    reach = float(np.hypot(*(shapely.get_coordinates(moved(shape, 0.0)) - centre).T).max()) + rounding(shape)
    return abs(next_move(body)[1]) * reach
