"""Where sweeps over contacts, or turns between contacts and joints, would take forever.

Gauss–Seidel sweeps hardly move what two nearly equal rows of G share out between them. Which contacts press, and which
of them slide, they find soon; with that known, the impulses of those that press are the solution of linear equations
(M. Silcowitz-Hansen, S. Niebe, K. Erleben, A nonsmooth nonlinear conjugate gradient method for interactive contact
force problems, Vis. Comput. 26 (2010), name both steps).

Contacts are solved with the joints' tangents, and where joints yield as soon as contacts press, turns between them may
go round in circles. Then contacts are changed by a share only, by Aitken's rule (U. Küttler, W. A. Wall, Fixed-point
fluid–structure interaction solvers with dynamic relaxation, Comput. Mech. 43 (2008) 61–72):

    ω ← - ω r₀·(r₁ - r₀) / |r₁ - r₀|²,   r₀ and r₁ the last two changes that contacts asked for.
"""

import numpy as np

from sim.chipmunk import CONTACT_NORMAL_IMPULSE, CONTACT_TANGENT_IMPULSE, CONTACT_WORDS, SPIN, VX
from sim.kernels.layout import FRICTION, WANTED, WHERE
from sim.kernels.rows import push_loose
from sim.memory import floats, kernel

# Least share of a change that is made, and how much larger it may become from one to the next.
_LEAST, _GROWTH = 0.02, 2.0
# Of the limit of friction: nearer to it a contact slides.
_SLIDES = 1e-9
# Of a row's own g, by which its impulse resists change: what contacts may share out in more than one way, as several
# points of two bodies do, stays as sweeps have left it.
_RESISTS = 1e-10
# Of the largest number on its diagonal: a matrix with less has no inverse.
_SINGULAR = 1e-13


@kernel
def relax(places, touches, change, last):  # type: ignore[no-untyped-def]
    """Take back what is too much of a ``change`` of contact impulses, given the ``last`` and, as its end, its share."""
    rows, dot, square = len(change), 0.0, 0.0
    for r in range(rows):
        difference = change[r] - last[r]
        dot += last[r] * difference
        square += difference * difference
        last[r] = change[r]
    share = 1.0
    if last[rows] > 0.0:
        # Where contacts ask for as much again, larger steps are the way.
        share = min(_GROWTH * last[rows], 1.0)
        if dot < 0.0:
            share = min(max(-last[rows] * dot / square, _LEAST), share)
    last[rows] = share
    for r in range(rows if share < 1.0 else 0):
        contact, back = floats(places[r >> 1, WHERE], CONTACT_WORDS), (1.0 - share) * change[r]
        contact[CONTACT_TANGENT_IMPULSE if r & 1 else CONTACT_NORMAL_IMPULSE] -= back
        push_loose(places[r >> 1], touches[r >> 1], r, -back, VX, SPIN)
        change[r] -= back


@kernel
def solve_directly(places, touches, g, v, change):  # type: ignore[no-untyped-def]
    """Solve the rows of contacts that press, as far as none of them lets go or begins to slide."""
    rows = len(v)
    follows, free = np.zeros(rows), np.zeros(rows, np.bool_)
    for r in range(0, rows, 2):
        contact = floats(places[r >> 1, WHERE], CONTACT_WORDS)
        normal, tangent = contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE]
        limit = touches[r >> 1, FRICTION] * normal
        free[r] = normal > 0.0 and g[r, r] > 0.0
        free[r + 1] = free[r] and abs(tangent) < (1.0 - _SLIDES) * limit and g[r + 1, r + 1] > 0.0
        if free[r] and not free[r + 1]:
            follows[r] = touches[r >> 1, FRICTION] if tangent > 0.0 else -touches[r >> 1, FRICTION]
    index = np.nonzero(free)[0]
    count = len(index)
    matrix, x = np.empty((count, count)), np.empty(count)
    for i in range(count):
        r = index[i]
        x[i] = (0.0 if r & 1 else touches[r >> 1, WANTED]) - v[r]
        for j in range(count):
            k = index[j]
            matrix[i, j] = g[r, k] + (follows[k] * g[r, k + 1] if k & 1 == 0 else 0.0)
        matrix[i, i] += _RESISTS * g[r, r]
    if not eliminate(matrix, x):
        return
    step = np.zeros(rows)
    for i in range(count):
        k = index[i]
        step[k] = x[i]
        if follows[k] != 0.0:
            step[k + 1] = follows[k] * x[i]
    share = 1.0
    for r in range(0, rows, 2):
        if not free[r]:
            continue
        contact = floats(places[r >> 1, WHERE], CONTACT_WORDS)
        normal, tangent = contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE]
        if step[r] < 0.0:
            share = min(share, -normal / step[r])
        if free[r + 1]:
            limit = touches[r >> 1, FRICTION]
            for sign in (1.0, -1.0):
                faster = sign * step[r + 1] - limit * step[r]
                if faster > 0.0:
                    share = min(share, (limit * normal - sign * tangent) / faster)
    for r in range(rows):
        if step[r] != 0.0:
            contact = floats(places[r >> 1, WHERE], CONTACT_WORDS)
            contact[CONTACT_TANGENT_IMPULSE if r & 1 else CONTACT_NORMAL_IMPULSE] += share * step[r]
            change[r] += share * step[r]
            for k in range(rows):
                v[k] += share * g[k, r] * step[r]


@kernel
def eliminate(matrix, x):  # type: ignore[no-untyped-def]
    """Solve for the right-hand side ``x`` in place, by Gauss with partial pivoting; whether that can be done."""
    count, largest = len(x), 0.0
    for i in range(count):
        largest = max(largest, abs(matrix[i, i]))
    for i in range(count):
        pivot = i
        for r in range(i + 1, count):
            if abs(matrix[r, i]) > abs(matrix[pivot, i]):
                pivot = r
        if not abs(matrix[pivot, i]) > _SINGULAR * largest:
            return False
        for k in range(count):
            matrix[i, k], matrix[pivot, k] = matrix[pivot, k], matrix[i, k]
        x[i], x[pivot] = x[pivot], x[i]
        for r in range(i + 1, count):
            ratio = matrix[r, i] / matrix[i, i]
            for k in range(i, count):
                matrix[r, k] -= ratio * matrix[i, k]
            x[r] -= ratio * x[i]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            x[i] -= matrix[i, k] * x[k]
        x[i] /= matrix[i, i]
    return True
