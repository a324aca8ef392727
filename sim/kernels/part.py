"""One part of a step that is taken in parts (`parts.py`), or the whole of another: how it begins and ends."""

from sim.chipmunk import (
    BODY_WORDS,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    MASS_INVERSE,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.bodies import load_velocities, move, write
from sim.kernels.commit import commit
from sim.kernels.contacts import SETTLE, allowed, kept, meet
from sim.kernels.energy import close
from sim.kernels.guard import choose_for_part, close_from_below
from sim.kernels.inertia import add_inertia, mass_of, moment_of, weigh
from sim.kernels.kinematics import take_up
from sim.kernels.layout import (
    B_START,
    BETA,
    BOUNCE,
    EARLIER,
    FAR,
    GAP,
    INERTIA_I,
    INERTIA_M,
    INVERSE_I,
    INVERSE_M,
    LEDGER_CONTACT,
    LEDGER_NUMERICAL,
    LEDGER_VISCOUS,
    MOVE,
    NEXT_MOVE,
    OTHER_START,
    RETURN,
    STEP,
    WANTED,
    WHERE,
    WHOLE_STEP,
)
from sim.kernels.resolved import loss_of_joints, prepare_step
from sim.kernels.rows import other_velocity, relative, velocity_of_b
from sim.memory import floats, inlined, kernel

# Of the overlap that a space allows: where less is left to a pressed contact, Chipmunk finds it by rounding or not.
_PRESSED = 1e-3


@kernel
def renew(t):  # type: ignore[no-untyped-def]
    """Weights and velocities at the start of a part of a step."""
    start, velocity = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.VELOCITY)
    body_at, weight = views.body_at(t), views.weight(t)
    load_velocities(body_at, velocity)
    for i in range(t[at.MOVING]):
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = start[i, 0], start[i, 1], start[i, 2]
        weigh(weight, i, floats(body_at[i], BODY_WORDS))
    add_inertia(t)


@inlined
def conclude(c, t):  # type: ignore[no-untyped-def]
    """Let laws and ledger take over what was found; counts the joints that broke."""
    ledger = views.ledger(t)
    contact, viscous, numerical = ledger[LEDGER_CONTACT], ledger[LEDGER_VISCOUS], ledger[LEDGER_NUMERICAL]
    t[at.BROKE] += commit(t)
    less = close(c, t)
    close_from_below(t, contact, viscous, numerical, less)


@kernel
def begin_part(head, others, pushes):  # type: ignore[no-untyped-def]
    """Forces from outside act; contacts start afresh, and may close the distance that there is."""
    c = head
    while c != 0:
        t = views.control(c)
        external, velocity, weight = views.per_body(t, at.EXTERNAL), views.per_body(t, at.VELOCITY), views.weight(t)
        places, touches, settings = views.places(t), views.touches(t), views.settings(t)
        slop, fall = allowed(t, settings[WHOLE_STEP])
        for i in range(t[at.MOVING]):
            velocity[i, 0] += external[i, 0] * weight[i, INVERSE_M]
            velocity[i, 1] += external[i, 1] * weight[i, INVERSE_M]
            velocity[i, 2] += external[i, 2] * weight[i, INVERSE_I]
        for k in range(t[at.CONTACTS]):
            place, touch = places[k], touches[k]
            contact = floats(place[WHERE], CONTACT_WORDS)
            contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE] = 0.0, 0.0
            if touch[GAP] >= FAR:
                touch[WANTED] = 0.0
                continue
            meet(place, touch)
            for row in range(2):
                touch[OTHER_START + row] = other_velocity(c, place, touch, row)
                touch[B_START + row] = velocity_of_b(place, touch, row)
            keep = min(slop, max(kept(place, touch, settings[WHOLE_STEP], fall), _PRESSED * slop))
            slowly = max(min(touch[GAP] + keep, keep), 0.0) / (SETTLE * settings[WHOLE_STEP])
            closing = max(touch[GAP], 0.0) / settings[NEXT_MOVE] + slowly
            if touch[RETURN] > 0.0 and touch[GAP] > 0.0:
                meeting = -relative(place, touch, 0)
                touch[BOUNCE] = touch[RETURN] * meeting if meeting * settings[NEXT_MOVE] > touch[GAP] else 0.0
            touch[WANTED] = touch[BOUNCE] if touch[BOUNCE] > 0.0 else -closing
            touch[BOUNCE] = 0.0
        c = t[at.NEXT]
    for i in range(len(others)):
        b = floats(others[i], BODY_WORDS)
        b[VX] += pushes[i, 0]
        b[VX + 1] += pushes[i, 1]
        b[SPIN] += pushes[i, 2]


@kernel
def end_part(head, others, before, pushes, move_on, step):  # type: ignore[no-untyped-def]
    """Take over what a part has found, and go on to where the bodies are at its end; returns its `loss`.

    In the next part forces are to act for a ``step``, and a move of ``move_on`` is to end it.
    """
    c = head
    while c != 0:
        t = views.control(c)
        write(t)
        c = t[at.NEXT]
    settings = views.settings(views.control(head))
    h, ratio = settings[NEXT_MOVE], step / settings[STEP]
    lost = loss(head, others, before, pushes)
    c = head
    while c != 0:
        t = views.control(c)
        places, touches = views.places(t), views.touches(t)
        conclude(c, t)
        load_velocities(views.body_at(t), views.per_body(t, at.LAST_VELOCITY))
        for k in range(t[at.CONTACTS]):
            contact = floats(places[k, WHERE], CONTACT_WORDS)
            touches[k, EARLIER] += contact[CONTACT_NORMAL_IMPULSE]
            touches[k, EARLIER + 1] += contact[CONTACT_TANGENT_IMPULSE]
            touches[k, GAP] += h * relative(places[k], touches[k], 0)
        c = t[at.NEXT]
    for i in range(len(others)):
        b = floats(others[i], BODY_WORDS)
        move(others[i], h * b[VX], h * b[VX + 1], h * b[SPIN])
    c = head
    while c != 0:
        t = views.control(c)
        body_at, last, start = (
            views.body_at(t),
            views.per_body(t, at.LAST_VELOCITY),
            views.per_body(t, at.START_VELOCITY),
        )
        for i in range(t[at.MOVING]):
            move(body_at[i], h * last[i, 0], h * last[i, 1], h * last[i, 2])
        for i in range(t[at.BODIES]):
            for axis in range(3):
                start[i, axis] = last[i, axis]
        clear(views.per_body(t, at.CONTACT_IMPULSE))
        settings = views.settings(t)
        take_up(t, ratio)
        averaged = settings[BETA] != 0.0
        settings[STEP], settings[NEXT_MOVE] = step, move_on
        scale_all(views.per_body(t, at.EXTERNAL), ratio)
        if t[at.SHIFTED] == 1:
            clear(views.shift(t))
            t[at.SHIFTED] = 0
        if choose_for_part(t, step):
            settings[MOVE] = step
        renew(t)
        prepare_step(t, averaged)
        if settings[BETA] == 0.0:
            settings[MOVE] = h
        c = t[at.NEXT]
    scale_all(pushes, ratio)
    return lost


@kernel
def scale_all(array, factor):  # type: ignore[no-untyped-def]
    """Multiply all of a two-dimensional array."""
    for i in range(len(array)):
        for k in range(3):
            array[i, k] *= factor


@kernel
def loss(head, others, before, pushes):  # type: ignore[no-untyped-def]
    """What implicit Euler takes from the bodies in a part, ½ Δv·M Δv, and from the joints, ½ Δq·K Δq [J].

    Loose bodies may fall freely.
    """
    lost, c = 0.0, head
    while c != 0:
        t = views.control(c)
        start, end, weight = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.WRITTEN), views.weight(t)
        for i in range(t[at.MOVING]):
            x, y, w = end[i, 0] - start[i, 0], end[i, 1] - start[i, 1], end[i, 2] - start[i, 2]
            lost += 0.5 * (weight[i, INERTIA_M] * (x * x + y * y) + weight[i, INERTIA_I] * w * w)
        lost += loss_of_joints(t, end)
        c = t[at.NEXT]
    for i in range(len(others)):
        b = floats(others[i], BODY_WORDS)
        if b[MASS_INVERSE] > 0.0:
            x, y = b[VX] - before[i, 0] - pushes[i, 0], b[VX + 1] - before[i, 1] - pushes[i, 1]
            w = b[SPIN] - before[i, 2] - pushes[i, 2]
            lost += 0.5 * (mass_of(b) * (x * x + y * y) + moment_of(b) * w * w)
    return lost
