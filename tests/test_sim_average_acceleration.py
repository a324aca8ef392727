"""The second-order time integration: how it vibrates, and what its ledger says."""

import math

import numpy as np
import pytest
from bodies import kinetic, spring
from cantilevers import cantilever
from hard_cases import chain, law

import sim
from sim import AVERAGE_ACCELERATION, Structure
from sim.kernels import layout as at


def test_average_acceleration_dissipates_nothing_of_its_own() -> None:
    """A free oscillation at 20 steps a period: what damping does not take stays; bounded when the joint yields."""
    for cap, damping in ((1e9, 0.0), (1e9, 2.0), (20.0, 0.0)):
        space, body, joint = spring(800.0, cap, damping=damping, scheme=AVERAGE_ACCELERATION)
        dt = 2.0 * math.pi / 20.0 / 20.0
        space.step(dt)
        body.velocity = (1.0, 0.0)
        for _ in range(400):
            space.step(dt)
            found = joint.structure.energy
            assert abs(found.gap) <= 1e-12
            assert abs(found.numerical) <= 0.06
        assert found.external == pytest.approx(1.0, rel=1e-12)


def test_free_vibration_at_twenty_steps_a_period() -> None:
    """First mode of a cantilever by Lobatto's rule: period within 1 %, amplitude loss under 0.2 % a cycle."""
    assembly = sim.assemble(cantilever("rectangle 50x100 mm", 1.0, 0.01), sim.Model("lobatto", 5, "elastic-plastic"))
    assembly.structure.scheme = AVERAGE_ACCELERATION
    modulus, density, depth = 210e9, 7850.0, 0.1
    frequency = 1.8751040687**2 / (2.0 * math.pi) * math.sqrt(modulus * depth**2 / 12.0 / density)
    dt = 1.0 / frequency / 20.0
    tip, places = assembly.pieces[-1].body, []
    # Bent by a load that comes and goes slowly enough to leave the higher modes alone.
    for k in range(410):
        share = math.sin(math.pi * min(k, 200) / 400.0) ** 2
        if k < 200:
            tip.apply_force_at_world_point((0.0, 100.0 * share), tip.position)
        assembly.space.step(dt)
        places.append(assembly.nodes["tip"].now()[1])
    places = places[210:]
    y = np.array(places)
    up = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    crossings = up + y[up] / (y[up] - y[up + 1])
    period = np.diff(crossings).mean() / 20.0
    assert period == pytest.approx(1.0, abs=0.01)
    # Size of the first harmonic over two periods, early and late.
    wave = np.exp(2j * np.pi * np.arange(40) / (20.0 * period))
    early, late = abs((y[:40] * wave).sum()), abs((y[-40:] * wave).sum())
    cycles = (len(y) - 40) / (20.0 * period)
    assert (late / early) ** (1.0 / cycles) == pytest.approx(1.0, abs=0.002)


@pytest.mark.parametrize(("steps", "kept"), [(20, 0.025), (15, 0.01), (10, 0.03), (6, 0.08)])
def test_parts_of_steps_go_over_to_whole_ones_with_their_energy(steps: int, kept: float) -> None:
    """A mass on a spring is set going; with twenty steps a period or more, all steps are whole.

    The first of them loses (ωh)²/4 of the energy, for a velocity is set at its start and belongs to its middle. With
    fewer steps a period they are taken in parts, and whole ones from then on neither lose nor gain anything.
    """
    space, body, joint = spring(800.0, 1e9, scheme=AVERAGE_ACCELERATION)
    structure, dt = Structure([joint]), 2.0 * math.pi / 20.0 / steps
    parts, energy = [], []
    for k in range(400):
        if k == 1:
            body.velocity = (1.0, 0.0)
        space.step(dt)
        parts.append(int(structure.tables.control[at.PARTS]))
        energy.append(structure.energy.kinetic + structure.energy.elastic)
    assert (max(parts) > 1) == (steps < 20)
    assert set(parts[100:]) == {1}
    assert energy[100:] == pytest.approx([energy[100]] * 300, rel=1e-9)
    assert 1.0 - kept <= energy[100] <= 1.0 + 1e-9


@pytest.mark.parametrize("stiffness", [1.0, 1e3, 1e6])
def test_average_acceleration_keeps_every_entry_within_the_energy_there_is(stiffness: float) -> None:
    """Every piece of a free bar is thrown its own way, at 60 Hz; what does so is far faster than the steps resolve."""
    case = chain(12, law(stiffness), clamped=False, gravity=0.0)
    structure = Structure(case.structure.joints)
    structure.scheme = AVERAGE_ACCELERATION
    random = np.random.default_rng(3)
    for body in case.bodies:
        body.velocity, body.angular_velocity = tuple(random.uniform(-3.0, 3.0, 2)), random.uniform(-3.0, 3.0)
    given = kinetic(case.bodies)
    for _ in range(100):
        case.space.step(1 / 60)
        found = structure.energy
        assert found.external == pytest.approx(given, rel=1e-9)
        assert max(found.kinetic, found.elastic, found.plastic, abs(found.numerical)) <= 1.1 * given


def test_average_acceleration_keeps_its_energy_at_steps_drawn_at_random() -> None:
    """A soft cantilever, thrown at its tip, vibrates widely through 800 steps."""
    case = chain(6, law(1e-3, strength=1e3), gravity=0.0)
    case.structure.scheme = AVERAGE_ACCELERATION
    random, most = np.random.default_rng(5), 0.0
    case.bodies[-1].velocity = (0.0, 10.0)
    case.space.step(1e-4)
    begun = case.structure.energy.numerical
    for _ in range(800):
        case.space.step(1e-4 * math.exp(random.uniform(-1.0, 1.0)))
        most = max(most, abs(case.bodies[-1].angle))
    found = case.structure.energy
    assert most > 0.1
    assert abs(found.numerical - begun) <= 0.01 * found.external
