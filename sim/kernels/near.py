"""Contacts that come, go and turn within a step that is taken in parts.

Chipmunk finds contacts once a step, where it has moved the bodies to. What is near then is gathered at the beginning of
a step that may be taken in parts: pairs of shapes, one of them the structure's. In each part Chipmunk's own function
for two shapes (`sim.near`) tells where the surfaces of a pair are nearest, how far apart, and along which normal, if
they may come to meet. Such contacts stand in for those of the same two bodies that Chipmunk found, which are out of
date once bodies have gone back to where they touched; their impulses these get in the end.

It is asked again once surfaces may have moved by more than it has looked ahead, a few parts' way. What is near but
never touched is left as it was.
"""

import math

from sim.chipmunk import (
    BODY_WORDS,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blow import WORTH_OF_BLOW, striking_mass
from sim.kernels.bodies import put
from sim.kernels.late import behind_in
from sim.kernels.layout import (
    BLOW,
    BODY_A,
    BODY_B,
    BOUNCE,
    EARLIER,
    FAR,
    GAP,
    HASH,
    INDEX_B,
    LEDGER_ELASTIC,
    LEDGER_KINETIC,
    MARGIN,
    NEXT_MOVE,
    OTHER_START,
    OWNER_B,
    PUSH,
    REACH,
    SUDDEN,
    TRAVEL,
    WHERE,
    WHOLE_ONLY,
    WHOLE_STEP,
)
from sim.kernels.lengths import LONGEST_PART
from sim.kernels.noted import IN_PARTS, LOOSE_WORDS, ask
from sim.kernels.owners import home, unite
from sim.kernels.reached import index_in
from sim.kernels.rows import copy_contact, own_velocity
from sim.memory import floats, inlined, kernel

# How many parts' way ahead contacts are looked for, and the least way, over the reach of a shape.
_AHEAD, _LEAST = 4.0, 0.01


@inlined
def gather(c, t):  # type: ignore[no-untyped-def]
    """Have Python list what is near a structure, if its step may be taken in parts, and form a group with it."""
    t[at.NEAR] = 0
    if not may_be_in_parts(c, t):
        return
    ask(t, at.GATHER)
    places = views.places(t)
    for k in range(t[at.CONTACTS], t[at.CONTACTS] + t[at.NEAR]):
        place = places[k]
        place[OWNER_B], place[INDEX_B] = home(c, place[BODY_B])
        if place[OWNER_B] != 0:
            unite(c, place[OWNER_B])


@inlined
def may_be_in_parts(c, t):  # type: ignore[no-untyped-def]
    """Whether a blow lasts or may begin, as far as is known before forces have acted."""
    settings, ledger = views.settings(t), views.ledger(t)
    if t[at.FAULT] >= 0 or settings[WHOLE_STEP] <= LONGEST_PART or settings[WHOLE_ONLY] != 0.0 or t[at.SPREAD] == 1:
        return False
    if settings[BLOW] > 0.0 or settings[SUDDEN] > 0.0:
        return True
    places, touches, start = views.places(t), views.touches(t), views.per_body(t, at.START_VELOCITY)
    worth = WORTH_OF_BLOW * (ledger[LEDGER_KINETIC] + ledger[LEDGER_ELASTIC])
    for k in range(t[at.CONTACTS]):
        speed = touches[k, OTHER_START] + own_velocity(c, places[k], touches[k], 0, start)
        if speed < 0.0 and 0.5 * striking_mass(places[k]) * speed * speed > worth:
            return True
    return False


@kernel
def let_come(head):  # type: ignore[no-untyped-def]
    """Count what is near among the contacts of a group; whether there is any."""
    found, c = False, head
    while c != 0:
        t = views.control(c)
        t[at.CONTACTS] += t[at.NEAR]
        found = found or t[at.NEAR] > 0
        views.settings(t)[MARGIN] = 0.0
        c = t[at.NEXT]
    return found


@kernel
def stand_in(head):  # type: ignore[no-untyped-def]
    """Have the contacts of a pair stand in for those that Chipmunk found of the same two bodies."""
    c = head
    while c != 0:
        t = views.control(c)
        places, touches = views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS] - t[at.NEAR], t[at.CONTACTS]):
            other = head
            while other != 0:
                replace(views.control(other), places[k], touches[k])
                other = views.control(other)[at.NEXT]
        c = t[at.NEXT]


@kernel
def replace(t, place, touch):  # type: ignore[no-untyped-def]
    """Have a contact stand in for the first of Chipmunk's that nothing stands in for yet.

    A second one between two bodies stands in for the same as the first where there is only one.
    """
    a, b = place[BODY_A], place[BODY_B]
    places, touches = views.places(t), views.touches(t)
    for k in range(t[at.CONTACTS] - t[at.NEAR]):
        p = places[k]
        if (p[BODY_A] == a and p[BODY_B] == b) or (p[BODY_A] == b and p[BODY_B] == a):
            touch[BOUNCE], touch[PUSH] = max(touch[BOUNCE], touches[k, BOUNCE]), max(touch[PUSH], touches[k, PUSH])
            place[HASH] = p[WHERE]
            if touches[k, GAP] < FAR:
                touches[k, GAP] = FAR
                return


@kernel
def look(head):  # type: ignore[no-untyped-def]
    """Find the contacts of a group anew where they may be out of date by the end of the part that begins."""
    c = head
    while c != 0:
        t = views.control(c)
        if t[at.NEAR] > 0:
            settings = views.settings(t)
            fastest, least = speeds(t)
            way = settings[NEXT_MOVE] * fastest
            settings[TRAVEL] += way
            if settings[TRAVEL] > settings[MARGIN] or settings[MARGIN] == 0.0:
                settings[MARGIN], settings[TRAVEL] = max(_AHEAD * way, _LEAST * least), way
                ask(t, at.LOOK)
        c = t[at.NEXT]


@kernel
def speeds(t):  # type: ignore[no-untyped-def]
    """Greatest speed at which surfaces near a structure may close [m/s], and least reach of its shapes there [m]."""
    places, touches, fastest, least = views.places(t), views.touches(t), 0.0, math.inf
    for k in range(t[at.CONTACTS] - t[at.NEAR], t[at.CONTACTS]):
        a, b = floats(places[k, BODY_A], BODY_WORDS), floats(places[k, BODY_B], BODY_WORDS)
        speed = math.hypot(b[VX] - a[VX], b[VX + 1] - a[VX + 1])
        speed += abs(a[SPIN]) * touches[k, REACH] + abs(b[SPIN]) * touches[k, REACH + 1]
        fastest, least = max(fastest, speed), min(least, touches[k, REACH])
    return fastest, least


@kernel
def fall_behind(head, others, pushes, free):  # type: ignore[no-untyped-def]
    """Where parts have moved a loose body in the last step, have its ``free`` velocity half a step behind (`late`)."""
    for i in range(len(others)):
        ahead = 0.5 - behind_in(head, others[i])
        for axis in range(3):
            free[i, axis] -= ahead * pushes[i, axis]


@kernel
def let_go(head, others, mates, pushes, begun, free, rows):  # type: ignore[no-untyped-def]
    """Before the last part, put bodies that were near but not touched back to how they would be without the group.

    But for its ``mates``, which go with what was touched.
    """
    for i in range(len(others)):
        if index_in(mates, others[i]) < 0 and is_only_near(head, others[i]):
            b = floats(others[i], BODY_WORDS)
            put(others[i], begun[i, 0], begun[i, 1], begun[i, 2])
            b[VX], b[VX + 1], b[SPIN] = free[i, 0], free[i, 1], free[i, 2]
            if rows[i] != 0:
                floats(rows[i], LOOSE_WORDS)[IN_PARTS], rows[i] = math.nan, 0
            for axis in range(3):
                pushes[i, axis] = 0.0
            c = head
            while c != 0:
                forget_body(views.control(c), others[i])
                c = views.control(c)[at.NEXT]


@kernel
def is_only_near(head, body):  # type: ignore[no-untyped-def]
    """Whether a body is near a group, and nothing of it has touched or may still do so in this step."""
    near, c = False, head
    while c != 0:
        t = views.control(c)
        places, touches = views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS]):
            if places[k, BODY_B] == body or places[k, BODY_A] == body:
                if k < t[at.CONTACTS] - t[at.NEAR] or touches[k, GAP] < FAR or touches[k, EARLIER] != 0.0:
                    return False
                near = True
        c = t[at.NEXT]
    return near


@kernel
def forget_body(t, body):  # type: ignore[no-untyped-def]
    """Take a body that is only near out of the contacts of a structure."""
    places, touches = views.places(t), views.touches(t)
    first = t[at.CONTACTS] - t[at.NEAR]
    count = first
    for k in range(first, t[at.CONTACTS]):
        if places[k, BODY_A] != body and places[k, BODY_B] != body:
            copy_contact(places, touches, k, places, touches, count)
            count += 1
    t[at.CONTACTS], t[at.NEAR] = count, count - first


@kernel
def hand_over(t):  # type: ignore[no-untyped-def]
    """Give Chipmunk's contacts the impulses of those that stood in for them."""
    places = views.places(t)
    for k in range(t[at.CONTACTS] - t[at.NEAR], t[at.CONTACTS]):
        if places[k, HASH] != 0:
            own, contact = floats(places[k, WHERE], CONTACT_WORDS), floats(places[k, HASH], CONTACT_WORDS)
            contact[CONTACT_NORMAL_IMPULSE] += own[CONTACT_NORMAL_IMPULSE]
            contact[CONTACT_TANGENT_IMPULSE] += own[CONTACT_TANGENT_IMPULSE]


@kernel
def drop_all(head):  # type: ignore[no-untyped-def]
    """Forget what is near a group whose step is taken whole after all."""
    c = head
    while c != 0:
        t = views.control(c)
        drop(t)
        c = t[at.NEXT]


@inlined
def drop(t):  # type: ignore[no-untyped-def]
    """Forget what is near: Chipmunk itself finds what still touches at the start of the next step."""
    if t[at.NEAR] > 0:
        t[at.NEAR] = 0
        ask(t, at.DROP)
