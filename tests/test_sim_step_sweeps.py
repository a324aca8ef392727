"""One answer at any step, for blows and for loads; and steps that change while a structure yields."""

import itertools

import numpy as np
import pymunk
import pytest
from step_sweeps import BEAM, CASES, crate

from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER, Model, assemble

DYNAMIC = 0.05


@pytest.mark.parametrize("name", CASES)
def test_a_blow_has_the_same_effect_at_any_step(name: str) -> None:
    found = np.array([CASES[name](rate, 2) for rate in (60, 240, 1000)])
    assert (found.max(axis=0) / found.min(axis=0)).max() <= 1.0 + DYNAMIC


@pytest.mark.parametrize("name", CASES)
def test_a_blow_has_the_same_effect_for_any_iterations(name: str) -> None:
    found = np.array([CASES[name](60, iterations) for iterations in (2, 30)])
    assert (found.max(axis=0) / found.min(axis=0)).max() <= 1.01


def test_a_blow_at_60_hz_is_that_of_steps_so_short_that_none_is_taken_in_parts() -> None:
    assert crate(60, 2) == pytest.approx(crate(8000, 2, slop=1e-3), rel=DYNAMIC)


def pushed(steps: list[float], scheme: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Load factor of a slow push of a cantilever far beyond its yield, and the tip's way, after each step."""
    space = pymunk.Space()
    space.iterations = 2
    beam = assemble(BEAM, Model("lobatto", 6, "fibre", fibres=8, scheme=scheme), space, shapes=False)
    tip, time, path = beam.nodes["tip"], 0.0, []
    for dt in steps:
        time += dt
        force = 9.1e3 * min(time / 2.0, 1.0)
        tip.body.apply_force_at_world_point((0.0, -force), tip.now())
        space.step(dt)
        path.append((time, -tip.ahead(dt)[1]))
    assert beam.structure.unconverged == 0
    return tuple(np.array(path).T)


@pytest.mark.parametrize("scheme", [IMPLICIT_EULER, AVERAGE_ACCELERATION])
def test_a_step_that_changes_while_a_beam_yields_goes_the_same_way(scheme: tuple[float, float]) -> None:
    """From 1/240 to 1/30 s and back, every fifth step, and at random."""
    random = np.random.default_rng(3)
    regular = [dt for dt, _ in zip(itertools.cycle([1 / 30] * 5 + [1 / 240] * 5), range(130), strict=False)]
    times, way = pushed([1 / 240] * 600, scheme)
    for steps in (regular, list(random.uniform(1 / 240, 1 / 30, 130))):
        when, there = pushed(steps, scheme)
        late = when > 0.3
        assert np.abs(there - np.interp(when, times, way))[late].max() <= 0.01 * way.max()
