"""The matrix M + h² Jᵀ D J of a structure in 3 × 3 blocks, one for each body and each joint.

It is factored as L D Lᵀ in the order and over the pattern that `sim.ordering` found, so any graph of bodies will do.
"""

from numba import njit

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.layout import INERTIA_I, INERTIA_M, TANGENT


@njit(error_model="numpy")
def assemble(t, factor):  # type: ignore[no-untyped-def]
    """M + factor Jᵀ D J, D from the joints' last response; upper triangles of the diagonal blocks."""
    n, moving = t[at.JOINTS], t[at.MOVING]
    joint_bodies, joint_slot, weight = views.joint_bodies(t), views.joint_slot(t), views.weight(t)
    response, jacobian = views.response(t), views.jacobian(t)
    diagonal, lower = views.diagonal(t), views.lower(t)
    for i in range(moving):
        mass = weight[i, INERTIA_M]
        diagonal[i, 0], diagonal[i, 1], diagonal[i, 2] = mass, 0.0, 0.0
        diagonal[i, 4], diagonal[i, 5], diagonal[i, 8] = mass, 0.0, weight[i, INERTIA_I]
    for slot in range(t[at.LOWER]):
        for i in range(9):
            lower[slot, i] = 0.0
    for k in range(n):
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        d00, d01, d02 = (
            factor * response[k, TANGENT],
            factor * response[k, TANGENT + 1],
            factor * response[k, TANGENT + 2],
        )
        d11, d12, d22 = (
            factor * response[k, TANGENT + 3],
            factor * response[k, TANGENT + 4],
            factor * response[k, TANGENT + 5],
        )
        # D J, whose columns for the translations of a and b differ only in sign.
        x, y = jacobian[k, 3], jacobian[k, 9]
        l00, l10 = d00 * x + d01 * y, d01 * x + d11 * y
        x, y = jacobian[k, 4], jacobian[k, 10]
        l01, l11 = d00 * x + d01 * y, d01 * x + d11 * y
        # J row products with those columns are shared by both bodies, too.
        t00 = jacobian[k, 3] * l00 + jacobian[k, 9] * l10
        t01 = jacobian[k, 3] * l01 + jacobian[k, 9] * l11
        t11 = jacobian[k, 4] * l01 + jacobian[k, 10] * l11
        x, y, z = jacobian[k, 2], jacobian[k, 8], jacobian[k, 14]
        a0, a1, a2 = d00 * x + d01 * y + d02 * z, d01 * x + d11 * y + d12 * z, d02 * x + d12 * y + d22 * z
        x, y, z = jacobian[k, 5], jacobian[k, 11], jacobian[k, 17]
        b0, b1, b2 = d00 * x + d01 * y + d02 * z, d01 * x + d11 * y + d12 * z, d02 * x + d12 * y + d22 * z
        if ia < moving:
            diagonal[ia, 0] += t00
            diagonal[ia, 1] += t01
            diagonal[ia, 4] += t11
            diagonal[ia, 2] -= jacobian[k, 3] * a0 + jacobian[k, 9] * a1
            diagonal[ia, 5] -= jacobian[k, 4] * a0 + jacobian[k, 10] * a1
            diagonal[ia, 8] += jacobian[k, 2] * a0 + jacobian[k, 8] * a1 + jacobian[k, 14] * a2
        if ib < moving:
            diagonal[ib, 0] += t00
            diagonal[ib, 1] += t01
            diagonal[ib, 4] += t11
            diagonal[ib, 2] += jacobian[k, 3] * b0 + jacobian[k, 9] * b1
            diagonal[ib, 5] += jacobian[k, 4] * b0 + jacobian[k, 10] * b1
            diagonal[ib, 8] += jacobian[k, 5] * b0 + jacobian[k, 11] * b1 + jacobian[k, 17] * b2
        slot = joint_slot[k]
        if slot >= 0:
            lower[slot, 0] -= t00
            lower[slot, 1] -= t01
            lower[slot, 3] -= t01
            lower[slot, 4] -= t11
            turning = jacobian[k, 2] * b0 + jacobian[k, 8] * b1 + jacobian[k, 14] * b2
            if ia > ib:
                lower[slot, 2] -= jacobian[k, 3] * b0 + jacobian[k, 9] * b1
                lower[slot, 5] -= jacobian[k, 4] * b0 + jacobian[k, 10] * b1
                lower[slot, 6] += jacobian[k, 3] * a0 + jacobian[k, 9] * a1
                lower[slot, 7] += jacobian[k, 4] * a0 + jacobian[k, 10] * a1
            else:
                lower[slot, 2] += jacobian[k, 3] * a0 + jacobian[k, 9] * a1
                lower[slot, 5] += jacobian[k, 4] * a0 + jacobian[k, 10] * a1
                lower[slot, 6] -= jacobian[k, 3] * b0 + jacobian[k, 9] * b1
                lower[slot, 7] -= jacobian[k, 4] * b0 + jacobian[k, 10] * b1
            lower[slot, 8] += turning


@njit(inline="always", error_model="numpy")
def factorise_block(blocks, k):  # type: ignore[no-untyped-def]
    """L D Lᵀ of a symmetric 3 × 3 block in place: 1/d₀ l₁₀ l₂₀ · 1/d₁ l₂₁ · · 1/d₂.

    Not its inverse by cofactors: with rigid springs beside light bodies the minors cancel and every digit is lost.
    """
    d0 = 1.0 / blocks[k, 0]
    l10, l20 = blocks[k, 1] * d0, blocks[k, 2] * d0
    rest = blocks[k, 5] - l20 * blocks[k, 1]
    d1 = 1.0 / (blocks[k, 4] - l10 * blocks[k, 1])
    l21 = rest * d1
    d2 = 1.0 / (blocks[k, 8] - l20 * blocks[k, 2] - l21 * rest)
    blocks[k, 0], blocks[k, 1], blocks[k, 2], blocks[k, 4], blocks[k, 5], blocks[k, 8] = d0, l10, l20, d1, l21, d2


@njit(inline="always", error_model="numpy")
def solve_block(blocks, k, x, y, z):  # type: ignore[no-untyped-def]
    """Solve with a block that `factorise_block` has factored."""
    y -= blocks[k, 1] * x
    z = (z - blocks[k, 2] * x - blocks[k, 5] * y) * blocks[k, 8]
    y = y * blocks[k, 4] - blocks[k, 5] * z
    return x * blocks[k, 0] - blocks[k, 1] * y - blocks[k, 2] * z, y, z


@njit(error_model="numpy")
def factorise(moving, column_start, column_rows, fill_targets, diagonal, lower, scaled):  # type: ignore[no-untyped-def]
    """Block L D Lᵀ in place: ``diagonal`` is factored, ``scaled`` becomes L.

    ``fill_targets`` lists where the update of each pair of a column's rows goes.
    """
    at = 0
    for k in range(moving):
        factorise_block(diagonal, k)
        first, last = column_start[k], column_start[k + 1]
        for p in range(first, last):
            for r in range(0, 9, 3):
                scaled[p, r], scaled[p, r + 1], scaled[p, r + 2] = solve_block(
                    diagonal, k, lower[p, r], lower[p, r + 1], lower[p, r + 2]
                )
        for p in range(first, last):
            own = column_rows[p]
            diagonal[own, 0] -= scaled[p, 0] * lower[p, 0] + scaled[p, 1] * lower[p, 1] + scaled[p, 2] * lower[p, 2]
            diagonal[own, 1] -= scaled[p, 0] * lower[p, 3] + scaled[p, 1] * lower[p, 4] + scaled[p, 2] * lower[p, 5]
            diagonal[own, 2] -= scaled[p, 0] * lower[p, 6] + scaled[p, 1] * lower[p, 7] + scaled[p, 2] * lower[p, 8]
            diagonal[own, 4] -= scaled[p, 3] * lower[p, 3] + scaled[p, 4] * lower[p, 4] + scaled[p, 5] * lower[p, 5]
            diagonal[own, 5] -= scaled[p, 3] * lower[p, 6] + scaled[p, 4] * lower[p, 7] + scaled[p, 5] * lower[p, 8]
            diagonal[own, 8] -= scaled[p, 6] * lower[p, 6] + scaled[p, 7] * lower[p, 7] + scaled[p, 8] * lower[p, 8]
            for q in range(p + 1, last):
                target = fill_targets[at]
                at += 1
                for r in range(0, 9, 3):
                    x, y, z = scaled[q, r], scaled[q, r + 1], scaled[q, r + 2]
                    lower[target, r] -= x * lower[p, 0] + y * lower[p, 1] + z * lower[p, 2]
                    lower[target, r + 1] -= x * lower[p, 3] + y * lower[p, 4] + z * lower[p, 5]
                    lower[target, r + 2] -= x * lower[p, 6] + y * lower[p, 7] + z * lower[p, 8]


@njit(error_model="numpy")
def factorise_matrix(t, factor):  # type: ignore[no-untyped-def]
    """Assemble M + factor Jᵀ D J, and factor it."""
    assemble(t, factor)
    factorise(
        t[at.MOVING],
        views.column_start(t),
        views.column_rows(t),
        views.fill_targets(t),
        views.diagonal(t),
        views.lower(t),
        views.scaled(t),
    )


@njit(error_model="numpy")
def solve(t, first, x):  # type: ignore[no-untyped-def]
    """Solve with the factored matrix in place; ``x``, (bodies, 3), holds a right side that is zero before ``first``."""
    substitute(t[at.MOVING], first, views.column_start(t), views.column_rows(t), views.diagonal(t), views.scaled(t), x)


@njit(error_model="numpy")
def substitute(moving, first, column_start, column_rows, diagonal, scaled, x):  # type: ignore[no-untyped-def]
    """Solve L D Lᵀ x = b in place; ``x`` holds b, which is zero before body ``first``."""
    for k in range(first, moving):
        a, b, c = x[k, 0], x[k, 1], x[k, 2]
        for p in range(column_start[k], column_start[k + 1]):
            w = column_rows[p]
            x[w, 0] -= scaled[p, 0] * a + scaled[p, 1] * b + scaled[p, 2] * c
            x[w, 1] -= scaled[p, 3] * a + scaled[p, 4] * b + scaled[p, 5] * c
            x[w, 2] -= scaled[p, 6] * a + scaled[p, 7] * b + scaled[p, 8] * c
    for k in range(moving - 1, -1, -1):
        a, b, c = x[k, 0], x[k, 1], x[k, 2]
        if k >= first:
            a, b, c = solve_block(diagonal, k, a, b, c)
        for p in range(column_start[k], column_start[k + 1]):
            w = column_rows[p]
            a -= scaled[p, 0] * x[w, 0] + scaled[p, 3] * x[w, 1] + scaled[p, 6] * x[w, 2]
            b -= scaled[p, 1] * x[w, 0] + scaled[p, 4] * x[w, 1] + scaled[p, 7] * x[w, 2]
            c -= scaled[p, 2] * x[w, 0] + scaled[p, 5] * x[w, 1] + scaled[p, 8] * x[w, 2]
        x[k, 0], x[k, 1], x[k, 2] = a, b, c
