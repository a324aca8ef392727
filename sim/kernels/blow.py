"""When a step is taken in parts: as long as a blow lasts.

Implicit Euler takes ½ Δv·M Δv from what changes its velocities by Δv in a step, and a contact acts over whole steps. A
body of speed v that is stopped within N steps so loses the N-th part of its energy to the time integration. At 60 Hz a
falling crate is stopped within four. So a step is taken in parts, see `parts` and `lengths`, from a blow on until it
is over:

- a blow is a contact with a speed of approach beyond what outer forces give in two steps (what is laid down on a
  structure, or rests on it, is none), and with more than a thousandth of the structure's kinetic and elastic
  energy;
- so is a tie that stops what was set moving against it, see `tie_blows`;
- so is what forces from outside bring suddenly, see `sudden`;
- it is over when the structure has turned and swung back: for as long again as its joints went on to take energy, to
  store it or to flow, they took no more; or when whole steps would lose less than a thousandth of the blow's energy in
  a 60th of a second. What a part would lose by implicit Euler is known, and a step n times
  as long loses n times that in its time.

So the largest and the lasting deflection are found at any step; what swings behind them is damped as ever, or goes over
to whole steps by the second-order scheme, see `lengths`. Nothing is spent on this where nothing is hit.
"""

import math

import numpy as np

from sim.chipmunk import BODY_WORDS, MASS_INVERSE
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.layout import (
    AFTER_FORCES,
    AFTER_IMPULSES,
    BEFORE,
    BLOW,
    BLOW_AGE,
    BLOW_KINETIC,
    BLOW_LEAST,
    BLOW_MOST,
    BLOW_MOST_AT,
    BLOW_SHARE,
    BODY_A,
    BODY_B,
    BOUNCE,
    CACHED,
    INERTIA_M,
    LEDGER_ELASTIC,
    LEDGER_KINETIC,
    LEDGER_PLASTIC,
    NEXT_MOVE,
    OTHER_START,
    OVER_AT,
    OWNER_A,
    OWNER_B,
    STRIKE,
    SUDDEN,
    UNDAMPED,
    WANTED_BETA,
    WHOLE_ONLY,
    WHOLE_STEP,
)
from sim.kernels.lengths import longest, note_shortest
from sim.kernels.reached import MOST_LINKED, reach
from sim.kernels.rows import own_velocity, relative
from sim.kernels.sudden import WORTH
from sim.kernels.tie_blows import blow_by_ties
from sim.memory import floats, inlined, kernel

# Over what outer forces give in a step.
_SUDDEN = 2.0
#: Of the structure's energy.
WORTH_OF_BLOW = 1e-3
# By what share of what joints took at the most they are to take more for it to count.
_MORE = 1e-3
# How long a structure takes to turn and swing back, over how long it takes to turn.
_BACK = 2.0
# Of the energy of a blow that is not damped, or of what moves after forces, taken by the joints when a structure turns.
_STOPPED, _TURNED = 0.5, 0.25
# After so long they need not: a pendulum's joints never take it, and what swings so slowly whole steps hardly damp [s].
_LONG = 1.0
#: Of the blow's energy, lost in a second [1/s].
OVER = 0.05


@inlined
def takes_parts(head):  # type: ignore[no-untyped-def]
    """Whether a group of structures takes the step that begins in parts."""
    of_head = views.settings(views.control(head))
    kinetic, elastic, lasting, new, sudden, tied, c = 0.0, 0.0, 0.0, 0.0, 0.0, False, head
    taken = sum_of(head, LEDGER_ELASTIC) + sum_of(head, LEDGER_PLASTIC)
    while c != 0:
        t = views.control(c)
        ledger, settings = views.ledger(t), views.settings(t)
        if t[at.SPREAD] == 1 or settings[WHOLE_ONLY] != 0.0:
            return False
        kinetic, elastic = kinetic + ledger[LEDGER_KINETIC], elastic + ledger[LEDGER_ELASTIC]
        tied = tied or t[at.TIED] > 0
        lasting, sudden = max(lasting, settings[BLOW]), sudden + settings[SUDDEN]
        places, touches, lies = views.places(t), views.touches(t), False
        for k in range(t[at.CONTACTS]):
            lies = lies or (touches[k, CACHED] > 0.0 and is_held(places[k]))
        for k in range(t[at.CONTACTS]):
            # What lies on the ground and rocks there is not struck by it; a bounce takes a step.
            whole = is_held(places[k]) and (lies or touches[k, BOUNCE] > 0.0)
            speed = 0.0 if whole else approach(c, places[k], touches[k])
            touches[k, STRIKE] = speed
            if speed > 0.0:
                new = max(new, 0.5 * striking_mass(places[k]) * speed * speed)
        c = t[at.NEXT]
    if new <= WORTH_OF_BLOW * (kinetic + elastic):
        new = 0.0
    if tied:
        of_ties = blow_by_ties(head, WORTH_OF_BLOW * (kinetic + elastic))
        # They stop what has come suddenly from outside, too.
        new = max(new, of_ties if of_ties > _SUDDEN * sudden else 0.0)
    worth = 0.5 * (WORTH_OF_BLOW if new >= sudden else WORTH)
    new = max(new, sudden)
    if new > 0.0 or lasting == 0.0:
        lasting = max(lasting, new)
        if lasting > 0.0:
            note_shortest(head, new > sudden)
        c = head
        while c != 0:
            t = views.control(c)
            settings = views.settings(t)
            settings[BLOW], settings[BLOW_KINETIC], settings[BLOW_AGE], settings[BLOW_MOST_AT] = (
                lasting,
                kinetic,
                0.0,
                0.0,
            )
            settings[BLOW_LEAST], settings[BLOW_MOST], settings[BLOW_SHARE] = taken, taken, worth
            settings[OVER_AT] = 0.0
            c = t[at.NEXT]
    else:
        grow_older(head, kinetic, of_head[BEFORE + NEXT_MOVE])
    if lasting == 0.0 or reach(head, np.empty(MOST_LINKED, np.int64)) < 0:
        forget(head)
        return False
    if of_head[WHOLE_STEP] > longest(of_head, of_head[BLOW_AGE]):
        return True
    if of_head[UNDAMPED] == 0.0 or of_head[OVER_AT] > 0.0 or is_over(head):
        forget(head)
    return False


@kernel
def grow_older(head, kinetic, h):  # type: ignore[no-untyped-def]
    """Note what became of a blow in a part of length ``h``; its energy is what it set moving, if that is more."""
    taken, c = sum_of(head, LEDGER_ELASTIC) + sum_of(head, LEDGER_PLASTIC), head
    while c != 0:
        t = views.control(c)
        settings = views.settings(t)
        settings[BLOW] = max(settings[BLOW], kinetic - settings[BLOW_KINETIC])
        settings[BLOW_AGE] += h
        least, most = settings[BLOW_LEAST], settings[BLOW_MOST]
        # It gives back what was stored before; a swing that comes a hair nearer to rest than the last one does not.
        less = taken <= least - _MORE * (most - least)
        if less:
            settings[BLOW_LEAST], settings[BLOW_MOST] = taken, taken
        if less or taken - least >= (1.0 + _MORE) * (most - least):
            settings[BLOW_MOST], settings[BLOW_MOST_AT] = taken, settings[BLOW_AGE]
        c = t[at.NEXT]


@kernel
def is_over(head):  # type: ignore[no-untyped-def]
    """Whether a group has turned and swung back, or stores so much that its blow is little against it."""
    t = views.control(head)
    settings, to_turn = views.settings(t), 0.0
    if settings[BLOW_AGE] == 0.0:
        return False  # nothing moves yet
    # With hardly any damping, stiff joints ring before anything else turns.
    if settings[UNDAMPED] == AFTER_IMPULSES:
        to_turn = _STOPPED * settings[BLOW]
    elif settings[UNDAMPED] == AFTER_FORCES and t[at.FREE] == 0:
        to_turn = _TURNED * (sum_of(head, LEDGER_KINETIC) - settings[BLOW_KINETIC])
    turned = settings[BLOW_MOST] - settings[BLOW_LEAST] >= to_turn or settings[BLOW_AGE] >= _LONG
    back = turned and settings[BLOW_AGE] >= _BACK * settings[BLOW_MOST_AT]
    return back or settings[BLOW] < settings[BLOW_SHARE] * sum_of(head, LEDGER_ELASTIC)


@kernel
def is_held(place):  # type: ignore[no-untyped-def]
    """Whether a structure touches what is held in a contact."""
    for side in range(2):
        owner, body = (place[OWNER_A], place[BODY_A]) if side == 0 else (place[OWNER_B], place[BODY_B])
        if owner == 0 and floats(body, BODY_WORDS)[MASS_INVERSE] == 0.0:
            return True
    return False


@kernel
def approach(c, place, touch):  # type: ignore[no-untyped-def]
    """Speed with which the bodies of a contact of structure ``c`` meet, if they meet suddenly; or 0."""
    before = touch[OTHER_START] + own_velocity(c, place, touch, 0, views.per_body(views.control(c), at.START_VELOCITY))
    pushed = abs(relative(place, touch, 0) - before)
    return -before if -before > _SUDDEN * pushed else 0.0


@kernel
def striking_mass(place):  # type: ignore[no-untyped-def]
    """Mass of the loose body that strikes, or of the lighter structure where none does [kg]."""
    least = math.inf
    for side in range(2):
        owner, body = place[OWNER_A], place[BODY_A]
        if side == 1:
            owner, body = place[OWNER_B], place[BODY_B]
        if owner == 0:
            lightness = floats(body, BODY_WORDS)[MASS_INVERSE]
            if lightness > 0.0:
                return 1.0 / lightness
            continue
        mass, t = 0.0, views.control(owner)
        weight = views.weight(t)
        for i in range(t[at.MOVING]):
            mass += weight[i, INERTIA_M]
        least = min(least, mass)
    return least


@kernel
def sum_of(head, entry):  # type: ignore[no-untyped-def]
    """An entry of the ledgers of a group, summed [J]."""
    total, c = 0.0, head
    while c != 0:
        t = views.control(c)
        total += views.ledger(t)[entry]
        c = t[at.NEXT]
    return total


@kernel
def go_over(head):  # type: ignore[no-untyped-def]
    """A blow is over: go on in whole steps, or where nothing damps these, in parts that grow to them."""
    settings = views.settings(views.control(head))
    if settings[WANTED_BETA] == 0.0 or settings[UNDAMPED] != AFTER_IMPULSES:
        forget(head)
        return
    c = head
    while c != 0:
        t = views.control(c)
        if views.settings(t)[OVER_AT] == 0.0:
            views.settings(t)[OVER_AT] = views.settings(t)[BLOW_AGE]
        c = t[at.NEXT]


@kernel
def forget(head):  # type: ignore[no-untyped-def]
    """A blow is over, and steps are taken whole."""
    c = head
    while c != 0:
        t = views.control(c)
        views.settings(t)[BLOW] = 0.0
        c = t[at.NEXT]
