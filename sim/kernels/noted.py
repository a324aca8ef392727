"""What a step changes of a space beside its structures, noted as the step begins, so that it can be taken back.

Loose bodies, contacts and Chipmunk's own constraints, in memory that all structures of a space share (`sim.noted`).
Which there are is looked up in Python, once; a step compares the space's lists with those that were looked through.

When a step begins, Chipmunk has moved the bodies, and taken their pseudo-velocities from them: both are noted when a
step ends.
"""

import numpy as np

from sim.chipmunk import (
    ANGLE,
    ARBITER_CONTACTS,
    ARBITER_COUNT,
    ARBITER_WORDS,
    ARBITERS_OF_SPACE,
    BIAS_VX,
    BODY_FULL_WORDS,
    BODY_WORDS,
    CONSTRAINT_SPACE,
    CONSTRAINT_WORDS,
    CONSTRAINTS_OF_SPACE,
    CONTACT_BYTES,
    CONTACT_NORMAL_IMPULSE,
    CONTACT_WORDS,
    COSINE,
    CURRENT_STEP,
    LIST_COUNT,
    LIST_ITEMS,
    LIST_WORDS,
    MASS_INVERSE,
    MOVING_BODIES,
    SPACE_STAMP,
    SPACE_WORDS,
    SPIN,
    VX,
    X,
)
from sim.kernels import layout as at
from sim.kernels.inertia import mass_of, moment_of
from sim.memory import call_notice, floats, inlined, integers, kernel

#: Words of the table: the step that was noted, how many structures have begun it and not ended it, the step after which
#: bodies were noted, the one in which Python looked through the space; bits of the lengths of this one and of the last;
#: copies of the lists of moving bodies and of constraints, and how long they are; rows of loose bodies and how many;
#: own constraints and how many, and room for their numbers; rows of contacts, how many there is room for, and how many
#: were noted; all own constraints, how many, their kinds and how many (see `ties`), and the step in which they were
#: given to structures; the joint that took others out of Chipmunk's list until it ends its step (see `idle`), or 0.
STAMP, UNDER_WAY, ENDED, LOOKED, THIS_STEP, LAST_STEP = range(6)
LISTS, LENGTHS = 6, 8
LOOSE, LOOSE_COUNT, STOCK, STOCK_COUNT, STOCK_NUMBERS, CONTACTS, CONTACTS_ROOM, CONTACTS_COUNT = range(10, 18)
TIES, TIES_COUNT, KINDS, KINDS_COUNT, BOUND, BY = range(18, 24)
NOTES_WORDS = 24
#: A loose body's row: its address; x, y, angle, the six words of its transform, and pseudo-velocities at the end of the
#: last step; velocities and x, y, angle when this one has moved it.
#: From there on: the last step in which structures did work on it, and that work [J]; the last step that it went
#: through in parts, where they began, what it was given on going back to when it touched [J], for how long forces act
#: in them [s], the way that they do so along, and velocities at the start of the last one; what its contacts with other
#: such bodies, and with held ones, have lost in parts [J]; 1 while contacts beside a group are gathered for it.
PLACE, PUSH, SPEED, MOVED = 1, 10, 13, 16
WORKED, WORK, IN_PARTS, BEGUN, GIVEN, SPAN, WAY, LAST = 19, 20, 21, 22, 25, 26, 27, 30
LOST, MATE, LOOSE_WORDS = 33, 34, 35
#: Of own constraints: address of their first number, and how many.
STOCK_WORDS = 2
#: Of a contact: its address, its normal and tangential impulse, and those that parts of a step began with, if either of
#: its bodies went through any; no number there, if it went through them itself.
CONTACT_ROW = 5


@kernel
def ask(t, what):  # type: ignore[no-untyped-def]
    """Ask Python for something."""
    t[at.ASKED] = what
    call_notice(t[at.NOTICE], t[at.KEY])
    t[at.ASKED] = 0


@inlined
def note_start(t):  # type: ignore[no-untyped-def]
    """Note, once in a step, how the rest of the space begins it."""
    if t[at.NOTES] == 0:
        return  # none of its bodies is in a space any more
    space = integers(integers(t[at.LEADER], CONSTRAINT_WORDS)[CONSTRAINT_SPACE], SPACE_WORDS)
    notes = integers(t[at.NOTES], NOTES_WORDS)
    t[at.SEEN] = space[SPACE_STAMP]
    if notes[STAMP] == space[SPACE_STAMP]:
        notes[UNDER_WAY] += 1
        return
    notes[STAMP], notes[UNDER_WAY], notes[THIS_STEP] = space[SPACE_STAMP], 1, space[CURRENT_STEP]
    for i in range(notes[LOOSE_COUNT]):
        row = notes[LOOSE] + 8 * LOOSE_WORDS * i
        r, b = floats(row, LOOSE_WORDS), floats(integers(row, 1)[0], BODY_FULL_WORDS)
        r[SPEED], r[SPEED + 1], r[SPEED + 2] = b[VX], b[VX + 1], b[SPIN]
        r[MOVED], r[MOVED + 1], r[MOVED + 2] = b[X], b[X + 1], b[ANGLE]
    into, stock = notes[STOCK_NUMBERS], integers(notes[STOCK], STOCK_WORDS * notes[STOCK_COUNT])
    for i in range(notes[STOCK_COUNT]):
        count = stock[STOCK_WORDS * i + 1]
        own, kept = floats(stock[STOCK_WORDS * i], count), floats(into, count)
        for k in range(count):
            kept[k] = own[k]
        into += 8 * count
    note_contacts(notes, space)


@inlined
def note_contacts(notes, space):  # type: ignore[no-untyped-def]
    """Note the impulses that all contacts begin with."""
    head, noted = integers(space[ARBITERS_OF_SPACE], LIST_WORDS), 0
    arbiters = integers(head[LIST_ITEMS], head[LIST_COUNT] & 0xFFFFFFFF)
    for i in range(len(arbiters)):
        w = integers(arbiters[i], ARBITER_WORDS)
        for k in range(w[ARBITER_COUNT] & 0xFFFFFFFF):
            where, row = w[ARBITER_CONTACTS] + CONTACT_BYTES * k, notes[CONTACTS] + 8 * CONTACT_ROW * noted
            contact, r = floats(where, CONTACT_WORDS), floats(row, CONTACT_ROW)
            integers(row, 1)[0] = where
            r[1], r[2] = contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_NORMAL_IMPULSE + 1]
            r[3], r[4] = 0.0, 0.0
            noted += 1
    notes[CONTACTS_COUNT] = noted


@inlined
def is_known(t, constraint):  # type: ignore[no-untyped-def]
    """Whether the space of a structure's constraint is as Python has found it, in the step that begins."""
    if t[at.NOTES] == 0:
        return False
    space = integers(integers(constraint, CONSTRAINT_WORDS)[CONSTRAINT_SPACE], SPACE_WORDS)
    notes = integers(t[at.NOTES], NOTES_WORDS)
    now = space[SPACE_STAMP]
    return notes[STAMP] == now or notes[LOOKED] == now or not is_outdated(notes, space)


@inlined
def is_outdated(notes, space):  # type: ignore[no-untyped-def]
    """Whether the space has other bodies or constraints by now, or more contacts than there is room for.

    Or there was a step without any structure: what then left may be back.
    """
    if notes[ENDED] != space[SPACE_STAMP] - 1:
        return True
    for i in range(2):
        head = integers(space[MOVING_BODIES if i == 0 else CONSTRAINTS_OF_SPACE], LIST_WORDS)
        count = head[LIST_COUNT] & 0xFFFFFFFF
        if count != notes[LENGTHS + i]:
            return True
        now, then, differs = integers(head[LIST_ITEMS], count), integers(notes[LISTS + i], count), 0
        for k in range(count):
            differs |= now[k] ^ then[k]
        if differs != 0:
            return True
    head, contacts = integers(space[ARBITERS_OF_SPACE], LIST_WORDS), 0
    arbiters = integers(head[LIST_ITEMS], head[LIST_COUNT] & 0xFFFFFFFF)
    for i in range(len(arbiters)):
        contacts += integers(arbiters[i], ARBITER_WORDS)[ARBITER_COUNT] & 0xFFFFFFFF
    return contacts > notes[CONTACTS_ROOM]


@kernel
def row_of(t, body):  # type: ignore[no-untyped-def]
    """Where the row of a loose body lies."""
    notes = integers(t[at.NOTES], NOTES_WORDS)
    row = notes[LOOSE]
    for _ in range(notes[LOOSE_COUNT]):
        if integers(row, 1)[0] == body:
            return row
        row += 8 * LOOSE_WORDS
    return 0


@kernel
def note_work(t, body, work, lost):  # type: ignore[no-untyped-def]
    """Note what contacts do on a loose body that are solved with a structure: work, and energy lost beside it [J]."""
    row, stamp = row_of(t, body), integers(t[at.NOTES], NOTES_WORDS)[STAMP]
    if row != 0:
        r = floats(row, LOOSE_WORDS)
        if r[WORKED] != stamp:
            r[WORKED], r[WORK], r[LOST] = stamp, 0.0, 0.0
        r[WORK] += work
        r[LOST] += lost


@kernel
def note_parts(t, bodies):  # type: ignore[no-untyped-def]
    """Note that the step of these bodies is taken in parts, and where the dynamic ones are; returns their rows."""
    rows, stamp = np.zeros(len(bodies), np.int64), integers(t[at.NOTES], NOTES_WORDS)[STAMP]
    for i in range(len(bodies)):
        b = floats(bodies[i], BODY_WORDS)
        if b[MASS_INVERSE] > 0.0:
            rows[i] = row_of(t, bodies[i])
            r = floats(rows[i], LOOSE_WORDS)
            r[IN_PARTS], r[BEGUN], r[BEGUN + 1], r[BEGUN + 2] = stamp, b[X], b[X + 1], b[ANGLE]
            r[GIVEN], r[SPAN], r[WAY], r[WAY + 1], r[WAY + 2] = 0.0, 0.0, 0.0, 0.0, 0.0
    return rows


@kernel
def note_given(rows, bodies, way):  # type: ignore[no-untyped-def]
    """Add the bodies' kinetic energies to what they were given, ``way`` times."""
    for i in range(len(bodies)):
        if rows[i] != 0:
            r, b = floats(rows[i], LOOSE_WORDS), floats(bodies[i], BODY_WORDS)
            square = mass_of(b) * (b[VX] * b[VX] + b[VX + 1] * b[VX + 1]) + moment_of(b) * b[SPIN] * b[SPIN]
            r[GIVEN] += 0.5 * way * square


@kernel
def note_struck(t, arbiter):  # type: ignore[no-untyped-def]
    """Note the impulses that the contacts of an arbiter have when parts begin."""
    notes, w = integers(t[at.NOTES], NOTES_WORDS), integers(arbiter, ARBITER_WORDS)
    for k in range(w[ARBITER_COUNT] & 0xFFFFFFFF):
        where = w[ARBITER_CONTACTS] + CONTACT_BYTES * k
        row = row_of_contact(notes, where)
        if row != 0:
            contact, r = floats(where, CONTACT_WORDS), floats(row, CONTACT_ROW)
            r[3], r[4] = contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_NORMAL_IMPULSE + 1]


@kernel
def row_of_contact(notes, where):  # type: ignore[no-untyped-def]
    """Where the row of the contact at an address lies, or 0."""
    for i in range(notes[CONTACTS_COUNT]):
        row = notes[CONTACTS] + 8 * CONTACT_ROW * i
        if integers(row, 1)[0] == where:
            return row
    return 0


@kernel
def note_last(rows, bodies, h):  # type: ignore[no-untyped-def]
    """Note the velocities at the start of the last part, in which forces act for a time ``h``."""
    for i in range(len(bodies)):
        if rows[i] != 0:
            r, b = floats(rows[i], LOOSE_WORDS), floats(bodies[i], BODY_WORDS)
            r[LAST], r[LAST + 1], r[LAST + 2] = b[VX], b[VX + 1], b[SPIN]
            note_way(rows[i], bodies[i], 0.5 * h)


@kernel
def note_ways(rows, bodies, h):  # type: ignore[no-untyped-def]
    """Add the ways that bodies go in a time ``h`` to those along which forces act."""
    for i in range(len(bodies)):
        if rows[i] != 0:
            note_way(rows[i], bodies[i], h)


@kernel
def note_way(row, body, h):  # type: ignore[no-untyped-def]
    """The same for one body."""
    r, b = floats(row, LOOSE_WORDS), floats(body, BODY_WORDS)
    r[SPAN], r[WAY], r[WAY + 1] = r[SPAN] + h, r[WAY] + h * b[VX], r[WAY + 1] + h * b[VX + 1]
    r[WAY + 2] += h * b[SPIN]


@inlined
def note_end(t):  # type: ignore[no-untyped-def]
    """Note how the loose bodies end a step, once all structures have."""
    if t[at.NOTES] == 0:
        return
    notes = integers(t[at.NOTES], NOTES_WORDS)
    notes[UNDER_WAY] -= 1
    if notes[UNDER_WAY] != 0:
        return
    notes[ENDED], notes[LAST_STEP] = notes[STAMP], notes[THIS_STEP]
    for i in range(notes[LOOSE_COUNT]):
        row = notes[LOOSE] + 8 * LOOSE_WORDS * i
        r, b = floats(row, LOOSE_WORDS), floats(integers(row, 1)[0], BODY_FULL_WORDS)
        r[PLACE], r[PLACE + 1], r[PLACE + 2] = b[X], b[X + 1], b[ANGLE]
        for k in range(6):
            r[PLACE + 3 + k] = b[COSINE + k]
        for k in range(3):
            r[PUSH + k] = b[BIAS_VX + k]
