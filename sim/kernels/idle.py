"""Joints that another one acts for, out of Chipmunk's list of constraints while it solves.

Going through thousands of joints that have nothing to do, in every iteration, would cost more than the solve. They
leave the list before the first iteration, when all have begun their step. The first joint that acts for others sees to
it, and to it that they are back when its step ends; in between its place in the list is the same, so that Chipmunk goes
on from there, and comes to the others' own ends of the step.
"""

from sim.chipmunk import CONSTRAINT_CLASS, LIST_COUNT, LIST_ITEMS
from sim.kernels import layout as at
from sim.kernels.noted import BY, LENGTHS, LISTS, NOTES_WORDS
from sim.kernels.owners import constraints_with, list_of_constraints
from sim.memory import inlined, integers


@inlined
def leave_out(t, constraint):  # type: ignore[no-untyped-def]
    """Take the joints that do not act out of the list, if ``constraint`` is the first that does."""
    notes, listed = integers(t[at.NOTES], NOTES_WORDS), constraints_with(constraint)
    if t[at.NOTES] == 0 or notes[BY] != 0 or notes[LENGTHS + 1] != len(listed):
        return
    notes[BY] = constraint
    kept, beyond = 0, False
    if t[at.CALLED] == len(listed):
        kept = 1  # all are of one structure
    else:
        for k in range(len(listed)):
            if not beyond or integers(listed[k], 1)[CONSTRAINT_CLASS] != t[at.OWN_CLASS]:
                listed[kept] = listed[k]
                kept += 1
            beyond = beyond or listed[k] == constraint
    list_of_constraints(constraint)[LIST_COUNT] -= len(listed) - kept


@inlined
def bring_back(t, constraint):  # type: ignore[no-untyped-def]
    """Put the list back to what it was, if ``constraint`` has changed it."""
    notes = integers(t[at.NOTES], NOTES_WORDS)
    if t[at.NOTES] == 0 or notes[BY] != constraint:
        return
    notes[BY] = 0
    head, count = list_of_constraints(constraint), notes[LENGTHS + 1]
    head[LIST_COUNT] += count - (head[LIST_COUNT] & 0xFFFFFFFF)
    listed, before = integers(head[LIST_ITEMS], count), integers(notes[LISTS + 1], count)
    for k in range(count):
        listed[k] = before[k]
