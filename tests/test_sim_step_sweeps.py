"""One answer at any step, for blows and for loads; and steps that change while a structure yields."""

import itertools

import numpy as np
import pymunk
import pytest
from step_sweeps import BEAM, CASES, crate

from sim import Model, assemble

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


def pushed(steps: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Times of a slow push of a cantilever beyond its yield, and the tip's way, after each step."""
    space = pymunk.Space()
    space.iterations = 2
    beam = assemble(BEAM, Model("lobatto", 6, "fibre", fibres=8), space, shapes=False)
    tip, time, path = beam.nodes["tip"], 0.0, []
    for dt in steps:
        time += dt
        force = 9.1e3 * min(time / 2.0, 1.0)
        tip.body.apply_force_at_world_point((0.0, -force), tuple(tip.now()))
        space.step(dt)
        path.append((time, -tip.ahead(dt)[1]))
    assert beam.structure.unconverged == 0
    times, way = np.array(path).T
    return times, way


@pytest.mark.parametrize(("steps", "bound"), [("constant", 0.01), ("by turns", 0.01), ("at random", 0.05)])
def test_a_step_that_changes_while_a_beam_yields_goes_the_same_way(steps: str, bound: float) -> None:
    """1/30 s; five steps of that and five of 1/240 s by turns; anything between."""
    taken = {
        "constant": [1 / 30] * 75,
        "by turns": list(itertools.islice(itertools.cycle([1 / 30] * 5 + [1 / 240] * 5), 130)),
        "at random": np.random.default_rng(3).uniform(1 / 240, 1 / 30, 130).tolist(),
    }
    times, way = pushed([1 / 240] * 600)
    when, there = pushed(taken[steps])
    assert np.abs(there - np.interp(when, times, way)).max() <= bound * way.max()
