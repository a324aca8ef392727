"""What random structures are held to, step by step."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields

import numpy as np
import pymunk
from hard_cases import largest, momenta
from random_cases import STEPS, RandomCase

from sim import Structure
from sim.laws import FibreSection, InteractionPlastic
from sim.step_back import SolverError

# What is held to be rounding, entry by entry of `Watched` (places of bodies are rounded to so much of what the stiffest
# joints bear); energy that the second-order scheme may create.
_ROUNDING = {"created": 1e-12, "outside": 1e-7, "gap": 1e-11, "momentum": 1e-13, "angular": 1e-11}
_MAY_CREATE = 0.15
# What rounding of places stores in the stiffest joints is nothing against it [J].
_LITTLE = 1e-3
_NAMES = {
    "created": "numerical dissipation below zero",
    "unconverged": "solves that do not converge",
    "refused": "refused",
    "outside": "outside yield",
    "gap": "ledger gap",
    "momentum": "momentum",
    "angular": "angular momentum",
}


@dataclass
class Watched:
    """The worst of a case.

    Attributes
    ----------
    created : float
        Energy from nowhere, numerical dissipation below zero: over the largest entry of any ledger so far by implicit
        Euler, over the energy there is by the second-order scheme.
    unconverged, refused : int
        Solves that ended above the tolerance; whether a step was refused.
    outside : float
        How far a force was outside its yield surface, as a share of the capacity, where nothing damps.
    gap : float
        What ledgers failed to close by, over their largest entry so far.
    momentum, angular : float
        Change of either momentum in a step where nothing acts from outside, over the largest sum of its parts' sizes;
        the angular one where nothing is loose, and not in the step after a kick, which acts a step further on.
    """

    created: float = 0.0
    unconverged: int = 0
    refused: int = 0
    outside: float = 0.0
    gap: float = 0.0
    momentum: float = 0.0
    angular: float = 0.0

    def faulty(self, name: str, default: bool) -> bool:
        """Whether an entry is beyond what it is held to."""
        most = _ROUNDING.get(name, 0.0) if default or name != "created" else _MAY_CREATE
        return bool(not getattr(self, name) <= most)

    def faults(self, default: bool) -> list[str]:
        """What is beyond what it is held to, by the default scheme or the second-order one."""
        return [f"{_NAMES[f.name]} {getattr(self, f.name):.2g}" for f in fields(self) if self.faulty(f.name, default)]

    @classmethod
    def summary(cls, rows: Iterable[Watched], default: bool) -> Iterator[tuple[str, int, float]]:
        """By entry, in how many it is beyond that, and the worst."""
        rows = list(rows)
        for f in fields(cls):
            count = sum(row.faulty(f.name, default) for row in rows)
            yield _NAMES[f.name], count, max(getattr(row, f.name) for row in rows)


def watch(case: RandomCase, steps: int = STEPS) -> Watched:
    """Step a case, and look at it after each step."""
    found, size, most, structures = Watched(), _LITTLE, 1e-9, dict[Structure, None]()
    for _ in range(steps):
        acted = case.act()
        (before, _), isolated = momenta(_all_of(case)), case.isolated
        try:
            case.step()
        except SolverError:
            found.refused += 1
            break
        structures |= {joint.structure: None for joint in case.joints if joint.structure is not None}
        for structure in structures:
            if not structure.superseded:
                size = max(size, largest(structure.energy))
        for structure in structures:
            if not structure.superseded:
                _look_at(structure, size, case.scheme[0] == 0.0, found)
        now, parts = momenta(_all_of(case))
        if not np.isfinite(now).all():
            found.gap = np.inf
            break
        most = max(most, parts)
        if isolated:
            change = np.abs(now - before)
            found.momentum = max(found.momentum, float(change[:2].max()))
            if not (case.loose or case.stock or acted):
                found.angular = max(found.angular, float(change[2]))
    found.momentum, found.angular = found.momentum / most, found.angular / most
    found.unconverged = sum(structure.unconverged for structure in structures)
    return found


def _all_of(case: RandomCase) -> list[pymunk.Body]:
    return [*case.pieces, *case.loose]


def _look_at(structure: Structure, size: float, default: bool, found: Watched) -> None:
    energy = structure.energy
    there = size if default else max(energy.kinetic + energy.elastic, abs(energy.external), _LITTLE)
    found.created = max(found.created, -energy.numerical / there)
    found.gap = max(found.gap, abs(energy.gap) / size)
    if not any(structure.joints[0].damping):
        found.outside = max(found.outside, _outside(structure))


def _outside(structure: Structure) -> float:
    """How far the worst force of a structure is outside its yield surface; all its joints have one law."""
    law, share = structure.joints[0].law, structure.utilisation
    if isinstance(law, InteractionPlastic):
        share = np.array([law.surface.value(*force) for force in structure.force])
        share = share[structure.active]
    elif isinstance(law, FibreSection):
        share = share[:, 1]
    return float(share.max(initial=0.0)) - 1.0
