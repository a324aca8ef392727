"""A step that is refused, because a number in it is not finite, leaves everything as it was before.

Laws, ledger and positions change where a step is concluded, so there is little to undo, unless it is taken in parts:
what the first of them change is copied before. Bodies go back to where Chipmunk's move of this step took them from.

What comes from outside, forces without bound or a step that is none, is noticed before anything has changed but
positions; the rest shows while a structure is solved. Either way, all structures of the space go back, and Python puts
back what it has beside them (`sim.step_back`).
"""

import math

from sim.chipmunk import (
    ANGLE,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONSTRAINT_SPACE,
    CONSTRAINT_WORDS,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.bodies import move, put, reached, stays, store_velocities
from sim.kernels.layout import (
    BEFORE,
    RESULT_FORCE,
    STEP,
    WHOLE_STEP,
)
from sim.kernels.settle import first_joint_at
from sim.memory import call_notice, floats, integers, kernel

#: Over 1 + |x|: nearer than this to where the last step ended, a body has gone back to just there [m, rad].
ROUNDING = 1e-12


@kernel
def check_bodies(t):  # type: ignore[no-untyped-def]
    """Before forces act: the fault is a joint's whose body they, or its own numbers, would lead out of all bounds.

    Or one whose body was taken out of the space without it, or is of another type now.
    """
    h, body_at = views.settings(t)[STEP], views.body_at(t)
    if not 0.0 < h < math.inf:
        t[at.FAULT] = 0
        return
    for i in range(t[at.BODIES]):
        moving = i < t[at.MOVING]
        if moving and not math.isfinite(reached(floats(body_at[i], BODY_WORDS), h)):
            t[at.FAULT] = first_joint_at(t, i)
            return
        if not stays(body_at[i], moving):
            t[at.FAULT] = joint_left_at(t, i)
            if t[at.FAULT] >= 0:
                return


@kernel
def joint_left_at(t, body):  # type: ignore[no-untyped-def]
    """The first joint of a body that is still in the space, or -1."""
    joint_at, joint_bodies = views.joint_at(t), views.joint_bodies(t)
    for k in range(t[at.JOINTS]):
        own = joint_bodies[k, 0] == body or joint_bodies[k, 1] == body
        if own and integers(joint_at[k], CONSTRAINT_WORDS)[CONSTRAINT_SPACE] != 0:
            return k
    return -1


@kernel
def keep(head):  # type: ignore[no-untyped-def]
    """Copy what the parts of a step are going to change in a group."""
    c = head
    while c != 0:
        t = views.control(c)
        # At least; they are counted in the end.
        t[at.PARTS] = 2
        if t[at.COPY] == 0:
            # Python makes room.
            call_notice(t[at.NOTICE], t[at.KEY])
        copy_all(t, 1)
        c = t[at.NEXT]


@kernel
def refuse(head):  # type: ignore[no-untyped-def]
    """Stop the step of a whole space; until it ends, a group's bodies have their velocities of before."""
    c, told = head, False
    while c != 0:
        t = views.control(c)
        t[at.FRESH] = 0
        if t[at.FAULT] < 0 or told:
            t[at.FAULT] = at.WITH_OTHERS
        elif t[at.FAULT] != at.WITH_OTHERS:
            told = True
            # Python stops all others.
            call_notice(t[at.NOTICE], t[at.KEY])
        clear(views.per_joint(t, at.IMPULSE))
        store_velocities(t, views.per_body(t, at.START_VELOCITY))
        c = t[at.NEXT]


@kernel
def roll_back(t):  # type: ignore[no-untyped-def]
    """Put a structure back to how it was before the step."""
    settings, body_at, begun = views.settings(t), views.body_at(t), views.per_body(t, at.BEGUN_AT)
    h = settings[WHOLE_STEP]
    if t[at.PARTS] > 1:
        for i in range(t[at.MOVING]):
            put(body_at[i], begun[i, 0], begun[i, 1], begun[i, 2])
        copy_all(t, -1)
    for i in range(BEFORE):
        settings[i] = settings[BEFORE + i]
    store_velocities(t, views.per_body(t, at.START_VELOCITY))
    shift = views.shift(t)
    for i in range(t[at.BODIES]):
        for axis in range(3):
            # How it was moved, back to the pseudo-velocity by which.
            shift[i, axis] = shift[i, axis] / h if math.isfinite(shift[i, axis] / h) else 0.0
    carried = views.per_body(t, at.CARRIED)
    for i in range(t[at.MOVING]):
        move(body_at[i], -carried[i, 0], -carried[i, 1], -carried[i, 2])
        step_back(t, i, h)
    t[at.SHIFTED] = 1
    t[at.PARTS] = 1 + t[at.AFTER_PARTS]
    impulse, result = views.per_joint(t, at.IMPULSE), views.result(t)
    for k in range(t[at.JOINTS]):
        for i in range(3):
            impulse[k, i] = -settings[STEP] * result[k, RESULT_FORCE + i]
    t[at.BROKE] = 0


@kernel
def step_back(t, i, h):  # type: ignore[no-untyped-def]
    """Put body i to where the last step ended, or where it was put by hand since.

    A step in parts puts bodies back to where it had begun, with a pseudo-velocity that leads on from there.
    """
    last, noted, begun = (
        views.per_body(t, at.LAST_VELOCITY),
        views.per_body(t, at.LAST_POSITION),
        views.per_body(t, at.BEGUN_AT),
    )
    shift, body, settings = views.shift(t), views.body_at(t)[i], views.settings(t)
    b = floats(body, BODY_FULL_WORDS)
    for axis in range(3):
        word, push = (ANGLE, BIAS_SPIN) if axis == 2 else (X + axis, BIAS_VX + axis)
        now, b[push] = b[word], shift[i, axis]
        if t[at.AFTER_PARTS] == 1:
            b[word] = begun[i, axis]
            # It is to lead there in a step of the last one's length.
            lead = now - b[word] - h * last[i, axis]
            b[push] = lead / settings[WHOLE_STEP] if math.isfinite(lead) else 0.0
            continue
        b[word] = now - h * (last[i, axis] + shift[i, axis])
        by_hand = abs(b[word] - noted[i, axis])
        if not math.isfinite(b[word]) or by_hand <= ROUNDING * (1.0 + abs(b[word])):
            b[word] = noted[i, axis]
    move(body, 0.0, 0.0, 0.0)


@kernel
def copy_all(t, way):  # type: ignore[no-untyped-def]
    """Copy what a concluded step changes, or back for a negative ``way``; `words_to_copy` counts it."""
    joints, bodies, place = t[at.JOINTS], t[at.BODIES], t[at.COPY]
    place = copy(t[at.ACTIVE], place, joints, way)
    place = copy(t[at.GRADIENT], place, at.GRADIENT_WORDS * joints, way)
    place = copy(t[at.RESPONSE], place, at.RESPONSE_WORDS * joints, way)
    place = copy(t[at.RESULT], place, at.RESULT_WORDS * joints, way)
    place = copy(t[at.LEDGER], place, at.LEDGER_WORDS, way)
    place = copy(t[at.SHIFT], place, 6 * bodies, way)
    place = copy(t[at.START_VELOCITY], place, 3 * bodies, way)
    place = copy(t[at.LAST_VELOCITY], place, 3 * bodies, way)
    place = copy(t[at.LAST_POSITION], place, 3 * bodies, way)
    place = copy(t[at.BEGUN_AT], place, 3 * bodies, way)
    flowing = integers(place, 1)
    if way > 0:
        flowing[0] = t[at.FLOWING]
    else:
        t[at.FLOWING] = flowing[0]
    place += 8
    laws = views.laws(t)
    for k in range(joints):
        place = copy(laws[k, 3], place, laws[k, 4], way)


@kernel
def copy(original, place, words, way):  # type: ignore[no-untyped-def]
    """Copy so many words to ``place``, or back; returns where the next ones go."""
    here, there = integers(original, words), integers(place, words)
    for i in range(words):
        if way > 0:
            there[i] = here[i]
        else:
            here[i] = there[i]
    return place + 8 * words


def words_to_copy(joints: int, bodies: int, states: int) -> int:
    """Words that `copy_all` copies; ``states`` of them are the laws'."""
    per_joint = 1 + at.GRADIENT_WORDS + at.RESPONSE_WORDS + at.RESULT_WORDS
    return per_joint * joints + 18 * bodies + at.LEDGER_WORDS + 1 + states
