"""What hard cases of the structure solver are held to; ``python tests/hard_case_table.py`` prints them as a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from hard_cases import CASES as OF_STRUCTURES
from hard_cases import Case, largest, momenta
from stock_cases import CASES as BESIDE_STOCK

from sim import DuctileJoint

CASES: dict[str, Callable[[], Case]] = OF_STRUCTURES | BESIDE_STOCK


@dataclass(frozen=True)
class Found:
    """What a case came to.

    Attributes
    ----------
    unconverged : int
        Steps whose residual stayed above the tolerance.
    newton : float
        Newton steps a step.
    outside : float
        How far the worst force was outside its yield surface, as a share of the capacity.
    gap : float
        What the ledger failed to close by, over the largest energy in it.
    created : float
        Energy that came from nowhere at the worst moment, over the largest energy in the ledger: numerical dissipation
        that was negative.
    momentum : float
        Worst change of the momenta in a step where nothing acts from outside, over the sum of their parts' sizes.
    broken : int
        Joints that broke.
    """

    unconverged: int
    newton: float
    outside: float
    gap: float
    created: float
    momentum: float
    broken: int


def run(case: Case) -> Found:
    """Step a case, and look at it after each step."""
    outside, created, gap, momentum, size = 0.0, 0.0, 0.0, 0.0, 1e-300
    joints = [c for c in case.space.constraints if isinstance(c, DuctileJoint)]
    structures = {case.structure: None}
    before, _ = momenta(case.bodies)
    for step in range(case.steps):
        case.act(step)
        case.space.step(case.dt)
        structures |= {joint.structure: None for joint in joints if joint.structure is not None}
        for structure in structures:
            energy = structure.energy
            size = max(size, largest(energy))
            gap, created = max(gap, abs(energy.gap)), max(created, -energy.numerical)
            outside = max(outside, float(structure.utilisation.max()) - 1.0)
        now, parts = momenta(case.bodies)
        assert np.isfinite(now).all()
        assert all(math.isfinite(x) for b in case.bodies for x in (*b.position, b.angle))
        momentum = max(momentum, float(np.abs(now - before).max()) / parts) if case.isolated else 0.0
        before = now
    steps = sum(structure.newton_steps for structure in structures)
    unconverged = sum(structure.unconverged for structure in structures)
    broken = sum(joint.broken for joint in joints)
    return Found(unconverged, steps / case.steps, outside, gap / size, created / size, momentum, broken)


def table() -> Iterator[str]:
    """The table, line by line, in Markdown."""
    yield "| case | steps | dt [s] | Newton | not converged | outside yield | ledger gap | created | momentum |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for name, build in CASES.items():
        case = build()
        dt, found = case.dt, run(case)
        shares = (found.outside, found.gap, found.created)
        momentum = f"{found.momentum:.0e}" if case.isolated else ""
        yield (
            f"| {name} | {case.steps} | {dt:.2g} | {found.newton:.1f} | {found.unconverged} | "
            + " | ".join(f"{share:.0e}" if share else "0" for share in shares)
            + f" | {momentum} |"
        )


if __name__ == "__main__":
    for line in table():
        print(line, flush=True)
