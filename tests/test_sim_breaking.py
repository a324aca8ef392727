"""Breaking: it costs what the joint had to give, at any step."""

import math

import pymunk
import pytest
from bodies import piece

from sim import DuctileJoint, ElasticPlastic, Limits


@pytest.mark.parametrize("mode", ["elongation", "slip", "rotation"])
def test_energy_of_breaking_does_not_depend_on_the_step(mode: str) -> None:
    """A fast body that breaks a joint loses what the joint had to give, at dt = 1/60 as at 1/4000 s."""
    capacity, limit = 1000.0, 0.2
    lost = []
    for dt in (1 / 60, 1 / 240, 1 / 1000, 1 / 4000):
        space = pymunk.Space()
        body = piece(space, 10.0, 10.0, 0.0, 0.0)
        law = ElasticPlastic((1e8, 1e8, 1e8), (capacity, capacity, capacity))
        joint = DuctileJoint(space.static_body, body, (0.0, 0.0), law, direction=0.0, limits=Limits(**{mode: limit}))
        space.add(joint)
        if mode == "rotation":
            body.angular_velocity = 30.0
        else:
            body.velocity = (30.0, 0.0) if mode == "elongation" else (0.0, 30.0)
        before = 0.5 * body.kinetic_energy
        for _ in range(math.ceil(0.1 / dt)):
            space.step(dt)
        assert joint.broken
        lost.append(before - 0.5 * body.kinetic_energy)
        assert joint.dissipated == pytest.approx(capacity * limit, rel=0.01)
    assert max(lost) / min(lost) < 1.05
    assert lost[-1] == pytest.approx(capacity * limit, rel=0.01)


def test_compression_may_be_exempt_from_breaking() -> None:
    for counts in (False, True):
        space = pymunk.Space()
        body = piece(space, 10.0, 10.0, 1.0, 0.0)
        law = ElasticPlastic((1e8, 1e8, 1e8), (1000.0, 1e6, 1e6))
        limits = Limits(elongation=0.1, compression_counts=counts)
        joint = DuctileJoint(space.static_body, body, (0.0, 0.0), law, limits=limits)
        space.add(joint)
        body.velocity = (-10.0, 0.0)
        for _ in range(60):
            space.step(1 / 240)
        assert joint.broken is counts
        if not counts:
            assert joint.plastic_deformation[1] == pytest.approx(0.5, rel=0.05)
