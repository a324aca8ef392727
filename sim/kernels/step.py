"""One step of a structure: its beginning, the solves in Chipmunk's iterations, and its end."""

from sim.chipmunk import (
    ANGLE,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blow import count_parts
from sim.kernels.bodies import load_positions, load_pseudo_velocities, load_velocities, move, take_in, write
from sim.kernels.contacts import collect, hand_back
from sim.kernels.guard import choose_scheme
from sim.kernels.kinematics import leave_out
from sim.kernels.layout import WHERE
from sim.kernels.newton import restart
from sim.kernels.parts import close_step, conclude, renew, take_parts
from sim.kernels.settle import book_cached, finite, settle_bounces
from sim.memory import call_notice, clear, floats, kernel

# A movement without velocity below this [m, rad], over 1 + |x|, is rounding.
_UNMOVED = 1e-12


@kernel
def begin(c, h):  # type: ignore[no-untyped-def]
    """Start of a step: where the joints are, and what their bodies' velocities were.

    Chipmunk has just moved the bodies. Where one was given another velocity since the last step, by an impulse say, it
    was moved with that before any joint could resist; it is put to where its old velocity would have taken it, so that
    the impulse acts when the forces do.
    """
    t = views.control(c)
    n, body_at, settings = t[at.JOINTS], views.body_at(t), views.settings(t)
    ratio = h / settings[at.STEP] if settings[at.STEP] > 0.0 else 0.0
    settings[at.STEP] = h
    settings[at.STEP_RATIO] = ratio if ratio > 0.0 else 1.0
    settings[at.WHOLE_RATIO] = h / settings[at.WHOLE_STEP] if settings[at.WHOLE_STEP] > 0.0 else 1.0
    settings[at.WHOLE_STEP] = h
    t[at.PARTS], t[at.AHEAD], t[at.BROKE] = 1, 0, 0
    settings[at.SPREAD_IMPULSE] *= ratio * t[at.SPREAD]
    t[at.FRESH] = 1
    start, last = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.LAST_VELOCITY)
    load_velocities(t, start)
    choose_scheme(t)
    for i in range(t[at.MOVING]):
        x, y, w = start[i, 0] - last[i, 0], start[i, 1] - last[i, 1], start[i, 2] - last[i, 2]
        if x != 0.0 or y != 0.0 or w != 0.0:
            move(body_at[i], -h * x, -h * y, -h * w)
    find_shifts(t, h)
    t[at.FREE] = 0 if leave_out(t) else 1
    # The last step's impulses, to start from.
    active, impulse, scale = views.active(t), views.per_joint(t, at.IMPULSE), views.scale(t)
    for k in range(n):
        for i in range(3):
            impulse[k, i] *= ratio * active[k]
        scale[k] = 1.0
    renew(t)
    written = views.per_body(t, at.WRITTEN)
    for i in range(t[at.BODIES]):
        for axis in range(3):
            written[i, axis] = start[i, axis]
    clear(views.per_body(t, at.EXTERNAL))
    clear(views.per_body(t, at.CONTACT_IMPULSE))
    t[at.PUSHED_APART] = 0
    collect(c, t)
    if t[at.MISSED] > 0:
        # Python makes room, and all contacts are collected anew.
        hand_back(t)
        t[at.BROKE] = 0
        call_notice(t[at.NOTICE], t[at.KEY])
        collect(c, t)


@kernel
def find_shifts(t, h):  # type: ignore[no-untyped-def]
    """Movement since the last step that its velocities do not explain: to take out overlap, and by hand."""
    body_at, shift = views.body_at(t), views.shift(t)
    last, position = views.per_body(t, at.LAST_VELOCITY), views.per_body(t, at.LAST_POSITION)
    t[at.SHIFTED] = 0
    for i in range(t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        for axis in range(3):
            place = b[ANGLE] if axis == 2 else b[X + axis]
            # Until now it held the pseudo-velocity with which the last step ended.
            shift[i, axis] *= h
            rest = place - (position[i, axis] + h * last[i, axis] + shift[i, axis])
            # A structure that is new does not know where its bodies were.
            shift[i, 3 + axis] = rest if abs(rest) > _UNMOVED * (1.0 + abs(place)) else 0.0
            if shift[i, axis] != 0.0 or shift[i, 3 + axis] != 0.0:
                t[at.SHIFTED] = 1


@kernel
def solve(c):  # type: ignore[no-untyped-def]
    """The impulses of a group's joints and contacts at the bodies' present velocities, breaking included."""
    head = views.control(c)
    if head[at.HEAD] != 0 and head[at.HEAD] != c:
        return  # another one acts for this structure
    fresh, touching, differs = head[at.FRESH] == 1, False, False
    member = c
    while member != 0:
        t = views.control(member)
        if t[at.FAULT] >= 0:
            return
        touching = touching or t[at.CONTACTS] > 0
        differs = take_in(t) or differs
        member = t[at.NEXT]
    if not (differs or fresh or touching):
        return  # nothing else has touched the structure since it was solved
    converged = True
    if fresh:
        if touching:
            book_cached(c)
        parts = count_parts(c)
        if parts > 1:
            converged = take_parts(c, parts, fresh, touching)
        member = c
        while member != 0:
            t = views.control(member)
            t[at.FRESH] = 0
            restart(t)
            member = t[at.NEXT]
    converged = settle_bounces(c, fresh, touching) and converged
    member = c
    while member != 0:
        t = views.control(member)
        if t[at.FAULT] >= 0 or not finite(t):
            refuse(c)
            return
        member = t[at.NEXT]
    if not converged:
        head[at.UNCONVERGED] += 1
    member = c
    while member != 0:
        t = views.control(member)
        write(t)
        member = t[at.NEXT]


@kernel
def refuse(c):  # type: ignore[no-untyped-def]
    """Put the bodies of a group back to where and how they were before the step."""
    member = c
    while member != 0:
        t = views.control(member)
        t[at.FAULT] = max(t[at.FAULT], 0)
        clear(views.per_joint(t, at.IMPULSE))
        h, body_at = views.settings(t)[at.STEP], views.body_at(t)
        before, last = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.LAST_VELOCITY)
        for i in range(t[at.MOVING]):
            b = floats(body_at[i], BODY_FULL_WORDS)
            b[VX], b[VX + 1], b[SPIN] = before[i, 0], before[i, 1], before[i, 2]
            b[BIAS_VX], b[BIAS_VX + 1], b[BIAS_SPIN] = 0.0, 0.0, 0.0
            move(body_at[i], -h * last[i, 0], -h * last[i, 1], -h * last[i, 2])
        places = views.places(t)
        for k in range(t[at.CONTACTS]):
            contact = floats(places[k, WHERE], CONTACT_WORDS)
            contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE] = 0.0, 0.0
        member = t[at.NEXT]


@kernel
def finish(c):  # type: ignore[no-untyped-def]
    """End of a step: commit the laws, and tell Python when a joint broke or the step was refused."""
    t = views.control(c)
    shift = views.shift(t)
    head = t[at.HEAD] if t[at.HEAD] != 0 else c
    if t[at.FAULT] < 0:
        take_in(t)
        conclude(c, t)
        load_pseudo_velocities(t, shift)
        load_positions(t, views.per_body(t, at.LAST_POSITION))
    else:
        clear(shift)
    if t[at.PARTS] > 1:
        close_step(head, t)
    t[at.HEAD], t[at.NEXT] = 0, 0
    if t[at.FAULT] >= 0 or t[at.BROKE] > 0:
        call_notice(t[at.NOTICE], t[at.KEY])
