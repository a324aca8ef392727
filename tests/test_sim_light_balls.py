"""What is right for a light ball that strikes rigid pieces: two integrations that share nothing agree."""

import pytest
from light_balls import BARS, integrated, simulated

from sim import AVERAGE_ACCELERATION


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_fine_steps_find_what_an_explicit_integration_of_the_pieces_does(restitution: float) -> None:
    """A ball of 0.5 kg on pieces of 0.8 kg, in steps of 1/160000 s and of 4 µs."""
    blow = BARS["cantilever"], 0.5, 100.0, restitution
    fine = simulated(*blow, 160_000, AVERAGE_ACCELERATION, seconds=0.005)
    assert fine.dissipated.sum() == pytest.approx(integrated(*blow, step=4e-6, seconds=0.005), rel=0.01)
