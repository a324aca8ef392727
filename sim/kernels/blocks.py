"""The matrix M + h² Jᵀ D J of a structure in 3 × 3 blocks, one for each body and each joint.

It is factored as L D Lᵀ in the order and over the pattern that `sim.ordering` found, so any graph of bodies will do.
"""

from numba import njit

from sim.chipmunk import BODY_WORDS, MASS, MOMENT
from sim.kernels.layout import TANGENT
from sim.memory import floats


@njit(error_model="numpy")
def assemble(  # type: ignore[no-untyped-def]
    n, moving, joint_bodies, body_at, joint_slot, factor, response, jacobian, diagonal, lower
):
    """M + factor Jᵀ D J, D from the joints' last response; upper triangles of the diagonal blocks."""
    for i in range(moving):
        b, d = floats(body_at[i], BODY_WORDS), diagonal[i]
        d[0], d[1], d[2] = b[MASS], 0.0, 0.0
        d[4], d[5], d[8] = b[MASS], 0.0, b[MOMENT]
    lower[:, :] = 0.0
    for k in range(n):
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        j, t = jacobian[k], response[k]
        d00, d01, d02 = factor * t[TANGENT], factor * t[TANGENT + 1], factor * t[TANGENT + 2]
        d11, d12, d22 = factor * t[TANGENT + 3], factor * t[TANGENT + 4], factor * t[TANGENT + 5]
        # D J, whose columns for the translations of a and b differ only in sign.
        x, y = j[3], j[9]
        l00, l10 = d00 * x + d01 * y, d01 * x + d11 * y
        x, y = j[4], j[10]
        l01, l11 = d00 * x + d01 * y, d01 * x + d11 * y
        # J row products with those columns are shared by both bodies, too.
        t00 = j[3] * l00 + j[9] * l10
        t01 = j[3] * l01 + j[9] * l11
        t11 = j[4] * l01 + j[10] * l11
        x, y, z = j[2], j[8], j[14]
        a0, a1, a2 = d00 * x + d01 * y + d02 * z, d01 * x + d11 * y + d12 * z, d02 * x + d12 * y + d22 * z
        x, y, z = j[5], j[11], j[17]
        b0, b1, b2 = d00 * x + d01 * y + d02 * z, d01 * x + d11 * y + d12 * z, d02 * x + d12 * y + d22 * z
        if ia < moving:
            d = diagonal[ia]
            d[0] += t00
            d[1] += t01
            d[4] += t11
            d[2] -= j[3] * a0 + j[9] * a1
            d[5] -= j[4] * a0 + j[10] * a1
            d[8] += j[2] * a0 + j[8] * a1 + j[14] * a2
        if ib < moving:
            d = diagonal[ib]
            d[0] += t00
            d[1] += t01
            d[4] += t11
            d[2] += j[3] * b0 + j[9] * b1
            d[5] += j[4] * b0 + j[10] * b1
            d[8] += j[5] * b0 + j[11] * b1 + j[17] * b2
        slot = joint_slot[k]
        if slot >= 0:
            w = lower[slot]
            w[0] -= t00
            w[1] -= t01
            w[3] -= t01
            w[4] -= t11
            turning = j[2] * b0 + j[8] * b1 + j[14] * b2
            if ia > ib:
                w[2] -= j[3] * b0 + j[9] * b1
                w[5] -= j[4] * b0 + j[10] * b1
                w[6] += j[3] * a0 + j[9] * a1
                w[7] += j[4] * a0 + j[10] * a1
            else:
                w[2] += j[3] * a0 + j[9] * a1
                w[5] += j[4] * a0 + j[10] * a1
                w[6] -= j[3] * b0 + j[9] * b1
                w[7] -= j[4] * b0 + j[10] * b1
            w[8] += turning


@njit(inline="always", error_model="numpy")
def factorise_block(a):  # type: ignore[no-untyped-def]
    """L D Lᵀ of a symmetric 3 × 3 block in place: 1/d₀ l₁₀ l₂₀ · 1/d₁ l₂₁ · · 1/d₂.

    Not its inverse by cofactors: with rigid springs beside light bodies the minors cancel and every digit is lost.
    """
    d0 = 1.0 / a[0]
    l10, l20 = a[1] * d0, a[2] * d0
    rest = a[5] - l20 * a[1]
    d1 = 1.0 / (a[4] - l10 * a[1])
    l21 = rest * d1
    d2 = 1.0 / (a[8] - l20 * a[2] - l21 * rest)
    a[0], a[1], a[2], a[4], a[5], a[8] = d0, l10, l20, d1, l21, d2


@njit(inline="always", error_model="numpy")
def solve_block(a, x, y, z):  # type: ignore[no-untyped-def]
    """Solve with a block that `factorise_block` has factored."""
    y -= a[1] * x
    z = (z - a[2] * x - a[5] * y) * a[8]
    y = y * a[4] - a[5] * z
    return x * a[0] - a[1] * y - a[2] * z, y, z


@njit(error_model="numpy")
def factorise(moving, column_start, column_rows, fill_targets, diagonal, lower, scaled):  # type: ignore[no-untyped-def]
    """Block L D Lᵀ in place: ``diagonal`` is factored, ``scaled`` becomes L.

    ``fill_targets`` lists where the update of each pair of a column's rows goes.
    """
    at = 0
    for k in range(moving):
        d = diagonal[k]
        factorise_block(d)
        first, last = column_start[k], column_start[k + 1]
        for p in range(first, last):
            block, out = lower[p], scaled[p]
            for r in range(0, 9, 3):
                out[r], out[r + 1], out[r + 2] = solve_block(d, block[r], block[r + 1], block[r + 2])
        for p in range(first, last):
            a, b, own = scaled[p], lower[p], diagonal[column_rows[p]]
            own[0] -= a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
            own[1] -= a[0] * b[3] + a[1] * b[4] + a[2] * b[5]
            own[2] -= a[0] * b[6] + a[1] * b[7] + a[2] * b[8]
            own[4] -= a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
            own[5] -= a[3] * b[6] + a[4] * b[7] + a[5] * b[8]
            own[8] -= a[6] * b[6] + a[7] * b[7] + a[8] * b[8]
            for q in range(p + 1, last):
                target, c = lower[fill_targets[at]], scaled[q]
                at += 1
                for r in range(0, 9, 3):
                    x, y, z = c[r], c[r + 1], c[r + 2]
                    target[r] -= x * b[0] + y * b[1] + z * b[2]
                    target[r + 1] -= x * b[3] + y * b[4] + z * b[5]
                    target[r + 2] -= x * b[6] + y * b[7] + z * b[8]


@njit(error_model="numpy")
def substitute(moving, first, column_start, column_rows, diagonal, scaled, x):  # type: ignore[no-untyped-def]
    """Solve L D Lᵀ x = b in place; ``x`` holds b, which is zero before body ``first``."""
    for k in range(first, moving):
        v = x[k]
        a, b, c = v[0], v[1], v[2]
        for p in range(column_start[k], column_start[k + 1]):
            w, f = x[column_rows[p]], scaled[p]
            w[0] -= f[0] * a + f[1] * b + f[2] * c
            w[1] -= f[3] * a + f[4] * b + f[5] * c
            w[2] -= f[6] * a + f[7] * b + f[8] * c
    for k in range(moving - 1, -1, -1):
        v = x[k]
        a, b, c = v[0], v[1], v[2]
        if k >= first:
            a, b, c = solve_block(diagonal[k], a, b, c)
        for p in range(column_start[k], column_start[k + 1]):
            w, f = x[column_rows[p]], scaled[p]
            a -= f[0] * w[0] + f[3] * w[1] + f[6] * w[2]
            b -= f[1] * w[0] + f[4] * w[1] + f[7] * w[2]
            c -= f[2] * w[0] + f[5] * w[1] + f[8] * w[2]
        v[0], v[1], v[2] = a, b, c
