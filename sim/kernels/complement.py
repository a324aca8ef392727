"""Contact impulses of a group of structures, solved through the structures.

They are solved on G, see `delassus`. Per contact, with relative velocity v along its normal n and tangent t,
restitution and friction are

    j_n ≥ 0,  v_n ≥ v_bounce,  one of them with equality;   |j_t| ≤ μ j_n,  v_t = 0 unless at the limit.
"""

import math

import numpy as np

from sim.chipmunk import (
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.active_rows import relax, solve_directly
from sim.kernels.bare import hold, rows_of
from sim.kernels.blocks import factorise_matrix, solve
from sim.kernels.delassus import note_velocities, operator
from sim.kernels.layout import (
    FAR,
    FRICTION,
    GAP,
    INVERSE_I,
    INVERSE_M,
    STEP,
    WANTED,
    WHERE,
)
from sim.kernels.links import links_of, pull
from sim.kernels.overlap import push_apart
from sim.kernels.residual import descend, reach_of
from sim.kernels.rows import copy_contact, loose_velocity, push_loose, sum_up
from sim.memory import floats, kernel

#: Bare arrays over those that `gather_contacts` gives.
bare_places, bare_touches = rows_of(at.PLACE_WORDS), rows_of(at.TOUCH_WORDS)
#: What `touch` gives when an impulse is not a number: nothing was changed then.
NOT_FINITE = -1.0
# Constraints of loose bodies agree once a sweep changes so much of what one did at the most, as energies, or of all.
_AGREED, _STILL = 1e-10, 1e-20
# How many times sweeps are tried, so many at a time, with rows solved directly in between; and most sweeps where
# constraints take part in them.
_MOST_DIRECT, _SWEEPS, _WITH_LINKS = 16, 50, 200
# Sweeps that become shorter by less than this go on for long, and are left where the energy of what is still to come,
# as a share of all, is no more than that: well below the square of what joints and contacts agree to (`settle`), or
# they have turn after turn about what was left.
_SLOW, _LITTLE = 0.9, 1e-15


@kernel
def count_contacts(head):  # type: ignore[no-untyped-def]
    """How many contacts a group of structures has whose surfaces are not too far apart to meet."""
    count, c = 0, head
    while c != 0:
        t = views.control(c)
        touches = views.touches(t)
        for k in range(t[at.CONTACTS]):
            count += touches[k, GAP] < FAR
        c = t[at.NEXT]
    return count


@kernel
def gather_contacts(head):  # type: ignore[no-untyped-def]
    """Contacts of all structures of a group, but those whose surfaces are too far apart to meet."""
    count = count_contacts(head)
    places, touches = np.empty((count, at.PLACE_WORDS), np.int64), np.empty((count, at.TOUCH_WORDS))
    count, c = 0, head
    while c != 0:
        t = views.control(c)
        own, own_touches = views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS]):
            if own_touches[k, GAP] >= FAR:
                continue
            copy_contact(own, own_touches, k, places, touches, count)
            count += 1
        c = t[at.NEXT]
    return places, touches


@kernel
def touch(head, last):  # type: ignore[no-untyped-def]
    """Solve a group's contacts as it now stands; returns by how much their impulses changed, or `NOT_FINITE`.

    With what is in ``last``, see `relax`, they may be changed by less than that.
    """
    places, touches = gather_contacts(head)
    largest = touch_all(head, last, bare_places(places), bare_touches(touches))
    hold(places, touches)
    return largest


@kernel
def touch_all(head, last, places, touches):  # type: ignore[no-untyped-def]
    """The same for these contacts.

    Of many that are near, as corners of bricks are, few are in the way: only those are solved, and what comes to be in
    the way by that with them.
    """
    count, largest = len(places), 0.0
    factorise_group(head)
    v, change, needed = np.empty(2 * count), np.zeros(2 * count), np.zeros(count, np.bool_)
    many = -1 if len(links_of(head)) > 0 else 0
    note_velocities(head, places, touches, change, v)
    while many < count and note_needed(places, touches, v, needed) > many:
        index = np.nonzero(needed)[0]
        many = len(index)
        own, own_touches = np.empty((many, at.PLACE_WORDS), np.int64), np.empty((many, at.TOUCH_WORDS))
        of_own, change_of_own = np.empty(2 * many), np.zeros(2 * many)
        for m in range(many):
            k = index[m]
            copy_contact(places, touches, k, own, own_touches, m)
            of_own[2 * m], of_own[2 * m + 1] = v[2 * k], v[2 * k + 1]
        p, t = bare_places(own), bare_touches(own_touches)
        largest = max(largest, complement(head, p, t, operator(p, t), of_own, change_of_own))
        hold(own, own_touches)
        if not math.isfinite(largest):
            return NOT_FINITE
        for m in range(many):
            change[2 * index[m]] += change_of_own[2 * m]
            change[2 * index[m] + 1] += change_of_own[2 * m + 1]
        if many < count:
            note_velocities(head, places, touches, change, v)
    if len(last) > 0:
        relax(places, touches, change, last)
    c = head
    while c != 0:
        t = views.control(c)
        strike(c, t, places, touches, change)
        c = t[at.NEXT]
    if views.control(head)[at.PUSHED_APART] == 0:
        views.control(head)[at.PUSHED_APART] = 1
        push_apart(head, places, touches)
    return largest


@kernel
def note_needed(places, touches, v, needed):  # type: ignore[no-untyped-def]
    """Note which contacts press, or would have to; returns how many."""
    count = 0
    for k in range(len(places)):
        presses = floats(places[k, WHERE], CONTACT_WORDS)[CONTACT_NORMAL_IMPULSE] != 0.0
        needed[k] = needed[k] or presses or not v[2 * k] >= touches[k, WANTED]
        count += needed[k]
    return count


@kernel
def factorise_group(head):  # type: ignore[no-untyped-def]
    """Factorise H of every structure of a group."""
    c = head
    while c != 0:
        t = views.control(c)
        factorise_matrix(t, views.settings(t)[STEP] * reach_of(t))
        c = t[at.NEXT]


@kernel
def complement(head, places, touches, g, v, change):  # type: ignore[no-untyped-def]
    """Solve for the accumulated impulses on G; changes them and loose bodies' velocities.

    By projected Gauss–Seidel, and what that leaves is found directly where it would take forever, as on two points of a
    body that is light beside the structure. Constraints between loose bodies have their turn in every sweep, see
    `links`. Returns the largest change of an impulse over the largest one; where that is not finite, loose bodies may
    be anywhere.
    """
    rows, links, pushed = len(v), links_of(head), np.zeros(len(v))
    for _ in range(_MOST_DIRECT):
        if sweep(head, links, places, touches, g, v, change, pushed) or len(links) > 0:
            break
        solve_directly(places, touches, g, v, change)
    give(places, touches, change, pushed)
    largest, size = 0.0, 0.0
    for r in range(rows):
        size = max(size, floats(places[r >> 1, WHERE], CONTACT_WORDS)[CONTACT_NORMAL_IMPULSE])
        # Added, and not compared, so that no number that is not finite slips through.
        largest = max(largest, abs(change[r])) + 0.0 * change[r]
    return largest / size if size > 0.0 else largest


@kernel
def sweep(head, links, places, touches, g, v, change, pushed):  # type: ignore[no-untyped-def]
    """Projected Gauss–Seidel on G, from the accumulated impulses on; whether they agree in the end."""
    rows, h, most, before = len(v), views.settings(views.control(head))[STEP], 0.0, math.inf
    for _ in range(_WITH_LINKS if len(links) > 0 else _SWEEPS):
        moved, size, agreed = 0.0, 0.0, True
        for r in range(rows):
            if g[r, r] <= 0.0:
                continue
            touch = touches[r >> 1]
            c = floats(places[r >> 1, WHERE], CONTACT_WORDS)
            if r & 1:
                limit = touch[FRICTION] * c[CONTACT_NORMAL_IMPULSE]
                old = c[CONTACT_TANGENT_IMPULSE]
                new = min(max(old - v[r] / g[r, r], -limit), limit)
                c[CONTACT_TANGENT_IMPULSE] = new
            else:
                old = c[CONTACT_NORMAL_IMPULSE]
                new = max(old + (touch[WANTED] - v[r]) / g[r, r], 0.0)
                c[CONTACT_NORMAL_IMPULSE] = new
            step = new - old
            size = max(size, abs(new))
            if step != 0.0:
                moved = max(moved, abs(step))
                change[r] += step
                for k in range(rows):
                    v[k] += g[r, k] * step
        if len(links) > 0:
            give(places, touches, change, pushed)
            of_change, of_all = pull_all(links, h, places, touches, v)
            most = max(most, of_change)
            agreed = of_change <= _AGREED * most + _STILL * of_all
        if moved <= 1e-10 * size and agreed:
            return True
        if agreed and moved > _SLOW * before and moved * moved <= _LITTLE * size * size * (1.0 - moved / before):
            return True
        before = moved
    return False


@kernel
def give(places, touches, change, pushed):  # type: ignore[no-untyped-def]
    """Give loose bodies what impulses have changed by, but for what has been ``pushed`` before."""
    for r in range(len(change)):
        push_loose(places[r >> 1], touches[r >> 1], r, change[r] - pushed[r], VX, SPIN)
        pushed[r] = change[r]


@kernel
def pull_all(links, h, places, touches, v):  # type: ignore[no-untyped-def]
    """Solve constraints of loose bodies once, see `pull`; their contacts' velocities ``v`` change with theirs."""
    for r in range(len(v)):
        v[r] -= loose_velocity(places[r >> 1], touches[r >> 1], r)
    of_change, of_all = pull(links, h)
    for r in range(len(v)):
        v[r] += loose_velocity(places[r >> 1], touches[r >> 1], r)
    return of_change, of_all


@kernel
def strike(c, t, places, touches, change):  # type: ignore[no-untyped-def]
    """Apply changed contact impulses to a structure's bodies, and let its joints take their part of them."""
    sum_up(c, places, touches, change, views.per_body(t, at.SOLUTION))
    transmit(t, views.per_body(t, at.CONTACT_IMPULSE))


@kernel
def transmit(t, booked):  # type: ignore[no-untyped-def]
    """Apply the impulses in `SOLUTION` to a structure's bodies, add them to what is ``booked``, and tell its joints."""
    solution, velocity, weight = views.per_body(t, at.SOLUTION), views.per_body(t, at.VELOCITY), views.weight(t)
    for i in range(t[at.MOVING]):
        x, y, w = solution[i, 0], solution[i, 1], solution[i, 2]
        if x != 0.0 or y != 0.0 or w != 0.0:
            booked[i, 0] += x
            booked[i, 1] += y
            booked[i, 2] += w
            velocity[i, 0] += x * weight[i, INVERSE_M]
            velocity[i, 1] += y * weight[i, INVERSE_M]
            velocity[i, 2] += w * weight[i, INVERSE_I]
    # H ΔV = J_cᵀ Δj, and Δλ = -(β + δ) h² D J ΔV.
    solve(t, 0, solution)
    descend(t, views.settings(t)[STEP] * reach_of(t), 0.0)
