"""One answer at any step, for blows and for loads; and steps that change while a structure yields."""

import itertools

import numpy as np
import pymunk
import pytest
from step_sweeps import CASES, crate
from sudden_cases import BEAM, SIX

from sim import AVERAGE_ACCELERATION, Model, Structure, assemble
from sim.kernels import layout as at

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


def pushed(steps: list[float], model: Model = SIX, most: float = 9.1e3) -> tuple[np.ndarray, np.ndarray, Structure]:
    """Times of a slow push of a cantilever by forces up to ``most``, the tip's way after each step, and its joints.

    Also notes in how many parts each step was taken, as the third column.
    """
    space = pymunk.Space()
    space.iterations = 2
    beam = assemble(BEAM, model, space, shapes=False)
    tip, time, path = beam.nodes["tip"], 0.0, []
    for dt in steps:
        time += dt
        force = most * min(time / 2.0, 1.0)
        tip.body.apply_force_at_world_point((0.0, -force), tuple(tip.now()))
        space.step(dt)
        path.append((time, -tip.ahead(dt)[1], beam.structure.tables.control[at.PARTS]))
    assert beam.structure.unconverged == 0
    times, *rest = np.array(path).T
    return times, np.array(rest), beam.structure


@pytest.mark.parametrize(("steps", "bound"), [("constant", 0.01), ("by turns", 0.01), ("at random", 0.01)])
def test_a_step_that_changes_while_a_beam_yields_goes_the_same_way(steps: str, bound: float) -> None:
    """1/30 s; five steps of that and five of 1/240 s by turns; anything between."""
    taken = {
        "constant": [1 / 30] * 75,
        "by turns": list(itertools.islice(itertools.cycle([1 / 30] * 5 + [1 / 240] * 5), 130)),
        "at random": np.random.default_rng(3).uniform(1 / 240, 1 / 30, 130).tolist(),
    }
    times, (way, _), _ = pushed([1 / 240] * 600)
    when, (there, _), _ = pushed(taken[steps])
    assert np.abs(there - np.interp(when, times, way)).max() <= bound * way.max()


def test_steps_that_change_at_random_keep_the_energy_of_the_second_order_scheme() -> None:
    """To a thousandth at first; in the long run to the tenth beyond which implicit Euler takes over."""
    steps = np.random.default_rng(3).uniform(1 / 240, 1 / 30, 400).tolist()
    model = Model("lobatto", 6, "fibre", fibres=8, scheme=AVERAGE_ACCELERATION)
    for count, share in ((100, 1e-3), (400, 0.12)):
        _, _, structure = pushed(steps[:count], model, most=3e3)
        assert structure.energy.external > 1.0
        assert abs(structure.energy.numerical) <= share * structure.energy.external


def test_only_the_first_steps_of_a_load_that_grows_are_taken_in_parts() -> None:
    _, (_, parts), _ = pushed([1 / 60] * 180)
    assert parts[0] > 1
    assert (parts[40:] == 1).all()
