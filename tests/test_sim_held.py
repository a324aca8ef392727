"""Structures that pymunk's own constraints hold, and bodies that hang on them, in parts of a step.

What they do at any step is in `step_sweeps`.
"""

import numpy as np
import pymunk
import pytest
from hard_cases import largest
from held_cases import HELD, dragged, loaded_bar
from test_sim_striking_vehicles import momenta

from sim import SystemLedger
from sim.kernels import layout as at

FINE = {
    "beam on a pivot and a groove of pymunk's that 100 kg fall on by 1 m: peak [m], plastic work [J]": (0.0502, 873.0),
    "cantilever on a damped spring that 100 kg fall on by 1 m": (0.0877, 792.0),
    "bar on four damped springs that 50 kg strike at 15 m/s": (0.205, 4065.0),
    "100 kg on a pivot at a cantilever's tip are set going at 5 m/s": (0.141, 1332.0),
    "100 kg fall by 1 m into a rope (a slide joint) at its tip": (0.110, 1017.0),
    "bar on a pivot and a gear that 50 kg strike at 8 m/s": (0.123, 1469.0),
}


@pytest.mark.parametrize("name", FINE)
def test_a_blow_at_60_hz_does_what_whole_steps_of_25_microseconds_do(name: str) -> None:
    """These are taken whole, as they are shorter than parts."""
    assert HELD[name](60, 10) == pytest.approx(FINE[name], rel=0.05)


@pytest.mark.parametrize("name", HELD)
def test_energy_of_what_ties_hold_goes_somewhere_and_comes_from_nowhere(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain, ledgers = pymunk.Space.step, {}

    def step(space: pymunk.Space, dt: float) -> None:
        ledger = ledgers.setdefault(space, SystemLedger(space))
        plain(space, dt)
        ledger.note()
        now = ledger.energy
        assert abs(now.gap) <= 1e-12 * largest(now)
        assert now.numerical >= -1e-12 * largest(now)
        assert now.contact >= -1e-12 * largest(now)

    monkeypatch.setattr(pymunk.Space, "step", step)
    HELD[name](60, 10)
    assert len(ledgers) == 1


@pytest.mark.parametrize("rate", [60, 240, 1000])
def test_momentum_of_a_free_bar_with_a_load_on_a_pivot_is_kept(rate: int) -> None:
    """Linear to rounding, as read between the steps; angular but for what a pivot's two points are apart."""
    space, _, joints = loaded_bar(10)
    before, in_parts = momenta(space), False
    for _ in range(rate // 10):
        space.step(1.0 / rate)
        changed = np.abs(momenta(space) - before)
        assert changed[:2].max() <= 1e-12 * 400.0
        assert changed[2] <= 5e-4 * 400.0
        assert joints[0].structure is not None
        in_parts |= joints[0].structure.tables.control[at.PARTS] > 1
    assert in_parts


def test_what_is_at_rest_on_ties_is_taken_in_whole_steps() -> None:
    """A bar with a load on a pivot, in no gravity."""
    space, _, joints = loaded_bar(10)
    ball = list(space.bodies)[-1]
    space.remove(ball, *ball.shapes)
    for _ in range(5):
        space.step(1 / 60)
        assert joints[0].structure is not None
        assert joints[0].structure.tables.control[at.PARTS] == 1


@pytest.mark.parametrize("drift", [0.0, 3.0])
def test_a_kinematic_support_that_starts_at_once_does_the_same_work_at_any_step(drift: float) -> None:
    """It was anything from a tenth to ten times as much: it had moved for a step before joints could resist."""
    works = []
    for rate in (60, 240, 1000):
        structure, base = dragged(rate, 10, drift)
        assert base.position == pytest.approx(
            (drift * (rate // 10 + rate // 4) / rate, 5.0 * (rate // 4) / rate), rel=1e-12
        )
        assert abs(structure.energy.gap) <= 1e-12 * largest(structure.energy)
        assert structure.energy.numerical >= 0.0
        works.append(float(structure.dissipated.sum()))
    assert max(works) <= 1.08 * min(works)
