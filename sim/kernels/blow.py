"""When a step is taken in parts: as long as a blow lasts.

Implicit Euler takes ½ Δv·M Δv from what changes its velocities by Δv in a step, and a contact acts over whole steps. A
body of speed v that is stopped within N steps so loses the N-th part of its energy to the time integration. At 60 Hz a
falling crate is stopped within four. So a step of more than half a millisecond is taken in parts of at most that, see
`parts`, from a blow on until it is over:

- a blow is a contact with a speed of approach beyond what outer forces give in two steps (what is laid down on a
  structure, or rests on it, is none), and with more than a thousandth of the structure's kinetic and elastic
  energy;
- it is over when the structure has turned: nothing flows any more, and what it stores does not grow; or when whole
  steps would lose less than 0.5 % of the blow's energy in a 60th of a second. What n parts lose is known, and a whole
  step loses n times that.

So the largest and the lasting deflection are found at any step; what swings behind them is damped as ever. Nothing is
spent on this where nothing is hit. Vehicles and other bodies with constraints of Chipmunk's own, which know whole steps
only, are left to those; and a structure that falls on what is held does so in whole steps, too.
"""

import math

from sim.chipmunk import BODY_FULL_WORDS, BODY_WORDS, CONSTRAINTS, MASS_INVERSE
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.complement import relative
from sim.kernels.layout import (
    BLOW,
    BODY_A,
    BODY_B,
    INERTIA_M,
    LEDGER_ELASTIC,
    LEDGER_KINETIC,
    OTHER_START,
    OWNER_A,
    OWNER_B,
    STRIKE,
    WHOLE_STEP,
)
from sim.kernels.rows import own_velocity
from sim.memory import floats, integers, kernel

#: Longest part of a step while a blow lasts [s].
LONGEST_PART = 0.5e-3
# Over what outer forces give in a step.
_SUDDEN = 2.0
# Of the structure's energy.
_WORTH = 1e-3
#: Of the blow's energy, lost in a second [1/s].
OVER = 0.3


@kernel
def count_parts(head):  # type: ignore[no-untyped-def]
    """In how many parts a group of structures takes the step that begins."""
    parts = math.ceil(views.settings(views.control(head))[WHOLE_STEP] / LONGEST_PART - 1e-6)
    if parts <= 1:
        return 1
    energy, lasting, new, c = 0.0, 0.0, 0.0, head
    while c != 0:
        t = views.control(c)
        if t[at.SPREAD] == 1:
            return 1
        ledger = views.ledger(t)
        energy += ledger[LEDGER_KINETIC] + ledger[LEDGER_ELASTIC]
        lasting = max(lasting, views.settings(t)[BLOW])
        places, touches = views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS]):
            if is_joined(places[k]):
                return 1
            touches[k, STRIKE] = speed = approach(c, places[k], touches[k])
            if speed > 0.0:
                new = max(new, 0.5 * striking_mass(places[k]) * speed * speed)
        c = t[at.NEXT]
    if new > _WORTH * energy:
        lasting = max(lasting, new)
    c = head
    while c != 0:
        t = views.control(c)
        views.settings(t)[BLOW] = lasting
        c = t[at.NEXT]
    return parts if lasting > 0.0 else 1


@kernel
def approach(c, place, touch):  # type: ignore[no-untyped-def]
    """Speed with which the bodies of a contact of structure ``c`` meet, if they meet suddenly; or 0."""
    before = touch[OTHER_START] + own_velocity(c, place, touch, 0, views.per_body(views.control(c), at.START_VELOCITY))
    pushed = abs(relative(place, touch, 0) - before)
    return -before if -before > _SUDDEN * pushed else 0.0


@kernel
def striking_mass(place):  # type: ignore[no-untyped-def]
    """Mass of the loose body that strikes, or of the lighter structure where none does; 0 on held ground [kg]."""
    least = math.inf
    for side in range(2):
        owner, body = place[OWNER_A], place[BODY_A]
        if side == 1:
            owner, body = place[OWNER_B], place[BODY_B]
        if owner == 0:
            lightness = floats(body, BODY_WORDS)[MASS_INVERSE]
            return 1.0 / lightness if lightness > 0.0 else 0.0
        mass, t = 0.0, views.control(owner)
        weight = views.weight(t)
        for i in range(t[at.MOVING]):
            mass += weight[i, INERTIA_M]
        least = min(least, mass)
    return least


@kernel
def is_joined(place):  # type: ignore[no-untyped-def]
    """Whether the loose body of a contact is a part of something else, by constraints that Chipmunk solves."""
    loose = place[BODY_A] if place[OWNER_A] == 0 else place[BODY_B]
    if place[OWNER_A] != 0 and place[OWNER_B] != 0:
        return False
    return floats(loose, BODY_WORDS)[MASS_INVERSE] > 0.0 and integers(loose, BODY_FULL_WORDS)[CONSTRAINTS] != 0


@kernel
def elastic_energy(head):  # type: ignore[no-untyped-def]
    """Elastic energy of a group [J]."""
    total, c = 0.0, head
    while c != 0:
        t = views.control(c)
        total += views.ledger(t)[LEDGER_ELASTIC]
        c = t[at.NEXT]
    return total


@kernel
def flows(head):  # type: ignore[no-untyped-def]
    """Whether any joint of a group flowed last."""
    c = head
    while c != 0:
        t = views.control(c)
        if t[at.FLOWING] == 1:
            return True
        c = t[at.NEXT]
    return False


@kernel
def forget(head):  # type: ignore[no-untyped-def]
    """A blow is over."""
    c = head
    while c != 0:
        t = views.control(c)
        views.settings(t)[BLOW] = 0.0
        c = t[at.NEXT]
