"""Contact impulses of a group of structures, solved through the structures.

They are solved on

    G = J_c H⁻¹ J_cᵀ + J_c M_e⁻¹ J_cᵀ,   H = M + (β + δ) h² Jᵀ D J,

H for each structure with its present tangents and M_e for loose bodies. Per contact, with relative velocity v along its
normal n and tangent t, restitution and friction are

    j_n ≥ 0,  v_n ≥ v_bounce,  one of them with equality;   |j_t| ≤ μ j_n,  v_t = 0 unless at the limit.

Overlap is taken out by pseudo-velocities that move the bodies once and carry no momentum, through the structures, too.
"""

import math

import numpy as np

from sim.chipmunk import (
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_WORDS,
    MASS_INVERSE,
    MOMENT_INVERSE,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import factorise_matrix, solve
from sim.kernels.kinematics import rates
from sim.kernels.layout import (
    BODY_A,
    BODY_B,
    FRICTION,
    INDEX_A,
    INDEX_B,
    INVERSE_I,
    INVERSE_M,
    LEDGER_CONTACT,
    LEDGER_KINETIC,
    LEDGER_NUMERICAL,
    OWNER_A,
    OWNER_B,
    PUSH,
    STEP,
    SURFACE,
    WANTED,
    WHERE,
    WHOLE_STEP,
)
from sim.kernels.residual import advance, linearise, reach_of
from sim.kernels.rows import add_row, direction, other_velocity, own_velocity, push_loose
from sim.memory import clear, floats, kernel

_SWEEPS = 200
# Of the kinetic energy.
_FREE = 1e-9
#: What `touch` gives when an impulse is not a number: nothing was changed then.
NOT_FINITE = -1.0


@kernel
def gather_contacts(head):  # type: ignore[no-untyped-def]
    """Contacts of all structures of a group."""
    count, c = 0, head
    while c != 0:
        t = views.control(c)
        count += t[at.CONTACTS]
        c = t[at.NEXT]
    places, touches = np.empty((count, at.PLACE_WORDS), np.int64), np.empty((count, at.TOUCH_WORDS))
    count, c = 0, head
    while c != 0:
        t = views.control(c)
        own, own_touches = views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS]):
            for i in range(at.PLACE_WORDS):
                places[count, i] = own[k, i]
            for i in range(at.TOUCH_WORDS):
                touches[count, i] = own_touches[k, i]
            count += 1
        c = t[at.NEXT]
    return places, touches


@kernel
def touch(head):  # type: ignore[no-untyped-def]
    """Solve a group's contacts as it now stands; returns by how much their impulses changed, or `NOT_FINITE`."""
    places, touches = gather_contacts(head)
    count = len(places)
    c = head
    while c != 0:
        t = views.control(c)
        factorise_matrix(t, views.settings(t)[STEP] * reach_of(t))
        c = t[at.NEXT]
    g = operator(places, touches)
    v, change = np.empty(2 * count), np.zeros(2 * count)
    for r in range(2 * count):
        v[r] = relative(places[r >> 1], touches[r >> 1], r)
    largest = complement(places, touches, g, v, change)
    if not math.isfinite(largest):
        return NOT_FINITE
    for r in range(2 * count):
        push_loose(places[r >> 1], touches[r >> 1], r, change[r], VX, SPIN)
    c = head
    while c != 0:
        t = views.control(c)
        strike(c, t, places, touches, change)
        c = t[at.NEXT]
    if views.control(head)[at.PUSHED_APART] == 0:
        views.control(head)[at.PUSHED_APART] = 1
        push_apart(head, places, touches, g, v, change)
    return largest


@kernel
def relative(place, touch, row):  # type: ignore[no-untyped-def]
    """Velocity of b relative to a along a row, that of the surface included."""
    total = 0.0
    if place[OWNER_A] == 0 or place[OWNER_B] == 0:
        total = other_velocity(place[OWNER_A] + place[OWNER_B], place, touch, row)
    if place[OWNER_A] != 0:
        c = place[OWNER_A]
        total += own_velocity(c, place, touch, row, views.per_body(views.control(c), at.VELOCITY))
    if place[OWNER_B] != 0 and place[OWNER_B] != place[OWNER_A]:
        c = place[OWNER_B]
        total += own_velocity(c, place, touch, row, views.per_body(views.control(c), at.VELOCITY))
    if row & 1:
        total += touch[SURFACE]
    return total


@kernel
def operator(places, touches):  # type: ignore[no-untyped-def]
    """G for all contacts, by one substitution a column and structure."""
    rows = 2 * len(places)
    g = np.zeros((rows, rows))
    for k in range(rows):
        place, touch = places[k >> 1], touches[k >> 1]
        one, two = place[OWNER_A], place[OWNER_B]
        for side in range(2):
            c = two if side == 1 else one
            if c == 0 or (side == 1 and two == one):
                continue
            t = views.control(c)
            solution = views.per_body(t, at.SOLUTION)
            clear(solution)
            add_row(c, place, touch, k, 1.0, solution)
            first = t[at.MOVING]
            if one == c:
                first = min(first, place[INDEX_A])
            if two == c:
                first = min(first, place[INDEX_B])
            solve(t, first, solution)
            for r in range(rows):
                g[r, k] += own_velocity(c, places[r >> 1], touches[r >> 1], r, solution)
        if one == 0 or two == 0:
            loose = place[BODY_A] if one == 0 else place[BODY_B]
            b = floats(loose, BODY_FULL_WORDS)
            dx, dy, ma, mb = direction(touch, k)
            sign, moment = (-1.0, ma) if one == 0 else (1.0, mb)
            for r in range(rows):
                p = places[r >> 1]
                ex, ey, na, nb = direction(touches[r >> 1], r)
                theirs, arm = 0.0, 0.0
                if p[OWNER_A] == 0 and p[BODY_A] == loose:
                    theirs, arm = -1.0, na
                elif p[OWNER_B] == 0 and p[BODY_B] == loose:
                    theirs, arm = 1.0, nb
                g[r, k] += sign * theirs * ((dx * ex + dy * ey) * b[MASS_INVERSE] + moment * arm * b[MOMENT_INVERSE])
    return g


@kernel
def complement(places, touches, g, v, change):  # type: ignore[no-untyped-def]
    """Projected Gauss–Seidel on G; changes the accumulated impulses, returns the largest change over them."""
    rows = len(v)
    for _ in range(_SWEEPS):
        moved, size = 0.0, 0.0
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
                    v[k] += g[k, r] * step
        if moved <= 1e-10 * size:
            break
    largest, size = 0.0, 0.0
    for r in range(rows):
        size = max(size, floats(places[r >> 1, WHERE], CONTACT_WORDS)[CONTACT_NORMAL_IMPULSE])
        # Added, and not compared, so that no number that is not finite slips through.
        largest = max(largest, abs(change[r])) + 0.0 * change[r]
    return largest / size if size > 0.0 else largest


@kernel
def strike(c, t, places, touches, change):  # type: ignore[no-untyped-def]
    """Apply changed contact impulses to a structure's bodies, and let its joints take their part of them."""
    solution, velocity, weight = views.per_body(t, at.SOLUTION), views.per_body(t, at.VELOCITY), views.weight(t)
    sum_up(c, places, touches, change, solution)
    total = views.per_body(t, at.CONTACT_IMPULSE)
    for i in range(t[at.MOVING]):
        x, y, w = solution[i, 0], solution[i, 1], solution[i, 2]
        if x != 0.0 or y != 0.0 or w != 0.0:
            total[i, 0] += x
            total[i, 1] += y
            total[i, 2] += w
            velocity[i, 0] += x * weight[i, INVERSE_M]
            velocity[i, 1] += y * weight[i, INVERSE_M]
            velocity[i, 2] += w * weight[i, INVERSE_I]
    # H ΔV = J_cᵀ Δj, and Δλ = -(β + δ) h² D J ΔV.
    solve(t, 0, solution)
    linearise(t, views.settings(t)[STEP] * reach_of(t), 0.0)
    advance(t, 1.0)


@kernel
def sum_up(c, places, touches, amounts, out):  # type: ignore[no-untyped-def]
    """J_cᵀ times impulses of the rows, on the bodies of structure ``c``."""
    clear(out)
    for r in range(len(amounts)):
        add_row(c, places[r >> 1], touches[r >> 1], r, amounts[r], out)


@kernel
def push_apart(head, places, touches, g, v, change):  # type: ignore[no-untyped-def]
    """Pseudo-velocities that take out overlap, through the structures."""
    any_overlap = False
    for k in range(len(places)):
        v[2 * k], v[2 * k + 1] = 0.0, 0.0
        change[2 * k], change[2 * k + 1] = 0.0, 0.0
        any_overlap = any_overlap or touches[k, PUSH] > 0.0
    if not any_overlap:
        return
    for _ in range(_SWEEPS):
        moved, size = 0.0, 0.0
        for r in range(0, len(v), 2):
            if g[r, r] <= 0.0:
                continue
            new = max(change[r] + (touches[r >> 1, PUSH] - v[r]) / g[r, r], 0.0)
            step = new - change[r]
            size = max(size, new)
            if step != 0.0:
                moved = max(moved, abs(step))
                change[r] = new
                for k in range(0, len(v), 2):
                    v[k] += g[k, r] * step
        if moved <= 1e-6 * size:
            break
    share = share_to_push(head, places, touches, change)
    for r in range(0, len(v), 2):
        push_loose(places[r >> 1], touches[r >> 1], r, share * change[r], BIAS_VX, BIAS_SPIN)
    c = head
    while c != 0:
        t = views.control(c)
        solution, body_at = views.per_body(t, at.SOLUTION), views.body_at(t)
        for i in range(t[at.MOVING]):
            b = floats(body_at[i], BODY_FULL_WORDS)
            b[BIAS_VX] += share * solution[i, 0]
            b[BIAS_VX + 1] += share * solution[i, 1]
            b[BIAS_SPIN] += share * solution[i, 2]
        c = t[at.NEXT]


@kernel
def share_to_push(head, places, touches, change):  # type: ignore[no-untyped-def]
    """What share of the pseudo-impulses ``change`` may act; leaves the pseudo-velocities of all of it in the solutions.

    Taking out overlap strains the joints, and must not do more elastic work on them than the structures have lost so
    far: a body that has come to lie between two pieces would wedge them apart with energy that nothing has given.
    """
    work, lost, c = 0.0, 0.0, head
    while c != 0:
        t = views.control(c)
        solution, ledger = views.per_body(t, at.SOLUTION), views.ledger(t)
        sum_up(c, places, touches, change, solution)
        solve(t, 0, solution)
        work += work_to_shift(t, solution, views.settings(t)[WHOLE_STEP])
        # A shift of all that strains nothing but by rounding is free.
        lost += ledger[LEDGER_CONTACT] + ledger[LEDGER_NUMERICAL] + _FREE * ledger[LEDGER_KINETIC]
        c = t[at.NEXT]
    return math.sqrt(max(lost, 0.0) / work) if work > lost else 1.0


@kernel
def work_to_shift(t, velocity, h):  # type: ignore[no-untyped-def]
    """Elastic energy that moving at ``velocity`` for a time ``h`` stores in joints that bear nothing [J]."""
    joint_bodies, gradient, stiffness, active = (
        views.joint_bodies(t),
        views.gradient(t),
        views.stiffness(t),
        views.active(t),
    )
    work = 0.0
    for k in range(t[at.JOINTS]):
        if active[k]:
            x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
            along = x * (stiffness[k, 0] * x + 2.0 * (stiffness[k, 1] * y + stiffness[k, 2] * z))
            work += along + y * (stiffness[k, 3] * y + 2.0 * stiffness[k, 4] * z) + z * stiffness[k, 5] * z
    return 0.5 * h * h * work
