"""Ties: Chipmunk's own constraints at the bodies of a group of structures, solved through the structures.

The impulses j of a tie change the velocities of what it holds against each other by K j,

    K = J_s C J_sᵀ,

with its directions J_s and the mobility C of its bodies: H⁻¹ within a structure (see `complement`), M⁻¹ of a loose
one. Chipmunk's own function then finds its impulse, with the effective mass K⁻¹ in place of that of the bare bodies,
within the tie's bounds, and for a damper with what it takes of such a mass in the step. What that does to bodies of a
structure, all bodies at ties learn from C; the rest of the structure when all ties agree. So a tie is solved to the end
within one of Chipmunk's iterations.
"""

import math

import numpy as np

from sim.chipmunk import (
    BODY_WORDS,
    MASS_INVERSE,
    MOMENT_INVERSE,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.blocks import solve
from sim.kernels.complement import NOT_FINITE, factorise_group, transmit
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.layout import STEP
from sim.kernels.noted import NOTES_WORDS, TIES_COUNT
from sim.kernels.ties import (
    APPLY_IMPULSE,
    CONSTRAINT,
    INDEX,
    KIND,
    LINKED,
    OWNER,
    body_of,
    call_for,
    is_of,
    ratio_of,
    slacken,
    tie_at,
    way_of,
)
from sim.memory import floats, integers, kernel
from sim.stock import (
    KIND_COEFFICIENT,
    KIND_DAMPING,
    KIND_IMPULSE,
    KIND_MASS,
    KIND_WAY,
    KIND_WORDS,
    POINT,
)

# Of the impulses' energy.
_AGREED, _MOST_SWEEPS = 1e-20, 200


@kernel
def solve_ties(head):  # type: ignore[no-untyped-def]
    """Solve a group's ties as it now stands; returns by how much their impulses changed, or `NOT_FINITE`.

    In parts of a step, links between what hangs on them have their turns, too.
    """
    notes = integers(views.control(head)[at.NOTES], NOTES_WORDS)
    which, links = np.empty(notes[TIES_COUNT], np.int64), views.control(head)[at.PARTS] > 1
    count = 0
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        if is_of(tie, head) or (links and tie[LINKED] == head):
            which[count] = k
            count += 1
    which = which[:count]
    ports, ends = ports_of(notes, which)
    c = mobility(head, ports)
    h = views.settings(views.control(head))[STEP]
    yielding = np.empty((count, 4))
    for k in range(count):
        tighten(tie_at(notes, which[k]), ends[k], c, h, yielding[k])
    for p in range(len(ports)):
        t = views.control(ports[p, 0])
        give_velocity(t, ports[p, 1], views.per_body(t, at.VELOCITY))
    given, change = np.zeros((len(ports), 3)), 0.0
    for _ in range(_MOST_SWEEPS):
        moved, size = 0.0, 0.0
        for k in range(count):
            tie = tie_at(notes, which[k])
            moved += turn_of(tie, ends[k], ports, c, given, h)
            size += energy_of(tie, yielding[k])
        change += moved
        if not moved > _AGREED * size:
            break
    for k in range(count):
        if is_of(tie_at(notes, which[k]), head):
            slacken(tie_at(notes, which[k]))
    for p in range(len(ports)):
        t = views.control(ports[p, 0])
        give_velocity(t, ports[p, 1], views.per_body(t, at.WRITTEN))
    if not math.isfinite(change):
        return NOT_FINITE
    member = head
    while member != 0:
        t = views.control(member)
        solution = views.per_body(t, at.SOLUTION)
        clear(solution)
        for p in range(len(ports)):
            if ports[p, 0] == member:
                for axis in range(3):
                    solution[ports[p, 1], axis] = given[p, axis]
        transmit(t, views.per_body(t, at.EXTERNAL))
        member = t[at.NEXT]
    return math.sqrt(change / size) if size > 0.0 else 0.0


@kernel
def ports_of(notes, which):  # type: ignore[no-untyped-def]
    """Bodies of structures at these ties: control table and index of each; and which each tie is at, -1 for others."""
    ports, ends, count = np.empty((2 * len(which), 2), np.int64), np.empty((len(which), 2), np.int64), 0
    for k in range(len(which)):
        tie = tie_at(notes, which[k])
        for side in range(2):
            ends[k, side] = -1
            if tie[OWNER + side] == 0:
                continue
            for p in range(count):
                if ports[p, 0] == tie[OWNER + side] and ports[p, 1] == tie[INDEX + side]:
                    ends[k, side] = p
            if ends[k, side] < 0:
                ports[count, 0], ports[count, 1], ends[k, side] = tie[OWNER + side], tie[INDEX + side], count
                count += 1
    return ports[:count], ends


@kernel
def mobility(head, ports):  # type: ignore[no-untyped-def]
    """H⁻¹ of the group between these bodies, three rows and columns each."""
    factorise_group(head)
    c = np.zeros((3 * len(ports), 3 * len(ports)))
    for p in range(len(ports)):
        t = views.control(ports[p, 0])
        solution = views.per_body(t, at.SOLUTION)
        for axis in range(3):
            clear(solution)
            solution[ports[p, 1], axis] = 1.0
            solve(t, ports[p, 1], solution)
            for q in range(len(ports)):
                if ports[q, 0] == ports[p, 0]:
                    for row in range(3):
                        c[3 * q + row, 3 * p + axis] = solution[ports[q, 1], row]
    return c


@kernel
def give_velocity(t, i, velocity):  # type: ignore[no-untyped-def]
    """Have body i the velocity that ``velocity``, (bodies, 3), has for it."""
    b = floats(views.body_at(t)[i], BODY_WORDS)
    b[VX], b[VX + 1], b[SPIN] = velocity[i, 0], velocity[i, 1], velocity[i, 2]


@kernel
def tighten(tie, ends, c, h, yielding):  # type: ignore[no-untyped-def]
    """Give a tie the effective mass that it has through the structure; K is noted in ``yielding``, row by row.

    That of a link between loose bodies it has already.
    """
    kind = integers(tie[KIND], KIND_WORDS)
    numbers = floats(tie[CONSTRAINT], max(kind[KIND_MASS] + 4, kind[KIND_COEFFICIENT] + 1, kind[KIND_DAMPING] + 1))
    mass, through = kind[KIND_MASS], ends[0] >= 0 or ends[1] >= 0
    if kind[KIND_WAY] == POINT:
        for row in range(2):
            for column in range(2):
                yielding[2 * row + column] = yields(tie, ends, c, row, column)
        determinant = yielding[0] * yielding[3] - yielding[1] * yielding[2]
        if through and determinant > 0.0:
            numbers[mass], numbers[mass + 3] = yielding[3] / determinant, yielding[0] / determinant
            numbers[mass + 1], numbers[mass + 2] = -yielding[1] / determinant, -yielding[2] / determinant
        return
    yielding[0] = yields(tie, ends, c, 0, 0)
    if through and yielding[0] > 0.0:
        numbers[mass] = 1.0 / yielding[0]
        if kind[KIND_COEFFICIENT] != 0:
            numbers[kind[KIND_COEFFICIENT]] = -math.expm1(-numbers[kind[KIND_DAMPING]] * h * yielding[0])


@kernel
def yields(tie, ends, c, row, column):  # type: ignore[no-untyped-def]
    """How fast a unit impulse in direction ``column`` of a tie moves its ends against each other in direction ``row``.

    Chipmunk's rates of a gear are those of body a, so they are ``ratio`` times what the impulses work on.
    """
    total = 0.0
    for side in range(2):
        x, y, turn = way_of(tie, side, column)
        u, v, w = way_of(tie, side, row)
        if ends[side] < 0:
            b = body_of(tie, side)
            total += (u * x + v * y) * b[MASS_INVERSE] + w * turn * b[MOMENT_INVERSE]
            continue
        p = 3 * ends[side]
        for other in range(2):
            if ends[other] >= 0:
                q = 3 * ends[other]
                x, y, turn = way_of(tie, other, column)
                for axis, way in ((0, u), (1, v), (2, w)):
                    total += way * (c[p + axis, q] * x + c[p + axis, q + 1] * y + c[p + axis, q + 2] * turn)
    return total * ratio_of(tie)


@kernel
def turn_of(tie, ends, ports, c, given, h):  # type: ignore[no-untyped-def]
    """One tie's turn: its impulse at the bodies' present velocities; returns the energy of the change.

    What structures' bodies were ``given`` in all is added up, (ports, 3).
    """
    before, impulse, energy = np.empty((2, 3)), np.zeros((2, 3)), 0.0
    for side in range(2):
        b = body_of(tie, side)
        before[side, 0], before[side, 1], before[side, 2] = b[VX], b[VX + 1], b[SPIN]
    call_for(tie, APPLY_IMPULSE, h)
    for side in range(2):
        b = body_of(tie, side)
        if b[MASS_INVERSE] > 0.0:
            impulse[side, 0] = mass_of(b) * (b[VX] - before[side, 0])
            impulse[side, 1] = mass_of(b) * (b[VX + 1] - before[side, 1])
            impulse[side, 2] = moment_of(b) * (b[SPIN] - before[side, 2])
        if ends[side] >= 0:
            b[VX], b[VX + 1], b[SPIN] = before[side, 0], before[side, 1], before[side, 2]
    for side in range(2):
        p = ends[side]
        if p < 0:
            continue
        x, y, turn = impulse[side, 0], impulse[side, 1], impulse[side, 2]
        for q in range(len(ports)):
            if ports[q, 0] == ports[p, 0]:
                b = floats(views.body_at(views.control(ports[q, 0]))[ports[q, 1]], BODY_WORDS)
                for axis in range(3):
                    way = c[3 * q + axis]
                    b[SPIN if axis == 2 else VX + axis] += way[3 * p] * x + way[3 * p + 1] * y + way[3 * p + 2] * turn
        for axis in range(3):
            given[p, axis] += impulse[side, axis]
    for side in range(2):
        b = body_of(tie, side)
        energy += impulse[side, 0] * (b[VX] - before[side, 0]) + impulse[side, 1] * (b[VX + 1] - before[side, 1])
        energy += impulse[side, 2] * (b[SPIN] - before[side, 2])
    return energy


@kernel
def energy_of(tie, yielding):  # type: ignore[no-untyped-def]
    """Twice the kinetic energy of a tie's whole impulse, j·K j [J]."""
    kind = integers(tie[KIND], KIND_WORDS)
    impulse = floats(tie[CONSTRAINT], kind[KIND_IMPULSE] + 2)
    x, y = impulse[kind[KIND_IMPULSE]], impulse[kind[KIND_IMPULSE] + 1]
    if kind[KIND_WAY] == POINT:
        return yielding[0] * x * x + (yielding[1] + yielding[2]) * x * y + yielding[3] * y * y
    return yielding[0] * x * x
