"""What a structure takes over from one some of whose joints were replaced."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim.joint import DuctileJoint
from sim.kernels import layout as at
from sim.structure import Structure


@dataclass(frozen=True)
class Heir:
    """What a new joint begins with.

    Attributes
    ----------
    state : (n,) float
        Of its law.
    result : (words,) float
        As the kernels leave it after a step; see `sim.kernels.layout`.
    """

    state: np.ndarray
    result: np.ndarray


def external_force(structure: Structure) -> np.ndarray:
    """Forces x, y [N] and moments [N m] on the bodies from outside in the last step, contacts aside, (n, 3)."""
    tables = structure.tables
    impulse = tables[at.EXTERNAL].copy()
    if tables.control[at.SPREAD]:
        impulse += tables[at.SETTINGS][at.SPREAD_IMPULSE] * tables[at.PATTERN]
    force: np.ndarray = impulse / tables[at.SETTINGS][at.STEP]
    return force


def succeed(
    old: Structure, joints: Sequence[DuctileJoint], heirs: Mapping[DuctileJoint, Heir], work: float
) -> Structure:
    """A structure of ``joints`` that goes on where ``old`` ended.

    Its ledger goes on, with the ``work`` [J] done on the pieces as they were put to their new places. What does not
    arrive is numerical.
    """
    passed_on = old.energy
    new = Structure([joint for joint in joints if not joint.broken], old.tolerance, old)
    tables, before = new.tables, old.tables
    for joint, heir in heirs.items():
        if joint.structure is new:
            tables.state(joint.index)[:] = heir.state
            tables[at.RESULT][joint.index], tables[at.ACTIVE][joint.index] = heir.result, 1
            # Where the next step is to find it, or the average-acceleration rule is not used; see `resolved`.
            tables[at.DEFORMATION][joint.index] = heir.result[:3]
    # Pieces were put to where velocities alone lead on.
    tables[at.LAST_POSITION][:] = np.nan
    tables.control[at.SHIFTED] = 0
    tables[at.SETTINGS][:] = before[at.SETTINGS]
    for count in (at.PARTS, at.NEWTON_STEPS, at.UNCONVERGED):
        tables.control[count] = before.control[count]
    # What bore on pieces that are new is not known, and not sudden.
    tables[at.LAST_FORCE][[body not in old.bodies for body in new.bodies]] = np.nan
    ledger = tables[at.LEDGER]
    ledger[at.LEDGER_ELASTIC] = 0.5 * tables[at.RESULT][:, [at.RESULT_BEFORE, at.RESULT_ELASTIC]].sum()
    ledger[at.LEDGER_EXTERNAL] = passed_on.external + work
    present = passed_on.kinetic + passed_on.elastic - ledger[at.LEDGER_KINETIC] - ledger[at.LEDGER_ELASTIC]
    ledger[at.LEDGER_NUMERICAL] += work + present
    return new
