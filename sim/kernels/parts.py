"""A step taken in parts, inside the one step that Chipmunk takes.

When it comes to the structures, Chipmunk has moved all bodies and found the contacts. Of the step's n parts, all but
the last are taken at once then, each a step of its own: forces from outside act with their share of the impulse, joints
and contacts are solved, laws and ledger take over what was found, and the structures' bodies are moved, together with
the loose ones that touch them. The last part is what Chipmunk's iterations then work on. In the end the bodies are put
back, and a pseudo-velocity makes Chipmunk's next move, which is one of a whole step, end where the last part does.

Where nothing holds a structure, each of its bodies is put back to where its angular momentum is what it is, so that a
part of them that is taken away has its own.

Which surfaces meet, and in which direction, is found anew within the step (`near.py`). In between, their distance g is
followed, and a contact may close it in a part of length h but not pass it, v_n ≥ - g / h.

A blow is noticed late, and all go back to when they touched (`late.py`); the parts are those of what is left then, too.
"""

import numpy as np

from sim.chipmunk import (
    ANGLE,
    BODY_WORDS,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    MASS_INVERSE,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.beside import gather_beside, leave_out_borne, note_starts_beside, take_over_beside
from sim.kernels.blow import OVER, go_over, grow_older, is_over
from sim.kernels.bodies import load_positions, load_velocities, move, store_velocities
from sim.kernels.guard import choose_for_part
from sim.kernels.kinematics import prepare
from sim.kernels.late import go_back, lateness
from sim.kernels.layout import (
    BEFORE,
    BETA,
    BLOW,
    BLOW_AGE,
    CACHED,
    EARLIER,
    MOVE,
    NEXT_MOVE,
    PUSH,
    STEP,
    STRIKE,
    UNDAMPED,
    UNEVEN,
    WHERE,
    WHOLE_RATIO,
    WHOLE_STEP,
)
from sim.kernels.lengths import LONGEST_PART, averaged_lengths, part_lengths
from sim.kernels.links import add_up, all_links_of, hand_back_sums, let_go_of, lift_links, link, prepare_links
from sim.kernels.moves import carry_on, go_with_support
from sim.kernels.near import fall_behind, hand_over, let_go, look, stand_in
from sim.kernels.newton import restart
from sim.kernels.noted import BEGUN, note_given, note_last, note_parts, note_way, note_ways, row_of
from sim.kernels.others import (
    changes,
    mates_of,
    others_of,
    put_back,
    set_back,
    show,
    struck_besides,
    take_back,
)
from sim.kernels.part import begin_part, end_part, renew, scale_all
from sim.kernels.settle import finite, settle_bounces
from sim.memory import floats, kernel


@kernel
def take_parts(head, fresh, touching):  # type: ignore[no-untyped-def]
    """Take all parts of a step but the last one, and begin that; whether all of them converged."""
    others, leader = others_of(head), views.control(head)
    link(head, others)
    links = all_links_of(head)
    mates = mates_of(head, others, links)
    take_back(head)
    take_over_beside(head, mates)
    gather_beside(head, mates)
    touching = touching or leader[at.CONTACTS] > 0
    # With what is held there, too.
    others = others_of(head)
    free = np.empty((len(others), 3))
    load_velocities(others, free)
    settings, rows = views.settings(leader), note_parts(leader, others)
    pushes = changes(others, rows)
    lift_links(links, others, pushes, settings[WHOLE_RATIO])
    set_back(others, rows)
    note_starts_beside(head)
    struck = struck_besides(head, others, pushes)
    falling = pushes.copy()
    leave_out_borne(head, others, links, falling)
    fall_behind(head, others, falling, free)
    begun = np.empty((len(others), 3))
    load_positions(others, begun)
    late = lateness(head)
    note_given(rows, others, -1.0)
    go_back(head, others, rows, falling, late)
    note_given(rows, others, 1.0)
    whole, span = settings[WHOLE_STEP], settings[WHOLE_STEP] + late
    averaged = begin_schemes(head)
    moves, steps = averaged_lengths(settings, span) if averaged else part_lengths(settings, span)
    open_step(head, late, moves, steps)
    scale_all(pushes, steps[0] / whole)
    stand_in(head)
    # What another body gave comes once, whatever the length of the parts, so that no momentum is lost.
    add_all(pushes, struck, steps[0] / span)
    before, lost, converged = np.empty((len(others), 3)), 0.0, True
    for i in range(len(moves) - 1):
        h = moves[i]
        look(head)
        load_velocities(others, before)
        note_ways(rows, others, 0.5 * steps[i])
        begin_part(head, others, pushes)
        prepare_links(links, h, steps[i])
        c = head
        while c != 0:
            restart(views.control(c))
            c = views.control(c)[at.NEXT]
        converged = settle_bounces(head, fresh, touching) and converged
        add_up(links)
        c = head
        while c != 0:
            t = views.control(c)
            if t[at.FAULT] >= 0 or not finite(t):
                let_go(head, others, mates, pushes, begun, free, rows)
                return converged
            c = t[at.NEXT]
        # In a whole step it would be so many times as much.
        lost += whole / h * end_part(head, others, before, pushes, moves[i + 1], steps[i + 1])
        let_go_of(links, steps[i + 1] / steps[i])
        note_ways(rows, others, 0.5 * steps[i])
        grow_older(head, 0.0, h)
    if lost < OVER * whole * settings[BLOW] or is_over(head):
        go_over(head)
    look(head)
    let_go(head, others, mates, pushes, begun, free, rows)
    if averaged:
        keep_to_supports(head, others, span - moves.sum())
    note_last(rows, others, steps[-1])
    begin_part(head, others, pushes)
    prepare_links(links, moves[-1], steps[-1])
    c = head
    while c != 0:
        views.control(c)[at.PARTS], views.control(c)[at.PUSHED_APART] = len(moves), 0
        c = views.control(c)[at.NEXT]
    return converged


@kernel
def open_step(head, late, moves, steps):  # type: ignore[no-untyped-def]
    """Make a step of the first part, over what remains of the last step, too; nothing has been applied yet."""
    c = head
    while c != 0:
        t = views.control(c)
        settings, touches = views.settings(t), views.touches(t)
        ratio = steps[0] / settings[STEP]
        settings[STEP], settings[NEXT_MOVE] = steps[0], moves[0]
        settings[MOVE] = max(settings[MOVE] - late, min(settings[MOVE], moves[-1]))
        settings[UNEVEN] = 1.0
        t[at.AHEAD], t[at.PUSHED_APART] = 1, 1
        scale_all(views.per_joint(t, at.IMPULSE), ratio)
        scale_all(views.per_body(t, at.EXTERNAL), ratio)
        clear(views.per_body(t, at.CONTACT_IMPULSE))
        for k in range(t[at.CONTACTS]):
            touches[k, CACHED], touches[k, CACHED + 1] = 0.0, 0.0
            if touches[k, STRIKE] > 0.0:
                touches[k, PUSH] = 0.0
        store_velocities(t, views.per_body(t, at.START_VELOCITY))
        if settings[BETA] != 0.0 and settings[UNDAMPED] != 0.0:
            if settings[BEFORE + BETA] != 0.0:
                carry_on(t, 0.5 * (settings[STEP] - settings[MOVE]))
                go_with_support(t, 0.5 * (settings[MOVE] - settings[STEP]))
            # Implicit Euler's velocities count as those with which such a part would have ended.
            settings[MOVE] = settings[STEP]
        renew(t)
        prepare(t)
        c = t[at.NEXT]


@kernel
def begin_schemes(head):  # type: ignore[no-untyped-def]
    """Choose the time integration of the parts of a group; whether all are taken by the average-acceleration rule."""
    averaged, c = True, head
    while c != 0:
        averaged = choose_for_part(views.control(c), LONGEST_PART) and averaged
        c = views.control(c)[at.NEXT]
    return averaged


@kernel
def keep_to_supports(head, others, time):  # type: ignore[no-untyped-def]
    """Have held bodies, and what stands on them, go on for so long: averaged parts move them a little too far."""
    c = head
    while c != 0:
        go_with_support(views.control(c), time)
        c = views.control(c)[at.NEXT]
    for i in range(len(others)):
        b = floats(others[i], BODY_WORDS)
        if b[MASS_INVERSE] == 0.0:
            move(others[i], time * b[VX], time * b[VX + 1], time * b[SPIN])


@kernel
def begin_whole(head):  # type: ignore[no-untyped-def]
    """Begin a step that is as short as a part by the rule for those, if something came suddenly in it."""
    if views.settings(views.control(head))[BLOW_AGE] > 0.0:
        return
    c = head
    while c != 0:
        t = views.control(c)
        settings = views.settings(t)
        beta = settings[BETA]
        begins = choose_for_part(t, LONGEST_PART) and settings[BEFORE + BETA] == 0.0
        if begins:
            settings[MOVE] = settings[STEP]
        if begins or settings[BETA] != beta:
            prepare(t)
        c = t[at.NEXT]


@kernel
def add_all(array, other, factor):  # type: ignore[no-untyped-def]
    """Add a multiple of one two-dimensional array to another."""
    for i in range(array.shape[0]):
        for k in range(array.shape[1]):
            array[i, k] += factor * other[i, k]


@kernel
def close_step(head, t):  # type: ignore[no-untyped-def]
    """Put bodies back to where Chipmunk had moved them, and give contacts the impulses of all parts.

    Chipmunk's next move goes from there, with the velocities of the last part and a pseudo-velocity beside them.
    """
    h, whole = views.settings(t)[NEXT_MOVE], views.settings(t)[WHOLE_STEP]
    if t[at.AHEAD] == 1:
        others, c = others_of(head), head
        while c != 0:
            views.control(c)[at.AHEAD] = 0
            c = views.control(c)[at.NEXT]
        hand_back_sums(all_links_of(head))
        for i in range(len(others)):
            b = floats(others[i], BODY_WORDS)
            if b[MASS_INVERSE] > 0.0:
                row = row_of(t, others[i])
                note_way(row, others[i], 0.5 * views.settings(t)[STEP])
                show(others[i], floats(row + 8 * BEGUN, 3), h, whole)
            else:
                # Held, and moved evenly.
                ahead = whole - h
                move(others[i], -ahead * b[VX], -ahead * b[VX + 1], -ahead * b[SPIN])
    if t[at.FAULT] < 0:
        # What the next step is to find where it was: at the place from which plain velocities would have led there.
        body_at, begun, position = views.body_at(t), views.per_body(t, at.BEGUN_AT), views.per_body(t, at.LAST_POSITION)
        for i in range(t[at.MOVING]):
            b = floats(body_at[i], BODY_WORDS)
            if t[at.FREE] == 1:
                show(body_at[i], begun[i], h, whole)
            else:
                put_back(body_at[i], begun[i], h, whole)
            position[i, 0] += (h - whole) * b[VX]
            position[i, 1] += (h - whole) * b[VX + 1]
            position[i, 2] += (h - whole) * b[SPIN]
        for i in range(t[at.MOVING], t[at.BODIES]):
            b = floats(body_at[i], BODY_WORDS)
            position[i, 0], position[i, 1], position[i, 2] = b[X], b[X + 1], b[ANGLE]
    places, touches = views.places(t), views.touches(t)
    for k in range(t[at.CONTACTS]):
        contact = floats(places[k, WHERE], CONTACT_WORDS)
        contact[CONTACT_NORMAL_IMPULSE] += touches[k, EARLIER]
        contact[CONTACT_TANGENT_IMPULSE] += touches[k, EARLIER + 1]
    hand_over(t)
