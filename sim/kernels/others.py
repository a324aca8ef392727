"""The bodies that move with a group of structures but are not solved with it: loose ones, and held ones that move.

A step taken in parts moves them along: they are found once, gathered by address, and put back in the end.
"""

import numpy as np

from sim.chipmunk import ANGLE, BIAS_SPIN, BIAS_VX, BODY_FULL_WORDS, BODY_WORDS, MASS_INVERSE, SPIN, VX, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bodies import move
from sim.kernels.contacts import push_loose
from sim.kernels.layout import BODY_A, BODY_B, CACHED, LOOSE_START, OWNER_A, OWNER_B, WHOLE_RATIO
from sim.memory import floats, kernel


@kernel
def others_of(head):  # type: ignore[no-untyped-def]
    """Addresses of the bodies that move with a group's but are not solved with it: loose ones, and moving held ones."""
    room, c = 0, head
    while c != 0:
        t = views.control(c)
        room += t[at.CONTACTS] + t[at.BODIES] - t[at.MOVING]
        c = t[at.NEXT]
    found, count, c = np.empty(room, np.int64), 0, head
    while c != 0:
        t = views.control(c)
        places, body_at = views.places(t), views.body_at(t)
        for k in range(t[at.CONTACTS]):
            for side in range(2):
                owner, body = (
                    (places[k, OWNER_A], places[k, BODY_A]) if side == 0 else (places[k, OWNER_B], places[k, BODY_B])
                )
                if owner == 0:
                    count = note(found, count, body)
        for i in range(t[at.MOVING], t[at.BODIES]):
            count = note(found, count, body_at[i])
        c = t[at.NEXT]
    return found[:count]


@kernel
def note(found, count, body):  # type: ignore[no-untyped-def]
    """Add a body that moves to those found, once; returns how many there are."""
    b = floats(body, BODY_WORDS)
    if b[MASS_INVERSE] == 0.0 and b[VX] == 0.0 and b[VX + 1] == 0.0 and b[SPIN] == 0.0:
        return count
    for i in range(count):
        if found[i] == body:
            return count
    found[count] = body
    return count + 1


@kernel
def which(others, place):  # type: ignore[no-untyped-def]
    """Where the loose body of a contact is among the others, or -1."""
    for i in range(len(others)):
        if (place[OWNER_A] == 0 and place[BODY_A] == others[i]) or (place[OWNER_B] == 0 and place[BODY_B] == others[i]):
            return i
    return -1


@kernel
def release(head, others):  # type: ignore[no-untyped-def]
    """Take back what was done to the others so far; returns how forces from outside change their velocities."""
    pushes, c = np.zeros((len(others), 3)), head
    while c != 0:
        t = views.control(c)
        places, touches, ratio = views.places(t), views.touches(t), views.settings(t)[WHOLE_RATIO]
        for k in range(t[at.CONTACTS]):
            for row in range(2):
                push_loose(places[k], touches[k], row, -ratio * touches[k, CACHED + row], VX, SPIN)
        c = t[at.NEXT]
    c = head
    while c != 0:
        t = views.control(c)
        places, touches = views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS]):
            i = which(others, places[k])
            if i >= 0:
                b = floats(others[i], BODY_WORDS)
                for axis in range(3):
                    at_start = touches[k, LOOSE_START + axis]
                    word = SPIN if axis == 2 else VX + axis
                    if b[word] != at_start:
                        pushes[i, axis] = b[word] - at_start
                        b[word] = at_start
        c = t[at.NEXT]
    return pushes


@kernel
def load_others(others, out):  # type: ignore[no-untyped-def]
    """Velocities of the others."""
    for i in range(len(others)):
        b = floats(others[i], BODY_WORDS)
        out[i, 0], out[i, 1], out[i, 2] = b[VX], b[VX + 1], b[SPIN]


@kernel
def put_back(body, place, h, whole):  # type: ignore[no-untyped-def]
    """Put a body back to ``place``, from where the next ``whole`` step moves it to what is a part ``h`` from here."""
    b = floats(body, BODY_FULL_WORDS)
    x, y, turn = b[X] - place[0], b[X + 1] - place[1], b[ANGLE] - place[2]
    move(body, -x, -y, -turn)
    b[BIAS_VX] += (x + h * b[VX]) / whole - b[VX]
    b[BIAS_VX + 1] += (y + h * b[VX + 1]) / whole - b[VX + 1]
    b[BIAS_SPIN] += (turn + h * b[SPIN]) / whole - b[SPIN]
