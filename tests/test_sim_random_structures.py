"""Structures at random (`python benchmarks/random_structures.py` runs hundreds) keep to what hard cases are held to."""

import pytest
from random_cases import RandomCase
from watched_cases import watch

from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER

# Stiff ones that are pushed, set going or struck while they ring, some in steps that change, or kicked under tension.
HARD = (65, 141, 192, 261, 296, 371)


@pytest.mark.parametrize("seed", [*range(11, 31), *HARD])
def test_all_is_well_by_the_default_scheme(seed: int) -> None:
    """Energy is not created, momenta are kept, no joint bears too much, every step converges and none is refused."""
    assert watch(RandomCase(seed, IMPLICIT_EULER)).faults(default=True) == []


def test_a_seed_says_everything() -> None:
    assert str(RandomCase(3)) == str(RandomCase(3))
    assert watch(RandomCase(3)) == watch(RandomCase(3))


@pytest.mark.parametrize("seed", [*range(11, 31), 907, 1952])
def test_the_second_order_scheme_creates_little(seed: int) -> None:
    """No more than 0.15 of the energy there is; in the last two unresolved steps gave 0.17 and 0.96 of it."""
    found = watch(RandomCase(seed, AVERAGE_ACCELERATION))
    assert not found.faulty("created", default=False)
    assert found.refused == 0
