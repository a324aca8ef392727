"""Pseudo-velocities that lead bodies to where the last part of a step ends, in a next step of another length.

In a step as long as the last one Chipmunk's move by velocities and pseudo-velocities ends there.
"""

from sim.chipmunk import (
    ANGLE,
    ARBITER_BODY_A,
    ARBITER_BODY_B,
    ARBITER_WORDS,
    ARBITERS,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONSTRAINTS,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bodies import move
from sim.kernels.layout import BODY_A, BODY_B, OWNER_A, OWNER_B
from sim.kernels.owners import next_arbiter
from sim.memory import floats, inlined, integers, kernel


@kernel
def even_out(t, h, whole):  # type: ignore[no-untyped-def]
    """After a step of length ``whole`` in parts, take back what pseudo-velocities did too much in a move of ``h``.

    They lead to where the last part ends in a move as long as that step; velocities do the rest, and may be made up for
    (`moves.carry`). Where something touches the structure they do nothing more, which would strain its joints: that one
    stays with it. Returns for how long velocities have done the rest.
    """
    body_at, begun, over = views.body_at(t), views.per_body(t, at.BEGUN_AT), h - whole
    last, position = views.per_body(t, at.LAST_VELOCITY), views.per_body(t, at.LAST_POSITION)
    back = over if is_touched_by_loose(t) else 0.0
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        x, y, turn = b[X] - begun[i, 0] - h * b[VX], b[X + 1] - begun[i, 1] - h * b[VX + 1], b[ANGLE] - begun[i, 2]
        move(body_at[i], -over / h * x, -over / h * y, -over / h * (turn - h * b[SPIN]))
        if back != 0.0:
            move(body_at[i], -back * last[i, 0], -back * last[i, 1], -back * last[i, 2])
            for axis in range(3):
                position[i, axis] -= back * last[i, axis]
    for k in range(t[at.PUSHED]):
        body, push = integers(t[at.PUSHES] + 32 * k, 1)[0], floats(t[at.PUSHES] + 32 * k, 4)
        if touches(t, body):
            b = floats(body, BODY_WORDS)
            move(body, -over * push[1], -over * push[2], -over * push[3])
            move(body, -back * b[VX], -back * b[VX + 1], -back * b[SPIN])
            push[1], push[2], push[3] = whole / h * push[1], whole / h * push[2], whole / h * push[3]
    return over - back


@kernel
def is_touched_by_loose(t):  # type: ignore[no-untyped-def]
    """Whether something touches a structure, or was near it in the last step, that no constraint holds.

    Nothing that moves is to hold the structure either.
    """
    last, body_at, touched = views.per_body(t, at.LAST_VELOCITY), views.body_at(t), t[at.CONTACTS] > 0
    for i in range(t[at.MOVING], t[at.BODIES]):
        if last[i, 0] != 0.0 or last[i, 1] != 0.0 or last[i, 2] != 0.0:
            return False
    for k in range(t[at.PUSHED]):
        body = integers(t[at.PUSHES] + 32 * k, 1)[0]
        if touches(t, body) and integers(body, BODY_FULL_WORDS)[CONSTRAINTS] != 0:
            return False
    for i in range(t[at.MOVING]):
        touched = touched or integers(body_at[i], BODY_FULL_WORDS)[ARBITERS] != 0
    return touched


@kernel
def touches(t, body):  # type: ignore[no-untyped-def]
    """Whether the body at an address, which may be no body any more, touches a structure."""
    body_at = views.body_at(t)
    for i in range(t[at.MOVING]):
        arbiter = integers(body_at[i], BODY_FULL_WORDS)[ARBITERS]
        while arbiter != 0:
            w = integers(arbiter, ARBITER_WORDS)
            if w[ARBITER_BODY_A] == body or w[ARBITER_BODY_B] == body:
                return True
            arbiter = next_arbiter(arbiter, body_at[i])
    return False


@inlined
def note_pushes(t):  # type: ignore[no-untyped-def]
    """Note with which pseudo-velocities the loose bodies at the contacts go into their next move."""
    places, count = views.places(t), 0
    t[at.PUSHED] = 0
    for k in range(t[at.CONTACTS]):
        if places[k, OWNER_A] != 0 and places[k, OWNER_B] != 0:
            continue
        body = places[k, BODY_A] if places[k, OWNER_A] == 0 else places[k, BODY_B]
        if pushed(t, body) < 0:
            b, row = floats(body, BODY_FULL_WORDS), floats(t[at.PUSHES] + 32 * count, 4)
            integers(t[at.PUSHES] + 32 * count, 1)[0] = body
            row[1], row[2], row[3] = b[BIAS_VX], b[BIAS_VX + 1], b[BIAS_SPIN]
            count += 1
            t[at.PUSHED] = count


@kernel
def pushed(t, body):  # type: ignore[no-untyped-def]
    """Which row of those noted is a loose body's, or -1."""
    for k in range(t[at.PUSHED]):
        if integers(t[at.PUSHES] + 32 * k, 1)[0] == body:
            return k
    return -1
