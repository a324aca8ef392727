"""Chipmunk's own constraints at the bodies of structures: which there are, and what Chipmunk is kept from doing.

A pivot, a motor or a damper that sees only the mass of the piece it is fixed to is as wrong there as a contact is: it
takes the more iterations the heavier what hangs on the piece, and what it does to the piece after the structure was
solved tears at stiff joints. So such ties are solved through the structures, see `tie_impulses`. Chipmunk goes on to
call them, too, with an effective mass of nothing, with which they do nothing.

A spring's force acts in its `preStep`. One that comes before the structure in Chipmunk's list has changed velocities
by then, which is no impulse that somebody gave the body before the step.
"""

from sim.chipmunk import (
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONSTRAINT_BODY_A,
    CONSTRAINT_BODY_B,
    CONSTRAINT_CLASS,
    CONSTRAINT_WORDS,
    CONSTRAINTS,
    MASS_INVERSE,
    MOMENT_INVERSE,
    SPIN,
    VX,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.noted import BOUND, KINDS, KINDS_COUNT, NOTES_WORDS, STAMP, TIES, TIES_COUNT
from sim.kernels.owners import constraints_with, find, home, next_at, unite
from sim.memory import call_constraint, floats, integers, kernel
from sim.stock import (
    KIND_ARMS,
    KIND_AXIS,
    KIND_CLASS,
    KIND_COEFFICIENT,
    KIND_COUNT,
    KIND_HOLDS,
    KIND_IMPULSE,
    KIND_MASS,
    KIND_RATIO,
    KIND_TARGET,
    KIND_WAY,
    KIND_WORDS,
    LINE,
    POINT,
)

#: A tie's row: its address, its place in Chipmunk's list and the row of its kind (0: none); for each of its two bodies
#: the control table of the structure that it belongs to (0: none) and its index there; velocities of both when it
#: was solved last; its impulse at the step's start, then that of the step's earlier parts; the control table that acts
#: for the group through whose parts it goes (0: none), see `links`; and how long ago it began to give a blow, see
#: `tie_blows`, below 0 if it gives none.
CONSTRAINT, PLACE, KIND, OWNER, INDEX, SEEN, SUM, LINKED, LATE, TIE_WORDS = 0, 1, 2, 3, 5, 7, 13, 15, 16, 17
#: Where Chipmunk's functions for a tie are among the others.
PRE_STEP, APPLY_IMPULSE = 0, 2


@kernel
def kind_of(t, constraint):  # type: ignore[no-untyped-def]
    """Row of a constraint's kind, or 0 if it is none of Chipmunk's own."""
    notes, functions = integers(t[at.NOTES], NOTES_WORDS), integers(constraint, CONSTRAINT_WORDS)[CONSTRAINT_CLASS]
    for k in range(notes[KINDS_COUNT]):
        row = notes[KINDS] + 8 * KIND_WORDS * k
        if integers(row, KIND_WORDS)[KIND_CLASS] == functions:
            return row
    return 0


@kernel
def tie_at(notes, k):  # type: ignore[no-untyped-def]
    """Row k of a space's ties."""
    return integers(notes[TIES] + 8 * TIE_WORDS * k, TIE_WORDS)


@kernel
def call_for(tie, function, h):  # type: ignore[no-untyped-def]
    """Call one of Chipmunk's functions for a tie, for a time ``h``."""
    functions = integers(integers(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_CLASS], APPLY_IMPULSE + 1)
    call_constraint(functions[function], tie[CONSTRAINT], h)


@kernel
def lift_springs(t, sign):  # type: ignore[no-untyped-def]
    """Take the impulses that springs have given to bodies in this step from these (-1), or put them back (1).

    Also keeps Chipmunk's first iteration from solving a structure's ties, and notes whether any holds it. Where there
    is no stock constraint, there is nothing to do.
    """
    t[at.PINNED] = 0
    if t[at.NOTES] == 0:
        return
    notes, own = integers(t[at.NOTES], NOTES_WORDS), -1
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        if tie[KIND] == 0:
            continue
        w = integers(tie[CONSTRAINT], CONSTRAINT_WORDS)
        for side in range(2):
            if 0 <= find(t, w[CONSTRAINT_BODY_A + side]) < t[at.MOVING]:
                slacken(tie)
                if integers(tie[KIND], KIND_WORDS)[KIND_HOLDS] == 1 and body_of(tie, 1 - side)[MASS_INVERSE] == 0.0:
                    t[at.PINNED] = 1
        if not is_spring(tie):
            continue
        if own < 0:
            own = place_of(t[at.LEADER])
        if tie[PLACE] < own:
            for side in range(2):
                b = body_of(tie, side)
                x, y, turn = given_by(tie, side, impulse_of(tie))
                b[VX] += sign * x * b[MASS_INVERSE]
                b[VX + 1] += sign * y * b[MASS_INVERSE]
                b[SPIN] += sign * turn * b[MOMENT_INVERSE]


@kernel
def is_spring(tie):  # type: ignore[no-untyped-def]
    """Whether a tie is a spring, with or without a damper: it acts before all others do."""
    return integers(tie[KIND], KIND_WORDS)[KIND_COEFFICIENT] != 0


@kernel
def impulse_of(tie):  # type: ignore[no-untyped-def]
    """A tie's impulse in the step so far, a number or two."""
    kind = integers(tie[KIND], KIND_WORDS)
    first = kind[KIND_IMPULSE]
    return floats(tie[CONSTRAINT], first + kind[KIND_COUNT])[first:]


@kernel
def given_by(tie, side, impulse):  # type: ignore[no-untyped-def]
    """What an impulse of a tie gives to its body a (``side`` 0) or b: momentum x, y and moment."""
    px, py, moment = 0.0, 0.0, 0.0
    for row in range(len(impulse)):
        x, y, turn = way_of(tie, side, row)
        px, py, moment = px + impulse[row] * x, py + impulse[row] * y, moment + impulse[row] * turn
    return px, py, moment


@kernel
def place_of(constraint):  # type: ignore[no-untyped-def]
    """Where a constraint is in Chipmunk's list."""
    listed = constraints_with(constraint)
    for k in range(len(listed)):
        if listed[k] == constraint:
            return k
    return len(listed)


@kernel
def way_of(tie, side, row):  # type: ignore[no-untyped-def]
    """What a unit of a tie's impulse does to its body a (``side`` 0) or b: momentum x, y and moment.

    Of its ``row`` 0, or 1 where it works in two directions.
    """
    kind = integers(tie[KIND], KIND_WORDS)
    sign = -1.0 if side == 0 else 1.0
    if kind[KIND_WAY] == LINE or kind[KIND_WAY] == POINT:
        numbers = floats(tie[CONSTRAINT], max(kind[KIND_ARMS] + 4, kind[KIND_AXIS] + 2))
        x, y = (0.0, 1.0) if row == 1 else (1.0, 0.0)
        if kind[KIND_WAY] == LINE:
            x, y = numbers[kind[KIND_AXIS]], numbers[kind[KIND_AXIS] + 1]
        arm_x, arm_y = numbers[kind[KIND_ARMS] + 2 * side], numbers[kind[KIND_ARMS] + 2 * side + 1]
        return sign * x, sign * y, sign * (arm_x * y - arm_y * x)
    return 0.0, 0.0, sign / ratio_of(tie) if side == 0 else sign


@kernel
def ratio_of(tie):  # type: ignore[no-untyped-def]
    """By how much faster body a is to turn than b."""
    word = integers(tie[KIND], KIND_WORDS)[KIND_RATIO]
    return floats(tie[CONSTRAINT], word + 1)[word] if word != 0 else 1.0


@kernel
def slacken(tie):  # type: ignore[no-untyped-def]
    """Give a tie no effective mass, so that Chipmunk leaves it alone."""
    kind = integers(tie[KIND], KIND_WORDS)
    numbers = floats(tie[CONSTRAINT], max(kind[KIND_MASS] + 4, kind[KIND_COEFFICIENT] + 1))
    for i in range(4 if kind[KIND_WAY] == POINT else 1):
        numbers[kind[KIND_MASS] + i] = 0.0
    if kind[KIND_COEFFICIENT] != 0:
        numbers[kind[KIND_COEFFICIENT]] = 0.0


@kernel
def bind(c, t):  # type: ignore[no-untyped-def]
    """Before the first solve of a step: find out whose bodies the ties of the space are at.

    Structures that one leads to from another, or two by way of a loose body, are solved as one.
    """
    if t[at.NOTES] == 0:
        return
    notes = integers(t[at.NOTES], NOTES_WORDS)
    if notes[TIES_COUNT] == 0 or notes[BOUND] == notes[STAMP]:
        return
    notes[BOUND] = notes[STAMP]
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        w = integers(tie[CONSTRAINT], CONSTRAINT_WORDS)
        tie[LINKED] = 0
        for side in range(2):
            tie[OWNER + side], tie[INDEX + side] = home(c, w[CONSTRAINT_BODY_A + side])
        one, other = tie[OWNER], tie[OWNER + 1]
        if tie[KIND] == 0 or (one == 0 and other == 0):
            continue
        slacken(tie)
        target = integers(tie[KIND], KIND_WORDS)[KIND_TARGET]
        if target != 0:
            # Chipmunk's first iteration may have been there.
            floats(tie[CONSTRAINT], target + 1)[target] = 0.0
        for owner in (one, other):
            if owner != 0:
                t = views.control(owner)
                t[at.TIED] += 1
                if t[at.CONTACTS] == 0:
                    # It may become one of a group that has some.
                    clear(views.per_body(t, at.CONTACT_IMPULSE))
        if one != 0 and other != 0 and one != other:
            unite(one, other)
        for side in range(2):
            if tie[OWNER + side] == 0 and body_of(tie, side)[MASS_INVERSE] > 0.0:
                unite_at(w[CONSTRAINT_BODY_A + side], one + other)


@kernel
def unite_at(body, owner):  # type: ignore[no-untyped-def]
    """Have structures that ties lead to from a loose body solved as one with ``owner``."""
    constraint = integers(body, BODY_FULL_WORDS)[CONSTRAINTS]
    while constraint != 0:
        w = integers(constraint, CONSTRAINT_WORDS)
        another, _ = home(owner, w[CONSTRAINT_BODY_B] if w[CONSTRAINT_BODY_A] == body else w[CONSTRAINT_BODY_A])
        if another != 0 and another != owner:
            unite(owner, another)
        constraint = next_at(constraint, body)


@kernel
def is_of(tie, head):  # type: ignore[no-untyped-def]
    """Whether a tie is at a body of a group of structures."""
    owner = tie[OWNER] if tie[OWNER] != 0 else tie[OWNER + 1]
    return tie[KIND] != 0 and owner != 0 and is_one_of(owner, head)


@kernel
def is_one_of(owner, head):  # type: ignore[no-untyped-def]
    """Whether a structure is of a group."""
    return owner == head or views.control(owner)[at.HEAD] == head


@kernel
def address_of(tie, side):  # type: ignore[no-untyped-def]
    """Where body a (``side`` 0) or b of a tie lies."""
    return integers(tie[CONSTRAINT], CONSTRAINT_WORDS)[CONSTRAINT_BODY_A + side]


@kernel
def body_of(tie, side):  # type: ignore[no-untyped-def]
    """Body a (``side`` 0) or b of a tie."""
    return floats(address_of(tie, side), BODY_WORDS)


@kernel
def have_moved(head):  # type: ignore[no-untyped-def]
    """Whether any body at a group's ties has another velocity than when they were solved last."""
    notes = integers(views.control(head)[at.NOTES], NOTES_WORDS)
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        if not is_of(tie, head):
            continue
        seen = floats(notes[TIES] + 8 * (TIE_WORDS * k + SEEN), 6)
        for side in range(2):
            b = body_of(tie, side)
            if seen[3 * side] != b[VX] or seen[3 * side + 1] != b[VX + 1] or seen[3 * side + 2] != b[SPIN]:
                return True
    return False


@kernel
def note_seen(head):  # type: ignore[no-untyped-def]
    """Note the velocities of all bodies at a group's ties."""
    notes = integers(views.control(head)[at.NOTES], NOTES_WORDS)
    for k in range(notes[TIES_COUNT]):
        tie = tie_at(notes, k)
        if is_of(tie, head):
            seen = floats(notes[TIES] + 8 * (TIE_WORDS * k + SEEN), 6)
            for side in range(2):
                b = body_of(tie, side)
                seen[3 * side], seen[3 * side + 1], seen[3 * side + 2] = b[VX], b[VX + 1], b[SPIN]
