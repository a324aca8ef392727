"""How a motion's models are searched, its peak read between steps, and its figure's axes numbered."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

from calibration.figures import logarithmic
from calibration.motion_search import cheapest_step
from calibration.planner import MOTION_RATES, relative_cost
from scene.watched import extreme
from sim import Model

CUTS = [Model("lobatto", joints, "fibre", 8) for joints in (3, 4, 6, 8, 10, 14)]


@dataclass
class Pupil:
    """A model whose error falls with the joints and with the step, each to its own power."""

    model: Model
    by_joints: float
    by_step: float

    @property
    def error(self) -> float:
        return self.by_joints / self.model.joints**2 + self.by_step * self.model.dt

    @property
    def cost(self) -> float:
        return relative_cost(self.model)


@given(st.floats(0.01, 10.0), st.floats(0.01, 100.0))
def test_the_search_finds_the_cheapest_of_all_models_in_few_trials(by_joints: float, by_step: float) -> None:
    target, tried = 0.02, []

    def try_out(model: Model) -> Pupil:
        tried.append(Pupil(model, by_joints, by_step))
        return tried[-1]

    found = cheapest_step(CUTS, MOTION_RATES, ("",), target, try_out, lambda what, share: None)
    there = [
        Pupil(Model(cut.rule, cut.joints, cut.law, cut.fibres, 1.0 / rate), by_joints, by_step)
        for cut in CUTS
        for rate in MOTION_RATES
    ]
    best = min((p.cost for p in there if p.error <= target), default=None)
    assert (None if found is None else found.cost) == best
    assert len(tried) <= 0.5 * len(there)


def test_models_that_cannot_be_stepped_are_tried_with_shorter_steps() -> None:
    def try_out(model: Model) -> Pupil | None:
        return Pupil(model, 0.01, 0.01) if model.dt < 1e-3 else None

    found = cheapest_step(CUTS[:1], MOTION_RATES, ("",), 0.02, try_out, lambda what, share: None)
    assert found is not None
    assert found.model.dt == 1.0 / 2000


@given(st.floats(0.0, 1.0), st.sampled_from([-2.0, 3.0]))
def test_a_vibration_of_ten_steps_a_period_is_read_between_them(phase: float, amplitude: float) -> None:
    k = np.arange(8)
    value, at = extreme(amplitude * np.cos(2.0 * math.pi * (k - 3.0 - phase) / 10.0))
    assert value == pytest.approx(amplitude, rel=4e-3)
    assert at == pytest.approx(3.0 + phase, abs=0.03)


def test_a_largest_value_at_an_end_stays_what_it_is() -> None:
    assert extreme(np.array([0.0, 1.0, 3.0])) == (3.0, 2.0)
    assert extreme(np.array([1.0, 1.0, 1.0])) == (1.0, 0.0)


@settings(max_examples=25)
@given(st.floats(-4.0, 4.0), st.floats(0.05, 6.0))
def test_axes_have_a_few_numbers_over_any_range(start: float, decades: float) -> None:
    axes = Figure().subplots()
    axes.scatter([10.0**start, 10.0 ** (start + decades)], [1.0, 10.0])
    logarithmic(axes)
    low, high = axes.get_xlim()
    labels = [t for t in axes.xaxis.get_majorticklocs() if low <= t <= high]
    assert 3 <= len(labels) <= 9
    assert not len(axes.xaxis.get_minorticklocs())
