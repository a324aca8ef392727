"""Back to when bodies touched.

A blow is noticed once bodies overlap. All are put back to where they were when they touched, τ ago, and the parts are
those of h + τ. So is what a tie catches, and what stands on a support that is given another velocity: that one has been
moved by it for a step before any joint could resist. Chipmunk's velocities belong to half a step before their time, as
energies go (n g h of a body that fell for n steps, where √(n (n + 1)) g h belongs to its way), so what falls is given
what outer forces do in ½ h - τ.
"""

from sim.chipmunk import BODY_WORDS, MASS_INVERSE, SPIN, VX
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blow import striking_mass, sum_of
from sim.kernels.bodies import load_positions, move
from sim.kernels.inertia import moment_of
from sim.kernels.layout import (
    GAP,
    INVERSE_M,
    LEDGER_ELASTIC,
    LEDGER_KINETIC,
    MOVE,
    OTHER_START,
    STRIKE,
    SUDDEN,
    WHOLE_STEP,
)
from sim.kernels.noted import NOTES_WORDS, SPEED, TIES_COUNT
from sim.kernels.others import touched, which
from sim.kernels.pushes import pushed
from sim.kernels.rows import own_velocity
from sim.kernels.tie_blows import catches, lateness_of
from sim.kernels.ties import OWNER, address_of, tie_at
from sim.memory import floats, integers, kernel

# Of the energy with which something strikes: what a structure has that hardly moves, though it does so in parts.
_QUIET = 1e-2


@kernel
def lateness(head):  # type: ignore[no-untyped-def]
    """How long ago those that strike have touched, or a support was set moving, at most the last move [s]."""
    late, energy, c = 0.0, sum_of(head, LEDGER_KINETIC) + sum_of(head, LEDGER_ELASTIC), head
    while c != 0:
        t = views.control(c)
        places, touches, settings = views.places(t), views.touches(t), views.settings(t)
        most, struck = settings[MOVE], 0.0
        for k in range(t[at.CONTACTS]):
            if touches[k, STRIKE] > 0.0:
                struck = max(struck, 0.5 * striking_mass(places[k]) * touches[k, STRIKE] ** 2)
        # Parts see what comes near what moves, and their velocities do not lead back through a step.
        seen = t[at.AFTER_PARTS] == 1 and energy > _QUIET * struck
        if t[at.AFTER_PARTS] == 1 and not seen:
            most = settings[WHOLE_STEP]
        for k in range(0 if seen else t[at.CONTACTS]):
            if touches[k, STRIKE] > 0.0:
                late = max(late, -touches[k, GAP] / touches[k, STRIKE])
        late = max(late, lateness_of_ties(c))
        if t[at.JERKED] == 1 and settings[SUDDEN] > 0.0:
            late = settings[MOVE]
        # A step that is shorter than the last one may have moved bodies back.
        late = min(late, max(most, 0.0))
        c = t[at.NEXT]
    return late


@kernel
def lateness_of_ties(c):  # type: ignore[no-untyped-def]
    """How long ago ties of a structure that give a blow have caught what they stop, or -1 if none does [s]."""
    t, late = views.control(c), -1.0
    notes = integers(t[at.NOTES], NOTES_WORDS)
    for k in range(notes[TIES_COUNT] if t[at.TIED] > 0 and t[at.AFTER_PARTS] == 0 else 0):
        tie = tie_at(notes, k)
        if tie[OWNER] == c or tie[OWNER + 1] == c:
            late = max(late, lateness_of(tie)[0])
    return late


@kernel
def is_caught(c, body):  # type: ignore[no-untyped-def]
    """Whether a tie of a structure gives a loose body, or any if ``body`` is 0, a blow."""
    t = views.control(c)
    notes = integers(t[at.NOTES], NOTES_WORDS)
    for k in range(notes[TIES_COUNT] if t[at.TIED] > 0 else 0):
        tie = tie_at(notes, k)
        for side in range(2):
            if tie[OWNER + 1 - side] == c and catches(tie) and (body == 0 or address_of(tie, side) == body):
                return True
    return False


@kernel
def go_back(head, others, rows, pushes, late):  # type: ignore[no-untyped-def]
    """Put a group and what is with it back to where it was when those that strike touched, with the velocities then.

    What something holds keeps its velocities: there forces from outside are borne, and give none.
    """
    for i in range(len(others)):
        b = floats(others[i], BODY_WORDS)
        move(others[i], -late * b[VX], -late * b[VX + 1], -late * b[SPIN])
    hit, c = False, head
    gone = late / views.settings(views.control(head))[WHOLE_STEP]
    while c != 0:
        t = views.control(c)
        places, touches, struck = views.places(t), views.touches(t), False
        start, shift, body_at = views.per_body(t, at.START_VELOCITY), views.shift(t), views.body_at(t)
        external, weight = views.per_body(t, at.EXTERNAL), views.weight(t)
        # By which the last move was; an impulse since then has not moved them yet.
        last, moving = views.per_body(t, at.LAST_VELOCITY), t[at.MOVING]
        for k in range(t[at.CONTACTS]):
            touches[k, GAP] -= late * (touches[k, OTHER_START] + own_velocity(c, places[k], touches[k], 0, last))
            i = which(others, places[k])
            if touches[k, STRIKE] > 0.0:
                struck = hit = True
                if i >= 0 and rows[i] != 0:
                    b, share = floats(others[i], BODY_WORDS), behind(t, others[i]) - gone
                    at_start = floats(rows[i] + 8 * SPEED, 3)
                    b[VX] = at_start[0] + share * pushes[i, 0]
                    b[VX + 1] = at_start[1] + share * pushes[i, 1]
                    b[SPIN] = at_start[2] + share * pushes[i, 2]
        load_positions(body_at, views.per_body(t, at.BEGUN_AT))
        for i in range(moving):
            move(body_at[i], -late * last[i, 0], -late * last[i, 1], -late * last[i, 2])
        for i in range(t[at.BODIES]):
            for axis in range(3):
                if t[at.JERKED] == 1 and i >= moving:
                    # So its last move is the one before that.
                    start[i, axis] = last[i, axis]
                shift[i, axis] -= late * (last[i, axis] if i < moving else start[i, axis])
        t[at.SHIFTED] = 1
        if (struck or is_caught(c, 0)) and t[at.FREE] == 1:
            share = (0.0 if t[at.AFTER_PARTS] == 1 else 0.5) - gone
            for i in range(t[at.MOVING]):
                start[i, 0] += share * external[i, 0] * weight[i, INVERSE_M]
                start[i, 1] += share * external[i, 1] * weight[i, INVERSE_M]
                start[i, 2] += share * external[i, 2] / moment_of(floats(body_at[i], BODY_WORDS))
        c = t[at.NEXT]
    for i in range(len(others)):
        b, share = floats(others[i], BODY_WORDS), 0.5 - gone
        near, caught, c = touched(head, others[i], 1), False, head
        while c != 0:
            caught = caught or is_caught(c, others[i])
            c = views.control(c)[at.NEXT]
        if near:
            share = behind_in(head, others[i]) - gone
        if b[MASS_INVERSE] > 0.0 and (near or hit or caught) and not touched(head, others[i], 0):
            b[VX] += share * pushes[i, 0]
            b[VX + 1] += share * pushes[i, 1]


@kernel
def behind(t, body):  # type: ignore[no-untyped-def]
    """By how much of a step the velocity of a loose body is behind its place, but where the last parts moved it: ½."""
    return 0.0 if t[at.AFTER_PARTS] == 1 and pushed(t, body) >= 0 else 0.5


@kernel
def behind_in(head, body):  # type: ignore[no-untyped-def]
    """The same for all structures of a group."""
    least, c = 0.5, head
    while c != 0:
        least = min(least, behind(views.control(c), body))
        c = views.control(c)[at.NEXT]
    return least
