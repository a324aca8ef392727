"""What joints store that were strained before their first step: bent by hand, or taken out and put in again.

It comes from outside, all of it: what their laws store there, and what they do as plastic work on the way.
"""

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.commit import copy
from sim.kernels.layout import (
    COMMIT_WORDS,
    LEDGER_ELASTIC,
    LEDGER_EXTERNAL,
    RESULT_BEFORE,
    RESULT_ELASTIC,
    SCRATCH_Q,
    SCRATCH_STATE,
)
from sim.memory import call_law, floats, inlined


@inlined
def book_strained(t):  # type: ignore[no-untyped-def]
    """Book what joints store that are stepped for the first time."""
    active, deformation, laws = views.active(t), views.per_joint(t, at.DEFORMATION), views.laws(t)
    result, ledger = views.result(t), views.ledger(t)
    q, trial = t[at.SCRATCH] + 8 * SCRATCH_Q, t[at.SCRATCH] + 8 * SCRATCH_STATE
    out, place = floats(t[at.SCRATCH], COMMIT_WORDS), floats(q, 3)
    for k in range(t[at.JOINTS]):
        if active[k] != at.UNKNOWN:
            continue
        active[k] = 1
        for i in range(3):
            place[i] = deformation[k, i]
        copy(laws[k, 3], trial, laws[k, 4])
        call_law(laws[k, 1], laws[k, 2], trial, q, t[at.SCRATCH])
        energy = out[0] + out[1]
        result[k, RESULT_BEFORE], result[k, RESULT_ELASTIC] = energy, energy
        ledger[LEDGER_ELASTIC] += energy
        ledger[LEDGER_EXTERNAL] += energy
