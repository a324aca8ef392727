"""Contacts of a structure's bodies, solved through the structure.

A contact solver that sees only the mass of the piece that is touched fails where the piece is light and what it carries
is heavy. Here the contacts are taken over from Chipmunk (their `nMass` and `tMass` set to zero, so that its own solver
leaves them alone; their accumulated impulses stay, and warm-start the next step) and solved on

    G = J_c H⁻¹ J_cᵀ + J_c M_e⁻¹ J_cᵀ,   H = M + (β + δ) h² Jᵀ D J,

H for the structure with its present tangents and M_e for loose bodies. Per contact, with relative velocity v along its
normal n and tangent t, restitution and friction are

    j_n ≥ 0,  v_n ≥ v_bounce,  one of them with equality;   |j_t| ≤ μ j_n,  v_t = 0 unless at the limit.

Overlap is taken out by pseudo-velocities that move the bodies once and carry no momentum, through the structure, too.
"""

import numpy as np
from numba import njit

from sim.chipmunk import (
    ARBITER_BODY_A,
    ARBITER_BODY_B,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_FRICTION,
    ARBITER_NEXT_A,
    ARBITER_NEXT_B,
    ARBITER_NORMAL,
    ARBITER_SURFACE,
    ARBITER_WORDS,
    ARBITERS,
    BIAS_SPIN,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_SPACE,
    BODY_WORDS,
    CONTACT_BIAS,
    CONTACT_BOUNCE,
    CONTACT_BYTES,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_NORMAL_MASS,
    CONTACT_R1,
    CONTACT_R2,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_TANGENT_MASS,
    CONTACT_WORDS,
    MASS_INVERSE,
    MOMENT_INVERSE,
    SPACE_SLOP,
    SPACE_WORDS,
    SPIN,
    VX,
    X,
)
from sim.kernels.blocks import substitute
from sim.memory import floats, integers

_SWEEPS = 200
# Share of the way to the overlap that a space allows that a pressed contact may sink in a step. Where surfaces turn,
# their distance changes with the square of the step; a contact that kept none of that overlap would be lost, and found
# again a step of free motion later.
_SETTLE = 0.5

# Integer record of a contact: its address, bodies a and b (index in the structure, -1 for others), their addresses.
WHERE, INDEX_A, INDEX_B, BODY_A, BODY_B = 0, 1, 2, 3, 4
PLACE_WORDS = 5
# Float record: normal, arms from a and b, friction, surface velocity along the tangent, wanted normal velocity, bias.
NORMAL, ARM_A, ARM_B, FRICTION, SURFACE, WANTED, PUSH = 0, 2, 4, 6, 7, 8, 9
TOUCH_WORDS = 10


@njit(error_model="numpy")
def find(body, keys, values):  # type: ignore[no-untyped-def]
    """Index of the body at an address in the structure, or -1; open addressing, a power of two long."""
    mask = len(keys) - 1
    slot = ((body >> 4) ^ (body >> 12)) & mask
    while keys[slot] != 0:
        if keys[slot] == body:
            return values[slot]
        slot = (slot + 1) & mask
    return -1


@njit(error_model="numpy")
def collect(moving, body_at, keys, values, places, touches, h):  # type: ignore[no-untyped-def]
    """Take over the contacts of this step; returns how many, and how many there was no room for."""
    count, missed = 0, 0
    slop = floats(integers(body_at[0], BODY_FULL_WORDS)[BODY_SPACE], SPACE_WORDS)[SPACE_SLOP] if moving > 0 else 0.0
    for i in range(moving):
        own = body_at[i]
        arbiter = integers(own, BODY_FULL_WORDS)[ARBITERS]
        while arbiter != 0:
            w, f = integers(arbiter, ARBITER_WORDS), floats(arbiter, ARBITER_WORDS)
            is_a = w[ARBITER_BODY_A] == own
            other = w[ARBITER_BODY_B] if is_a else w[ARBITER_BODY_A]
            j = find(other, keys, values)
            if j >= moving:
                j = -1
            contacts = w[ARBITER_COUNT] & 0xFFFFFFFF
            for k in range(contacts):
                at = w[ARBITER_CONTACTS] + CONTACT_BYTES * k
                c = floats(at, CONTACT_WORDS)
                if c[CONTACT_NORMAL_MASS] == 0.0:
                    continue
                if count >= len(places):
                    missed += 1
                    continue
                p, t = places[count], touches[count]
                p[WHERE] = at
                p[INDEX_A], p[INDEX_B] = (i, j) if is_a else (j, i)
                p[BODY_A], p[BODY_B] = w[ARBITER_BODY_A], w[ARBITER_BODY_B]
                nx, ny = f[ARBITER_NORMAL], f[ARBITER_NORMAL + 1]
                t[NORMAL], t[NORMAL + 1] = nx, ny
                t[ARM_A], t[ARM_A + 1] = c[CONTACT_R1], c[CONTACT_R1 + 1]
                t[ARM_B], t[ARM_B + 1] = c[CONTACT_R2], c[CONTACT_R2 + 1]
                t[FRICTION] = f[ARBITER_FRICTION]
                t[SURFACE] = -ny * f[ARBITER_SURFACE] + nx * f[ARBITER_SURFACE + 1]
                spare = slop + overlap_less(w, c, nx, ny)
                t[WANTED] = -c[CONTACT_BOUNCE]
                if t[WANTED] == 0.0 and spare > 0.0:
                    t[WANTED] = -_SETTLE * spare / h
                t[PUSH] = c[CONTACT_BIAS]
                c[CONTACT_NORMAL_MASS] = 0.0
                c[CONTACT_TANGENT_MASS] = 0.0
                count += 1
            arbiter = w[ARBITER_NEXT_A] if is_a else w[ARBITER_NEXT_B]
    return count, missed


@njit(inline="always", error_model="numpy")
def overlap_less(arbiter, contact, nx, ny):  # type: ignore[no-untyped-def]
    """Distance of the two surfaces at a contact, negative where they overlap [m]."""
    a, b = floats(arbiter[ARBITER_BODY_A], BODY_WORDS), floats(arbiter[ARBITER_BODY_B], BODY_WORDS)
    x = b[X] + contact[CONTACT_R2] - a[X] - contact[CONTACT_R1]
    y = b[X + 1] + contact[CONTACT_R2 + 1] - a[X + 1] - contact[CONTACT_R1 + 1]
    return nx * x + ny * y


@njit(inline="always", error_model="numpy")
def direction(touch, row):  # type: ignore[no-untyped-def]
    """Unit vector of a row (even: normal, odd: tangent) and its moments about a and b."""
    dx, dy = touch[NORMAL], touch[NORMAL + 1]
    if row & 1:
        dx, dy = -dy, dx
    return dx, dy, touch[ARM_A] * dy - touch[ARM_A + 1] * dx, touch[ARM_B] * dy - touch[ARM_B + 1] * dx


@njit(error_model="numpy")
def relative(place, touch, row, velocity, offset):  # type: ignore[no-untyped-def]
    """Velocity of b relative to a along a row; loose bodies' velocities are at word ``offset`` of their structs."""
    dx, dy, ma, mb = direction(touch, row)
    total = 0.0
    if place[INDEX_B] >= 0:
        v = velocity[place[INDEX_B]]
        total += dx * v[0] + dy * v[1] + mb * v[2]
    else:
        b = floats(place[BODY_B], BODY_FULL_WORDS)
        spin = b[SPIN] if offset == VX else b[BIAS_SPIN]
        total += dx * b[offset] + dy * b[offset + 1] + mb * spin
    if place[INDEX_A] >= 0:
        v = velocity[place[INDEX_A]]
        total -= dx * v[0] + dy * v[1] + ma * v[2]
    else:
        a = floats(place[BODY_A], BODY_FULL_WORDS)
        spin = a[SPIN] if offset == VX else a[BIAS_SPIN]
        total -= dx * a[offset] + dy * a[offset + 1] + ma * spin
    return total


@njit(inline="always", error_model="numpy")
def add_row(place, touch, row, amount, vector):  # type: ignore[no-untyped-def]
    """Add ``amount`` of a row's unit impulse to the structure's bodies in ``vector``."""
    dx, dy, ma, mb = direction(touch, row)
    if place[INDEX_B] >= 0:
        x = vector[place[INDEX_B]]
        x[0] += amount * dx
        x[1] += amount * dy
        x[2] += amount * mb
    if place[INDEX_A] >= 0:
        x = vector[place[INDEX_A]]
        x[0] -= amount * dx
        x[1] -= amount * dy
        x[2] -= amount * ma


@njit(error_model="numpy")
def operator(  # type: ignore[no-untyped-def]
    count, moving, places, touches, column_start, column_rows, diagonal, scaled, solution, g
):
    """G for all contacts, by one substitution a column."""
    for k in range(2 * count):
        place, touch = places[k >> 1], touches[k >> 1]
        dx, dy, ma, mb = direction(touch, k)
        solution[:, :] = 0.0
        add_row(place, touch, k, 1.0, solution)
        first = moving
        for index in (place[INDEX_A], place[INDEX_B]):
            if index >= 0:
                first = min(first, index)
        substitute(moving, first, column_start, column_rows, diagonal, scaled, solution)
        loose = place[BODY_A] if place[INDEX_A] < 0 else place[BODY_B]
        has_loose = place[INDEX_A] < 0 or place[INDEX_B] < 0
        sign, moment = (-1.0, ma) if place[INDEX_A] < 0 else (1.0, mb)
        for r in range(2 * count):
            p, t = places[r >> 1], touches[r >> 1]
            ex, ey, na, nb = direction(t, r)
            total = 0.0
            if p[INDEX_B] >= 0:
                x = solution[p[INDEX_B]]
                total += ex * x[0] + ey * x[1] + nb * x[2]
            if p[INDEX_A] >= 0:
                x = solution[p[INDEX_A]]
                total -= ex * x[0] + ey * x[1] + na * x[2]
            if has_loose and (p[INDEX_A] < 0 or p[INDEX_B] < 0):
                other = p[BODY_A] if p[INDEX_A] < 0 else p[BODY_B]
                if other == loose:
                    b = floats(loose, BODY_FULL_WORDS)
                    their_sign, their_moment = (-1.0, na) if p[INDEX_A] < 0 else (1.0, nb)
                    total += (
                        sign
                        * their_sign
                        * ((dx * ex + dy * ey) * b[MASS_INVERSE] + moment * their_moment * b[MOMENT_INVERSE])
                    )
            g[r, k] = total


@njit(error_model="numpy")
def complement(count, places, touches, velocity, g, v, change):  # type: ignore[no-untyped-def]
    """Projected Gauss–Seidel on G; changes the accumulated impulses, returns the largest change over them."""
    rows = 2 * count
    for r in range(rows):
        v[r] = relative(places[r >> 1], touches[r >> 1], r, velocity, VX)
        if r & 1:
            v[r] += touches[r >> 1, SURFACE]
        change[r] = 0.0
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
        c = floats(places[r >> 1, WHERE], CONTACT_WORDS)
        size = max(size, c[CONTACT_NORMAL_IMPULSE])
        largest = max(largest, abs(change[r]))
    return largest / size if size > 0.0 else largest


@njit(error_model="numpy")
def push_apart(  # type: ignore[no-untyped-def]
    count, moving, body_at, places, touches, column_start, column_rows, diagonal, scaled, solution, g, v, change
):
    """Pseudo-velocities that take out overlap, through the structure."""
    any_overlap = False
    for k in range(count):
        v[2 * k] = 0.0
        change[2 * k] = 0.0
        any_overlap = any_overlap or touches[k, PUSH] > 0.0
    if not any_overlap:
        return
    for _ in range(_SWEEPS):
        moved, size = 0.0, 0.0
        for r in range(0, 2 * count, 2):
            if g[r, r] <= 0.0:
                continue
            new = max(change[r] + (touches[r >> 1, PUSH] - v[r]) / g[r, r], 0.0)
            step = new - change[r]
            size = max(size, new)
            if step != 0.0:
                moved = max(moved, abs(step))
                change[r] = new
                for k in range(0, 2 * count, 2):
                    v[k] += g[k, r] * step
        if moved <= 1e-6 * size:
            break
    solution[:, :] = 0.0
    for r in range(0, 2 * count, 2):
        place, touch = places[r >> 1], touches[r >> 1]
        add_row(place, touch, r, change[r], solution)
        push_loose(place, touch, r, change[r], BIAS_VX, BIAS_SPIN)
    substitute(moving, 0, column_start, column_rows, diagonal, scaled, solution)
    for i in range(moving):
        b = floats(body_at[i], BODY_FULL_WORDS)
        b[BIAS_VX] += solution[i, 0]
        b[BIAS_VX + 1] += solution[i, 1]
        b[BIAS_SPIN] += solution[i, 2]


@njit(error_model="numpy")
def push_loose(place, touch, row, amount, offset, spin):  # type: ignore[no-untyped-def]
    """Give a row's impulse to the loose body of a contact, if it has one; velocities at ``offset`` and ``spin``."""
    dx, dy, ma, mb = direction(touch, row)
    if place[INDEX_B] < 0:
        b = floats(place[BODY_B], BODY_FULL_WORDS)
        b[offset] += amount * dx * b[MASS_INVERSE]
        b[offset + 1] += amount * dy * b[MASS_INVERSE]
        b[spin] += amount * mb * b[MOMENT_INVERSE]
    if place[INDEX_A] < 0:
        a = floats(place[BODY_A], BODY_FULL_WORDS)
        a[offset] -= amount * dx * a[MASS_INVERSE]
        a[offset + 1] -= amount * dy * a[MASS_INVERSE]
        a[spin] -= amount * ma * a[MOMENT_INVERSE]


@njit(error_model="numpy")
def strike(count, moving, body_at, places, touches, change, velocity, solution):  # type: ignore[no-untyped-def]
    """Apply changed contact impulses to loose bodies and pieces; ``solution`` becomes their sum on the pieces."""
    solution[:, :] = 0.0
    for r in range(2 * count):
        place, touch = places[r >> 1], touches[r >> 1]
        add_row(place, touch, r, change[r], solution)
        push_loose(place, touch, r, change[r], VX, SPIN)
    for i in range(moving):
        x = solution[i]
        if x[0] != 0.0 or x[1] != 0.0 or x[2] != 0.0:
            b, v = floats(body_at[i], BODY_FULL_WORDS), velocity[i]
            v[0] += x[0] * b[MASS_INVERSE]
            v[1] += x[1] * b[MASS_INVERSE]
            v[2] += x[2] * b[MOMENT_INVERSE]


def hash_table(addresses: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Keys and values for `find`."""
    size = 1 << max(2, (2 * len(addresses)).bit_length())
    keys, values = np.zeros(size, dtype=np.int64), np.zeros(size, dtype=np.int64)
    for index, body in enumerate(addresses):
        slot = ((body >> 4) ^ (body >> 12)) & (size - 1)
        while keys[slot] != 0:
            slot = (slot + 1) & (size - 1)
        keys[slot], values[slot] = body, index
    return keys, values
