"""One step of a structure: its beginning, the solves in Chipmunk's iterations, and its end."""

from sim.chipmunk import (
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blow import count_parts
from sim.kernels.bodies import arrive, depart, move, take_in, write
from sim.kernels.contacts import collect, hand_back
from sim.kernels.guard import choose_scheme
from sim.kernels.inertia import add_inertia
from sim.kernels.kinematics import prepare, take_up
from sim.kernels.layout import WHERE
from sim.kernels.newton import restart
from sim.kernels.parts import close_step, conclude, take_parts
from sim.kernels.settle import book_cached, finite, settle_bounces
from sim.memory import call_notice, clear, floats, kernel


@kernel
def begin(c, h):  # type: ignore[no-untyped-def]
    """Start of a step: where the joints are, and what their bodies' velocities were."""
    t = views.control(c)
    settings = views.settings(t)
    ratio = h / settings[at.STEP] if settings[at.STEP] > 0.0 else 0.0
    settings[at.STEP] = h
    settings[at.STEP_RATIO] = ratio if ratio > 0.0 else 1.0
    settings[at.WHOLE_RATIO] = h / settings[at.WHOLE_STEP] if settings[at.WHOLE_STEP] > 0.0 else 1.0
    settings[at.WHOLE_STEP] = h
    t[at.PARTS], t[at.AHEAD], t[at.BROKE] = 1, 0, 0
    settings[at.SPREAD_IMPULSE] *= ratio * t[at.SPREAD]
    t[at.FRESH] = 1
    spin, touching = arrive(t, h)
    choose_scheme(t, spin)
    take_up(t, ratio)
    add_inertia(t)
    prepare(t)
    t[at.PUSHED_APART], t[at.CONTACTS] = 0, 0
    if not touching:
        return
    clear(views.per_body(t, at.CONTACT_IMPULSE))
    collect(c, t)
    if t[at.MISSED] > 0:
        # Python makes room, and all contacts are collected anew.
        hand_back(t)
        t[at.BROKE] = 0
        call_notice(t[at.NOTICE], t[at.KEY])
        collect(c, t)


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
    head = t[at.HEAD] if t[at.HEAD] != 0 else c
    if t[at.FAULT] < 0:
        take_in(t)
        conclude(c, t)
        depart(t)
    else:
        clear(views.shift(t))
        t[at.SHIFTED] = 0
    if t[at.PARTS] > 1:
        close_step(head, t)
    t[at.HEAD], t[at.NEXT] = 0, 0
    if t[at.FAULT] >= 0 or t[at.BROKE] > 0:
        call_notice(t[at.NOTICE], t[at.KEY])
