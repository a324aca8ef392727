"""One step of a structure: its beginning, the solves in Chipmunk's iterations, and its end."""

import math

import numpy as np
from numba import njit

from sim.chipmunk import (
    ANGLE,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CENTRE,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    COSINE,
    COSINE_AGAIN,
    MINUS_SINE,
    ORIGIN,
    SINE,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.commit import commit, weaken
from sim.kernels.complement import NOT_FINITE, gather_contacts, sum_up, touch
from sim.kernels.contacts import collect, hand_back
from sim.kernels.energy import close
from sim.kernels.guard import choose_scheme, close_from_below
from sim.kernels.inertia import give_back, mass_of, moment_of, weigh
from sim.kernels.kinematics import leave_out, prepare
from sim.kernels.layout import CACHED, INERTIA_I, LEDGER_CONTACT, LEDGER_NUMERICAL, LEDGER_PLASTIC, WHERE
from sim.kernels.newton import iterate, restart
from sim.kernels.restitution import MOST_HALVINGS, bounce_less, bounces, creates_energy
from sim.memory import call_notice, clear, floats

_MOST_ROUNDS = 40
_SETTLED = 1e-6
# A movement without velocity below this [m, rad], over 1 + |x|, is rounding.
_UNMOVED = 1e-12


@njit(error_model="numpy")
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
    weigh(t)
    prepare(t)
    velocity, written, weight = views.per_body(t, at.VELOCITY), views.per_body(t, at.WRITTEN), views.weight(t)
    for i in range(t[at.BODIES]):
        for axis in range(3):
            velocity[i, axis] = written[i, axis] = start[i, axis]
    for i in range(t[at.MOVING]):
        velocity[i, 2] *= moment_of(floats(body_at[i], BODY_WORDS)) / weight[i, INERTIA_I]
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


@njit(error_model="numpy")
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


@njit(error_model="numpy")
def move(body, x, y, turn):  # type: ignore[no-untyped-def]
    """Move a body and turn it."""
    b = floats(body, BODY_WORDS)
    b[X] += x
    b[X + 1] += y
    b[ANGLE] += turn
    c, s = math.cos(b[ANGLE]), math.sin(b[ANGLE])
    b[COSINE], b[SINE], b[MINUS_SINE], b[COSINE_AGAIN] = c, s, -s, c
    b[ORIGIN] = b[X] - (c * b[CENTRE] - s * b[CENTRE + 1])
    b[ORIGIN + 1] = b[X + 1] - (s * b[CENTRE] + c * b[CENTRE + 1])


@njit(error_model="numpy")
def load_velocities(t, velocity):  # type: ignore[no-untyped-def]
    """Copy the bodies' velocities into ``velocity``."""
    body_at = views.body_at(t)
    for i in range(t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = b[VX], b[VX + 1], b[SPIN]


@njit(error_model="numpy")
def take_in(t):  # type: ignore[no-untyped-def]
    """Book what changed the bodies' velocities since they were written, and let the solver know; whether any did."""
    body_at, weight = views.body_at(t), views.weight(t)
    velocity, written = views.per_body(t, at.VELOCITY), views.per_body(t, at.WRITTEN)
    external = views.per_body(t, at.EXTERNAL)
    differs = False
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        x, y, w = b[VX] - written[i, 0], b[VX + 1] - written[i, 1], b[SPIN] - written[i, 2]
        if x != 0.0 or y != 0.0 or w != 0.0:
            differs = True
            mass, moment = mass_of(b), moment_of(b)
            external[i, 0] += mass * x
            external[i, 1] += mass * y
            external[i, 2] += moment * w
            velocity[i, 0] += x
            velocity[i, 1] += y
            velocity[i, 2] += w * (moment / weight[i, INERTIA_I])
            written[i, 0], written[i, 1], written[i, 2] = b[VX], b[VX + 1], b[SPIN]
    for i in range(t[at.MOVING], t[at.BODIES]):
        b = floats(body_at[i], BODY_WORDS)
        differs = differs or velocity[i, 0] != b[VX] or velocity[i, 1] != b[VX + 1] or velocity[i, 2] != b[SPIN]
        for out in (velocity, written):
            out[i, 0], out[i, 1], out[i, 2] = b[VX], b[VX + 1], b[SPIN]
    return differs


@njit(error_model="numpy")
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
    if fresh:
        if touching:
            book_cached(c)
        member = c
        while member != 0:
            t = views.control(member)
            t[at.FRESH] = 0
            restart(t)
            member = t[at.NEXT]
    converged = settle(c, fresh, touching)
    if touching and bounces(c):
        for k in range(MOST_HALVINGS):
            if head[at.FAULT] >= 0 or not creates_energy(c):
                break
            bounce_less(c, 0.5 if k < MOST_HALVINGS - 1 else 0.0)
            converged = settle(c, False, True)
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


@njit(error_model="numpy")
def settle(c, fresh, touching):  # type: ignore[no-untyped-def]
    """Solve joints, breaking and contacts in turn until they agree; whether they do."""
    predicting, untouched = fresh, True
    for _ in range(_MOST_ROUNDS):
        change, taken, converged = 0.0, 0, True
        member = c
        while member != 0:
            t = views.control(member)
            steps, done, views.settings(t)[at.LAST_RESIDUAL] = iterate(t, predicting)
            t[at.NEWTON_STEPS] += steps
            taken, converged = taken + steps, converged and done
            if t[at.BREAKABLE] == 1:
                change = max(change, weaken(t))
            member = t[at.NEXT]
        predicting = False
        # Contacts are exact for the tangents they were solved with: once the joints agree, nothing is left to do.
        if touching and (taken > 0 or untouched):
            untouched = False
            moved = touch(c)
            if moved == NOT_FINITE:
                views.control(c)[at.FAULT] = 0
                return True
            change = max(change, moved)
        if change <= _SETTLED:
            return converged
    return False


@njit(error_model="numpy")
def book_cached(c):  # type: ignore[no-untyped-def]
    """Chipmunk has applied the contacts' cached impulses to the bodies: they did not come from outside."""
    places, touches = gather_contacts(c)
    amounts = np.empty(2 * len(places))
    ratio = views.settings(views.control(c))[at.STEP_RATIO]
    for r in range(len(amounts)):
        amounts[r] = ratio * touches[r >> 1, CACHED + (r & 1)]
    member = c
    while member != 0:
        t = views.control(member)
        solution = views.per_body(t, at.SOLUTION)
        external, struck = views.per_body(t, at.EXTERNAL), views.per_body(t, at.CONTACT_IMPULSE)
        sum_up(member, places, touches, amounts, solution)
        for i in range(t[at.MOVING]):
            for axis in range(3):
                struck[i, axis] += solution[i, axis]
                external[i, axis] -= solution[i, axis]
        member = t[at.NEXT]


@njit(error_model="numpy")
def finite(t):  # type: ignore[no-untyped-def]
    """Whether impulses and velocities are finite; otherwise the first joint whose impulse is not is the fault."""
    impulse, velocity = views.per_joint(t, at.IMPULSE), views.per_body(t, at.VELOCITY)
    for k in range(t[at.JOINTS]):
        if not math.isfinite(impulse[k, 0] + impulse[k, 1] + impulse[k, 2]):
            t[at.FAULT] = k
            return False
    for i in range(t[at.MOVING]):
        if not math.isfinite(velocity[i, 0] + velocity[i, 1] + velocity[i, 2]):
            t[at.FAULT] = 0
    return t[at.FAULT] < 0


@njit(error_model="numpy")
def write(t):  # type: ignore[no-untyped-def]
    """Give the bodies their velocities."""
    body_at, written = views.body_at(t), views.per_body(t, at.WRITTEN)
    give_back(t, views.per_body(t, at.VELOCITY), written)
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        b[VX], b[VX + 1], b[SPIN] = written[i, 0], written[i, 1], written[i, 2]


@njit(error_model="numpy")
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


@njit(error_model="numpy")
def finish(c):  # type: ignore[no-untyped-def]
    """End of a step: commit the laws, and tell Python when a joint broke or the step was refused."""
    t = views.control(c)
    shift = views.shift(t)
    if t[at.FAULT] < 0:
        take_in(t)
        ledger = views.ledger(t)
        contact, plastic, numerical = ledger[LEDGER_CONTACT], ledger[LEDGER_PLASTIC], ledger[LEDGER_NUMERICAL]
        t[at.BROKE] = commit(t)
        close(c, t)
        close_from_below(t, contact, plastic, numerical)
        load_velocities(t, views.per_body(t, at.LAST_VELOCITY))
        body_at, position = views.body_at(t), views.per_body(t, at.LAST_POSITION)
        for i in range(t[at.BODIES]):
            b = floats(body_at[i], BODY_FULL_WORDS)
            position[i, 0], position[i, 1], position[i, 2] = b[X], b[X + 1], b[ANGLE]
            shift[i, 0], shift[i, 1], shift[i, 2] = b[BIAS_VX], b[BIAS_VX + 1], b[BIAS_SPIN]
    else:
        clear(shift)
    t[at.HEAD], t[at.NEXT] = 0, 0
    if t[at.FAULT] >= 0 or t[at.BROKE] > 0:
        call_notice(t[at.NOTICE], t[at.KEY])
