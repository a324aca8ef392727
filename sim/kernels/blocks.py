"""The matrix M + h² Jᵀ D J of a structure in 3 × 3 blocks, one for each body and each joint.

It is factored as L D Lᵀ in the order and over the pattern that `sim.ordering` found, so any graph of bodies will do.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.layout import E_X, E_Y, HOLDS, INERTIA_I, INERTIA_M, TANGENT, U_A, U_B, V_A, V_B
from sim.memory import inlined, kernel


@inlined
def assemble(t, factor):  # type: ignore[no-untyped-def]
    """M + factor Jᵀ D J, D from the joints' last response; upper triangles of the diagonal blocks."""
    joint_bodies, joint_slot, moving = views.joint_bodies(t), views.joint_slot(t), t[at.MOVING]
    response, gradient, weight = views.response(t), views.gradient(t), views.weight(t)
    diagonal, lower = views.diagonal(t), views.lower(t)
    for i in range(moving):
        mass = weight[i, INERTIA_M]
        diagonal[i, 0], diagonal[i, 1], diagonal[i, 2] = mass, 0.0, 0.0
        diagonal[i, 4], diagonal[i, 5], diagonal[i, 8] = mass, 0.0, weight[i, INERTIA_I]
    shared = t[at.SHARED] == 1
    if shared:
        clear(lower)
    for k in range(t[at.JOINTS]):
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        d00, d01, d02 = response[k, TANGENT], response[k, TANGENT + 1], response[k, TANGENT + 2]
        d11, d12, d22 = response[k, TANGENT + 3], response[k, TANGENT + 4], response[k, TANGENT + 5]
        c, s = gradient[k, E_X], gradient[k, E_Y]
        # D J for translations of b; for those of a it has the other sign. With J's rows, the share in T.
        x0, x1 = factor * (d00 * c - d01 * s), factor * (d01 * c - d11 * s)
        y0, y1 = factor * (d00 * s + d01 * c), factor * (d01 * s + d11 * c)
        xx, xy, yy = c * x0 - s * x1, c * y0 - s * y1, s * y0 + c * y1
        # D J for rotations of a and of b, and its product with the columns for translations of b.
        u_a, v_a, u_b, v_b = gradient[k, U_A], gradient[k, V_A], gradient[k, U_B], gradient[k, V_B]
        turn = gradient[k, HOLDS]
        a0, a1 = factor * (d00 * u_a + d01 * v_a - d02 * turn), factor * (d01 * u_a + d11 * v_a - d12 * turn)
        b0, b1 = factor * (d00 * u_b + d01 * v_b + d02 * turn), factor * (d01 * u_b + d11 * v_b + d12 * turn)
        a2, b2 = factor * (d02 * u_a + d12 * v_a - d22 * turn), factor * (d02 * u_b + d12 * v_b + d22 * turn)
        xa, ya, xb, yb = c * a0 - s * a1, s * a0 + c * a1, c * b0 - s * b1, s * b0 + c * b1
        if ia < moving:
            diagonal[ia, 0] += xx
            diagonal[ia, 1] += xy
            diagonal[ia, 4] += yy
            diagonal[ia, 2] -= xa
            diagonal[ia, 5] -= ya
            diagonal[ia, 8] += u_a * a0 + v_a * a1 - turn * a2
        if ib < moving:
            diagonal[ib, 0] += xx
            diagonal[ib, 1] += xy
            diagonal[ib, 4] += yy
            diagonal[ib, 2] += xb
            diagonal[ib, 5] += yb
            diagonal[ib, 8] += u_b * b0 + v_b * b1 + turn * b2
        slot = joint_slot[k]
        if slot >= 0:
            if not shared:
                for i in range(9):
                    lower[slot, i] = 0.0
            lower[slot, 0] -= xx
            lower[slot, 1] -= xy
            lower[slot, 3] -= xy
            lower[slot, 4] -= yy
            lower[slot, 8] += u_a * b0 + v_a * b1 - turn * b2
            if ia > ib:
                lower[slot, 2] -= xb
                lower[slot, 5] -= yb
                lower[slot, 6] += xa
                lower[slot, 7] += ya
            else:
                lower[slot, 2] += xa
                lower[slot, 5] += ya
                lower[slot, 6] -= xb
                lower[slot, 7] -= yb


@inlined
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


@inlined
def solve_block(blocks, k, x, y, z):  # type: ignore[no-untyped-def]
    """Solve with a block that `factorise_block` has factored."""
    y -= blocks[k, 1] * x
    z = (z - blocks[k, 2] * x - blocks[k, 5] * y) * blocks[k, 8]
    y = y * blocks[k, 4] - blocks[k, 5] * z
    return x * blocks[k, 0] - blocks[k, 1] * y - blocks[k, 2] * z, y, z


@inlined
def factorise(moving, column_start, column_rows, fill_targets, diagonal, lower, column):  # type: ignore[no-untyped-def]
    """Block L D Lᵀ in place: ``diagonal`` is factored, ``lower`` becomes L.

    ``fill_targets`` lists where the update of each pair of a column's rows goes; ``column`` has room for the longest.
    """
    at = 0
    for k in range(moving):
        factorise_block(diagonal, k)
        first, last = column_start[k], column_start[k + 1]
        for p in range(first, last):
            for r in range(0, 9, 3):
                x, y, z = lower[p, r], lower[p, r + 1], lower[p, r + 2]
                column[p - first, r], column[p - first, r + 1], column[p - first, r + 2] = x, y, z
                lower[p, r], lower[p, r + 1], lower[p, r + 2] = solve_block(diagonal, k, x, y, z)
        for p in range(first, last):
            own, c = column_rows[p], p - first
            diagonal[own, 0] -= lower[p, 0] * column[c, 0] + lower[p, 1] * column[c, 1] + lower[p, 2] * column[c, 2]
            diagonal[own, 1] -= lower[p, 0] * column[c, 3] + lower[p, 1] * column[c, 4] + lower[p, 2] * column[c, 5]
            diagonal[own, 2] -= lower[p, 0] * column[c, 6] + lower[p, 1] * column[c, 7] + lower[p, 2] * column[c, 8]
            diagonal[own, 4] -= lower[p, 3] * column[c, 3] + lower[p, 4] * column[c, 4] + lower[p, 5] * column[c, 5]
            diagonal[own, 5] -= lower[p, 3] * column[c, 6] + lower[p, 4] * column[c, 7] + lower[p, 5] * column[c, 8]
            diagonal[own, 8] -= lower[p, 6] * column[c, 6] + lower[p, 7] * column[c, 7] + lower[p, 8] * column[c, 8]
            for q in range(p + 1, last):
                target = fill_targets[at]
                at += 1
                for r in range(0, 9, 3):
                    x, y, z = lower[q, r], lower[q, r + 1], lower[q, r + 2]
                    lower[target, r] -= x * column[c, 0] + y * column[c, 1] + z * column[c, 2]
                    lower[target, r + 1] -= x * column[c, 3] + y * column[c, 4] + z * column[c, 5]
                    lower[target, r + 2] -= x * column[c, 6] + y * column[c, 7] + z * column[c, 8]


@kernel
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
        views.column(t),
    )


@inlined
def solve(t, first, x):  # type: ignore[no-untyped-def]
    """Solve with the factored matrix in place; ``x``, (bodies, 3), holds a right side that is zero before ``first``."""
    substitute(t[at.MOVING], first, views.column_start(t), views.column_rows(t), views.diagonal(t), views.lower(t), x)


@kernel
def substitute(moving, first, column_start, column_rows, diagonal, lower, x):  # type: ignore[no-untyped-def]
    """Solve L D Lᵀ x = b in place; ``x`` holds b, which is zero before body ``first``."""
    for k in range(first, moving):
        a, b, c = x[k, 0], x[k, 1], x[k, 2]
        for p in range(column_start[k], column_start[k + 1]):
            w = column_rows[p]
            x[w, 0] -= lower[p, 0] * a + lower[p, 1] * b + lower[p, 2] * c
            x[w, 1] -= lower[p, 3] * a + lower[p, 4] * b + lower[p, 5] * c
            x[w, 2] -= lower[p, 6] * a + lower[p, 7] * b + lower[p, 8] * c
    for k in range(moving - 1, -1, -1):
        a, b, c = x[k, 0], x[k, 1], x[k, 2]
        if k >= first:
            a, b, c = solve_block(diagonal, k, a, b, c)
        for p in range(column_start[k], column_start[k + 1]):
            w = column_rows[p]
            a -= lower[p, 0] * x[w, 0] + lower[p, 3] * x[w, 1] + lower[p, 6] * x[w, 2]
            b -= lower[p, 1] * x[w, 0] + lower[p, 4] * x[w, 1] + lower[p, 7] * x[w, 2]
            c -= lower[p, 2] * x[w, 0] + lower[p, 5] * x[w, 1] + lower[p, 8] * x[w, 2]
        x[k, 0], x[k, 1], x[k, 2] = a, b, c
