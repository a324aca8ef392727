"""What impulses of contacts do to the velocities in all of them, through structures and loose bodies:

    G = J_c H⁻¹ J_cᵀ + J_c M_e⁻¹ J_cᵀ,   H = M + (β + δ) h² Jᵀ D J,

H for each structure with its present tangents and M_e for loose bodies.
"""

import numpy as np

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.blocks import solve
from sim.kernels.layout import INDEX_A, INDEX_B, OWNER_A, OWNER_B
from sim.kernels.rows import add_row, move_loose, own_velocity, relative, sum_up
from sim.memory import kernel


@kernel
def operator(places, touches):  # type: ignore[no-untyped-def]
    """G for all contacts, row by row, for it is symmetric."""
    g = np.zeros((2 * len(places), 2 * len(places)))
    for r in range(len(g)):
        respond_to(places, touches, r, g[r])
    return g


@kernel
def respond_to(places, touches, row, velocities):  # type: ignore[no-untyped-def]
    """Add to the ``velocities`` of all rows what a row's unit impulse gives them: one substitution a structure."""
    place, touch = places[row >> 1], touches[row >> 1]
    one, two = place[OWNER_A], place[OWNER_B]
    for side in range(2):
        c = two if side == 1 else one
        if c == 0 or (side == 1 and two == one):
            continue
        t = views.control(c)
        solution = views.per_body(t, at.SOLUTION)
        clear(solution)
        add_row(c, place, touch, row, 1.0, solution)
        first = t[at.MOVING]
        if one == c:
            first = min(first, place[INDEX_A])
        if two == c:
            first = min(first, place[INDEX_B])
        solve(t, first, solution)
        for r in range(len(velocities)):
            velocities[r] += own_velocity(c, places[r >> 1], touches[r >> 1], r, solution)
    move_loose(places, touches, row, velocities)


@kernel
def note_velocities(head, places, touches, change, v):  # type: ignore[no-untyped-def]
    """Velocities of all rows, once the structures' bodies follow a ``change`` of impulses that loose ones have had."""
    any_change = False
    for r in range(len(v)):
        v[r] = relative(places[r >> 1], touches[r >> 1], r)
        any_change = any_change or change[r] != 0.0
    c = head if any_change else 0
    while c != 0:
        t = views.control(c)
        solution = views.per_body(t, at.SOLUTION)
        sum_up(c, places, touches, change, solution)
        solve(t, 0, solution)
        for r in range(len(v)):
            v[r] += own_velocity(c, places[r >> 1], touches[r >> 1], r, solution)
        c = t[at.NEXT]
