"""Loose bodies: those that no ductile joint holds, how they move, and what bears on them at contacts."""

import math

import numpy as np
from numba import njit

from sim.chipmunk import (
    ARBITER_BODY_A,
    ARBITER_BODY_B,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_NORMAL,
    ARBITER_STATE,
    ARBITER_WORDS,
    ARBITERS,
    BODY_FULL_WORDS,
    CONSTRAINTS,
    CONTACT_BYTES,
    CONTACT_HASH,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_R1,
    CONTACT_WORDS,
    FIRST,
    MASS,
    MOMENT,
    SPIN,
    VX,
)
from sim.kernels.owners import next_arbiter, owner_of
from sim.memory import floats, integers

#: Kinds of bodies: in a structure; loose, and loose with constraints of Chipmunk's own; static or kinematic.
JOINED, LOOSE, TIED, HELD = 0, 1, 2, 3


@njit(cache=True, error_model="numpy")
def read(addresses, functions):  # type: ignore[no-untyped-def]
    """Kinds of the bodies at ``addresses``, their velocities and masses, (n, 3) each."""
    n = len(addresses)
    kind, velocity, mass = np.empty(n, np.int64), np.empty((n, 3)), np.empty((n, 3))
    for i in range(n):
        b = floats(addresses[i], BODY_FULL_WORDS)
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = b[VX], b[VX + 1], b[SPIN]
        mass[i, 0], mass[i, 1], mass[i, 2] = b[MASS], b[MASS], b[MOMENT]
        if not math.isfinite(b[MASS]):
            kind[i] = HELD
        elif owner_of(addresses[i], functions) != 0:
            kind[i] = JOINED
        else:
            kind[i] = TIED if integers(addresses[i], BODY_FULL_WORDS)[CONSTRAINTS] != 0 else LOOSE
    return kind, velocity, mass


@njit(cache=True, error_model="numpy")
def touching(addresses, order, kind):  # type: ignore[no-untyped-def]
    """Contacts of loose bodies, each once.

    Returns rows of arbiter's address, hash, the two bodies' indices (-1 for one that is not listed), whether their
    shapes did not touch before, and its own address, and rows of normal, arms, and normal and tangential impulse;
    ``order`` sorts the addresses.
    """
    count = 0
    for fill in range(2):
        if fill == 1:
            places, touches = np.empty((count, 6), np.int64), np.empty((count, 8))
            count = 0
        for i in range(len(addresses)):
            if kind[i] != LOOSE and kind[i] != TIED:
                continue
            arbiter = integers(addresses[i], BODY_FULL_WORDS)[ARBITERS]
            while arbiter != 0:
                w, f = integers(arbiter, ARBITER_WORDS), floats(arbiter, ARBITER_WORDS)
                is_a = w[ARBITER_BODY_A] == addresses[i]
                j = index_of(w[ARBITER_BODY_B] if is_a else w[ARBITER_BODY_A], addresses, order)
                if is_a or j < 0 or (kind[j] != LOOSE and kind[j] != TIED):
                    for k in range(w[ARBITER_COUNT] & 0xFFFFFFFF):
                        if fill == 1:
                            where = w[ARBITER_CONTACTS] + CONTACT_BYTES * k
                            contact, p, t = floats(where, CONTACT_WORDS), places[count], touches[count]
                            p[0], p[1] = arbiter, integers(where, CONTACT_WORDS)[CONTACT_HASH]
                            p[2], p[3] = (i, j) if is_a else (j, i)
                            p[4] = 1 if w[ARBITER_STATE] & 0xFFFFFFFF == FIRST else 0
                            p[5] = where
                            t[0], t[1] = f[ARBITER_NORMAL], f[ARBITER_NORMAL + 1]
                            for m in range(4):
                                t[2 + m] = contact[CONTACT_R1 + m]
                            t[6], t[7] = contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_NORMAL_IMPULSE + 1]
                        count += 1
                arbiter = next_arbiter(arbiter, addresses[i])
    return places, touches


@njit(cache=True, error_model="numpy")
def index_of(body, addresses, order):  # type: ignore[no-untyped-def]
    """Where an address is listed, or -1."""
    low, high = 0, len(order)
    while low < high:
        middle = (low + high) // 2
        if addresses[order[middle]] < body:
            low = middle + 1
        else:
            high = middle
    return order[low] if low < len(order) and addresses[order[low]] == body else -1
