"""Whatever comes, goes and comes back: energy is not created, momentum is kept, and all is the same a second time."""

import numpy as np
import pytest
from lifecycles import KINDS, Life

from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER, SystemLedger

STEPS = 150


def live(life: Life) -> tuple[float, bytes]:
    """Live on; the least numerical dissipation of any structure, over the most energy there was, and all numbers.

    Ledgers close to rounding, those of structures and that of the space, and everything is finite.
    """
    ledger, least, most, path = SystemLedger(life.space), 0.0, 1e-9, b""
    for _ in range(STEPS):
        life.step()
        ledger.note()
        numbers = life.numbers
        assert np.isfinite(numbers).all()
        path += numbers.tobytes()
        assert all(joint.structure is not None for joint in life.joints)
        for structure in life.structures:
            energy = structure.energy
            most = max(most, energy.kinetic + energy.elastic, abs(energy.external))
            assert abs(energy.gap) <= 1e-11 * most
            least = min(least, energy.numerical / most)
        assert abs(ledger.energy.gap) <= 1e-10 * max(most, abs(ledger.energy.external))
    return least, path


@pytest.mark.parametrize("seed", range(16))
def test_no_energy_is_created(seed: int) -> None:
    least, _ = live(Life(seed, IMPLICIT_EULER))
    assert least >= -1e-12


def test_lives_are_full() -> None:
    """All that may happen does, in the lives above."""
    done = dict.fromkeys(KINDS, 0)
    for seed in range(16):
        life = Life(seed, IMPLICIT_EULER)
        for _ in range(STEPS):
            life.step()
        done = {kind: done[kind] + life.done[kind] for kind in KINDS}
    assert min(done.values()) > 10, done


@pytest.mark.parametrize("seed", [3, 5])
@pytest.mark.parametrize("scheme", [IMPLICIT_EULER, AVERAGE_ACCELERATION])
def test_a_life_is_the_same_a_second_time(seed: int, scheme: tuple[float, float]) -> None:
    assert live(Life(seed, scheme))[1] == live(Life(seed, scheme))[1]


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("scheme", [IMPLICIT_EULER, AVERAGE_ACCELERATION])
def test_momentum_is_kept_where_nothing_acts_from_outside(seed: int, scheme: tuple[float, float]) -> None:
    """Linear and angular, in each step; what the user adds and takes away between steps brings and takes its own."""
    life, most = Life(seed, scheme, isolated=True), 1e-9
    for _ in range(STEPS):
        life.change()
        before = life.momenta
        life.space.step(life.dt)
        most = max(most, sum(b.mass * (b.velocity.length * (1.0 + b.position.length)) for b in life.space.bodies))
        assert np.abs(life.momenta - before).max() <= 1e-11 * most
