"""Joints, breaking, contacts and ties of a group of structures, in turn until they agree."""

import math

import numpy as np

from sim.chipmunk import CONTACT_NORMAL_IMPULSE, CONTACT_TANGENT_IMPULSE, CONTACT_WORDS
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.admissible import bear_no_more
from sim.kernels.approach import iterate
from sim.kernels.bare import hold
from sim.kernels.commit import weaken
from sim.kernels.complement import NOT_FINITE, bare_places, bare_touches, count_contacts, gather_contacts, touch
from sim.kernels.layout import CACHED, INERTIA_I, INERTIA_M, WHERE
from sim.kernels.restitution import MOST_HALVINGS, bounce_less, bounces, creates_energy
from sim.kernels.rows import sum_up
from sim.kernels.tie_impulses import solve_ties
from sim.memory import floats, kernel

_MOST_ROUNDS = 40
_SETTLED = 1e-6
# Rounds after which contacts and joints are taken to go round in circles.
_PATIENCE = 8
# Residuals, as shares of the velocities, from which on joints may bear what they cannot.
_ROUNDING = 1e-13


@kernel
def settle(c, fresh, touching):  # type: ignore[no-untyped-def]
    """Solve joints, breaking, contacts and ties in turn until they agree; whether they do."""
    predicting, first, tied, struck, pulled = fresh, True, False, 0.0, 0.0
    last = np.zeros(0)
    for turn in range(_MOST_ROUNDS + 1):
        change, taken, converged = 0.0, 0, True
        member = c
        while member != 0:
            t = views.control(member)
            steps, done, views.settings(t)[at.LAST_RESIDUAL] = iterate(t, predicting)
            t[at.NEWTON_STEPS] += steps
            taken, converged, tied = taken + steps, converged and done, tied or t[at.TIED] > 0
            if t[at.BREAKABLE] == 1:
                change = max(change, weaken(t))
            member = t[at.NEXT]
        if turn == _MOST_ROUNDS:
            break  # the joints have had the last word, and none bears more than it can
        # Contacts and ties are exact for the tangents they were solved with: once the joints agree, and they with each
        # other, nothing is left to do.
        anew = first or taken > 0 or (len(last) > 0 and last[-1] < 1.0)
        predicting, first = False, False
        if touching:
            if turn == _PATIENCE:
                last = np.zeros(2 * count_contacts(c) + 1)
            struck = touch(c, last) if anew or pulled > _SETTLED else 0.0
        if tied:
            pulled = solve_ties(c) if anew or struck > _SETTLED else 0.0
        if struck == NOT_FINITE or pulled == NOT_FINITE:
            views.control(c)[at.FAULT] = 0
            return True
        change = max(change, struck, pulled)
        if change <= _SETTLED:
            return converged
    return False


@kernel
def settle_bounces(c, fresh, touching):  # type: ignore[no-untyped-def]
    """Settle a group, with no bounce that would create energy; whether it converged."""
    converged = settle(c, fresh, touching)
    if touching and bounces(c):
        for k in range(MOST_HALVINGS):
            if views.control(c)[at.FAULT] >= 0 or not creates_energy(c):
                break
            bounce_less(c, 0.5 if k < MOST_HALVINGS - 1 else 0.0)
            # Not the constants False and True: Numba would compile all of it anew for them.
            converged = settle(c, not touching, touching)
    member = c
    while member != 0:
        t = views.control(member)
        if _ROUNDING < views.settings(t)[at.LAST_RESIDUAL] < math.inf and t[at.SPREAD] == 0:
            bear_no_more(t, not (touching or t[at.TIED] > 0))
        member = t[at.NEXT]
    return converged


@kernel
def book_cached(c):  # type: ignore[no-untyped-def]
    """Chipmunk has applied the contacts' cached impulses to the bodies: they did not come from outside.

    It scales what it applies by the ratio of the steps, but not what it keeps; all that was applied may be taken back.
    """
    member = c
    while member != 0:
        t = views.control(member)
        scale_cached(t, views.settings(t)[at.WHOLE_RATIO])
        member = t[at.NEXT]
    places, touches = gather_contacts(c)
    amounts = np.empty(2 * len(places))
    for r in range(len(amounts)):
        amounts[r] = touches[r >> 1, CACHED + (r & 1)]
    member = c
    while member != 0:
        t = views.control(member)
        solution = views.per_body(t, at.SOLUTION)
        external, struck = views.per_body(t, at.EXTERNAL), views.per_body(t, at.CONTACT_IMPULSE)
        sum_up(member, bare_places(places), bare_touches(touches), amounts, solution)
        for i in range(t[at.MOVING]):
            for axis in range(3):
                struck[i, axis] += solution[i, axis]
                external[i, axis] -= solution[i, axis]
        member = t[at.NEXT]
    hold(places, touches)


@kernel
def scale_cached(t, ratio):  # type: ignore[no-untyped-def]
    """Let contacts begin a step with what Chipmunk has applied of their impulses."""
    places, touches = views.places(t), views.touches(t)
    for k in range(t[at.CONTACTS] if ratio != 1.0 else 0):
        contact = floats(places[k, WHERE], CONTACT_WORDS)
        for row in range(2):
            touches[k, CACHED + row] *= ratio
            contact[CONTACT_TANGENT_IMPULSE if row == 1 else CONTACT_NORMAL_IMPULSE] *= ratio


@kernel
def finite(t):  # type: ignore[no-untyped-def]
    """Whether impulses, velocities and kinetic energies are finite; otherwise the fault is the first joint's."""
    impulse, velocity, weight = views.per_joint(t, at.IMPULSE), views.per_body(t, at.VELOCITY), views.weight(t)
    for k in range(t[at.JOINTS]):
        if not math.isfinite(impulse[k, 0] + impulse[k, 1] + impulse[k, 2]):
            t[at.FAULT] = k
            return False
    for i in range(t[at.MOVING]):
        x, y, w = velocity[i, 0], velocity[i, 1], velocity[i, 2]
        if not math.isfinite(weight[i, INERTIA_M] * (x * x + y * y) + weight[i, INERTIA_I] * w * w):
            t[at.FAULT] = first_joint_at(t, i)
            return False
    return t[at.FAULT] < 0


@kernel
def first_joint_at(t, body):  # type: ignore[no-untyped-def]
    """The first joint of a body."""
    joint_bodies = views.joint_bodies(t)
    for k in range(t[at.JOINTS]):
        if joint_bodies[k, 0] == body or joint_bodies[k, 1] == body:
            return k
    return 0
