"""One step of a structure: its beginning, the solves in Chipmunk's iterations, and its end."""

import math

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.blow import takes_parts
from sim.kernels.bodies import arrive, depart, take_in, write
from sim.kernels.contacts import collect, hand_back
from sim.kernels.guard import choose_scheme
from sim.kernels.inertia import add_inertia
from sim.kernels.kinematics import take_up
from sim.kernels.layout import BEFORE, BLOW
from sim.kernels.links import links_of, note_cached, slacken_bounded
from sim.kernels.moves import carry, come_back, turn_back
from sim.kernels.near import drop, drop_all, gather, let_come
from sim.kernels.newton import restart
from sim.kernels.noted import note_end, note_start
from sim.kernels.owners import constraints_with
from sim.kernels.part import conclude
from sim.kernels.parts import begin_whole, close_step, take_parts
from sim.kernels.pushes import even_out, note_pushes
from sim.kernels.refusal import check_bodies, keep, refuse, roll_back
from sim.kernels.resolved import prepare_step
from sim.kernels.rows import are_solved, note_solved
from sim.kernels.settle import book_cached, finite, settle_bounces
from sim.kernels.strained import book_strained
from sim.kernels.sudden import sudden_energy
from sim.kernels.ties import bind, have_moved, lift_springs, note_seen
from sim.memory import call_notice, inlined, kernel


@kernel
def begin(c, h):  # type: ignore[no-untyped-def]
    """Start of a step: where the joints are, and what their bodies' velocities were."""
    t = views.control(c)
    settings = views.settings(t)
    lift_springs(t, -1.0)
    note_start(t)
    note_cached(t)
    for i in range(BEFORE):
        settings[BEFORE + i] = settings[i]
    last_step, last_move = settings[at.STEP], settings[at.NEXT_MOVE]
    moved = last_move if t[at.PARTS] > 1 else h
    ratio = h / last_step if last_step > 0.0 else 0.0
    settings[at.STEP], settings[at.NEXT_MOVE] = h, h
    if t[at.PARTS] > 1 and h != settings[at.WHOLE_STEP] and h > 0.0:
        moved += even_out(t, h, settings[at.WHOLE_STEP])
    settings[at.WHOLE_RATIO] = h / settings[at.WHOLE_STEP] if settings[at.WHOLE_STEP] > 0.0 else 1.0
    settings[at.WHOLE_STEP] = h
    t[at.AFTER_PARTS] = 1 if t[at.PARTS] > 1 else 0
    t[at.PARTS], t[at.AHEAD], t[at.BROKE] = 1, 0, 0
    settings[at.SPREAD_IMPULSE] *= ratio * t[at.SPREAD]
    t[at.FRESH], t[at.TIED] = 1, 0
    spin, touching, energy = arrive(t, h)
    if t[at.FAULT] < 0 and not (math.isfinite(energy) and h > 0.0):
        check_bodies(t)
        if t[at.FAULT] >= 0:
            # Python notes how all else in the space is.
            call_notice(t[at.NOTICE], t[at.KEY])
    choose_scheme(t, h * spin)
    take_up(t, ratio)
    carry(t, h, last_move, moved, touching)
    if not math.isnan(settings[at.MOMENT]):
        turn_back(t)
    add_inertia(t)
    prepare_step(t, settings[BEFORE + at.BETA] != 0.0)
    if t[at.NEW] == 1:
        t[at.NEW] = 0
        book_strained(t)
    settings[at.SUDDEN] = sudden_energy(t, last_step)
    t[at.PUSHED_APART], t[at.CONTACTS], t[at.ASTRAY] = 0, 0, 0
    if touching:
        take_over(c, t)
    gather(c, t)
    lift_springs(t, 1.0)
    t[at.ALONE] = 1 if not touching and t[at.NEAR] == 0 and has_all_constraints(t) else 0
    falls_back = settings[at.WANTED_BETA] != 0.0 and settings[BEFORE + at.BETA] != 0.0 and settings[at.BETA] == 0.0
    if falls_back and t[at.ALONE] == 1 and settings[BLOW] == 0.0 and settings[at.SUDDEN] == 0.0:
        come_back(t)


@kernel
def take_over(c, t):  # type: ignore[no-untyped-def]
    """Take over the contacts of this step."""
    clear(views.per_body(t, at.CONTACT_IMPULSE))
    collect(c, t)
    while t[at.MISSED] > 0 or t[at.ASTRAY] > 0:
        # Python makes room, and turns contacts the right way; all are collected anew, those too that there were.
        hand_back(t)
        t[at.BROKE] = 0
        call_notice(t[at.NOTICE], t[at.KEY])
        t[at.ASTRAY] = -1
        collect(c, t)


@inlined
def has_all_constraints(t):  # type: ignore[no-untyped-def]
    """Whether the joints that hold are all constraints that Chipmunk goes through in this step."""
    return len(constraints_with(t[at.LEADER])) == t[at.HOLDING]


@kernel
def solve(c):  # type: ignore[no-untyped-def]
    """The impulses of a group's joints, contacts and ties at the bodies' present velocities, breaking included."""
    head = views.control(c)
    if head[at.FRESH] == 1:
        bind(c, head)
    if head[at.HEAD] != 0 and head[at.HEAD] != c:
        return  # another one acts for this structure
    fresh, touching, differs, tied, solved = head[at.FRESH] == 1, False, False, False, True
    member = c
    while member != 0:
        t = views.control(member)
        if t[at.FAULT] >= 0:
            return
        touching, tied = touching or t[at.CONTACTS] > 0, tied or t[at.TIED] > 0
        changed, energy = take_in(t)
        differs, solved = changed or differs, solved and (fresh or are_solved(t))
        if fresh and not (math.isfinite(energy) or finite(t)):
            refuse(c)
            return
        member = t[at.NEXT]
    if not (differs or fresh or (touching and not (solved and len(links_of(c)) == 0)) or (tied and have_moved(c))):
        return  # nothing has touched the structure, or what it touches, since it was solved
    converged = True
    if fresh:
        if touching:
            book_cached(c)
        if takes_parts(c):
            touching = let_come(c) or touching
            keep(c)
            converged = take_parts(c, fresh, touching)
            touching = touching or head[at.CONTACTS] > 0
        else:
            drop_all(c)
            if views.settings(head)[BLOW] > 0.0:
                begin_whole(c)
        member = c
        while member != 0:
            t = views.control(member)
            t[at.FRESH] = 0
            restart(t)
            member = t[at.NEXT]
    converged = settle_bounces(c, fresh, touching) and converged
    if fresh and head[at.PARTS] > 1:
        slacken_bounded(links_of(c))
    member = c
    while member != 0:
        t = views.control(member)
        # Contacts and ties have come after the residual was found.
        known = not (touching or tied) and math.isfinite(views.settings(t)[at.LAST_RESIDUAL])
        if t[at.FAULT] >= 0 or not (known or finite(t)):
            refuse(c)
            return
        member = t[at.NEXT]
    if not converged:
        head[at.UNCONVERGED] += 1
    member = c
    while member != 0:
        t = views.control(member)
        write(t)
        note_solved(t, converged)
        member = t[at.NEXT]
    if tied:
        note_seen(c)


@kernel
def finish(c):  # type: ignore[no-untyped-def]
    """End of a step: commit the laws, and tell Python when a joint broke or the step was refused."""
    t = views.control(c)
    head = t[at.HEAD] if t[at.HEAD] != 0 else c
    if t[at.FAULT] < 0:
        if t[at.ALONE] == 0 or t[at.FRESH] == 1:
            take_in(t)
        conclude(c, t)
        depart(t)
    if t[at.PARTS] > 1:
        close_step(head, t)
    if t[at.FAULT] >= 0:
        roll_back(t)
    note_pushes(t)
    hand_back(t)
    drop(t)
    note_end(t)
    t[at.HEAD], t[at.NEXT] = 0, 0
    if t[at.FAULT] == at.WITH_OTHERS:
        t[at.FAULT] = -1
    elif t[at.FAULT] >= 0 or t[at.BROKE] > 0:
        call_notice(t[at.NOTICE], t[at.KEY])
