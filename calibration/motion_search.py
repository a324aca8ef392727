"""Which step a motion takes: bisected for each cut of the members, from coarse cuts to fine ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from calibration.planner import relative_cost
from calibration.saving import Tried
from sim import Model


def cheapest_step(
    cuts: Sequence[Model],
    rates: Sequence[int],
    members: Iterable[str],
    target_error: float,
    try_out: Callable[[Model], Tried | None],
    watch: Callable[[str, float], None],
) -> Tried | None:
    """The cheapest model found that meets the target; None when none does.

    Errors fall with the step, so half of the rates [1/s] that are left can be dropped after each trial. A step is not
    tried that would cost more than the best model so far; nor are shorter ones in a cut whose error, falling at most in
    proportion to the step, would still miss the target with the shortest; nor is any longer than one whose own error,
    which finer cuts share, misses the target.
    """
    members, best, longest = tuple(members), None, 0
    for i, cut in enumerate(cuts):
        low, high, before = longest, len(rates) - 1, None
        while low <= high:
            middle = (low + high) // 2
            model = replace(cut, dt=1.0 / rates[middle])
            if best is not None and relative_cost(model, members) >= best.cost:
                high = middle - 1
                continue
            watch(f"cut {i + 1} of {len(cuts)}: {cut.joints} joints, {cut.law}, 1/{rates[middle]} s", i / len(cuts))
            trial = try_out(model)
            if trial is not None and before is not None and _of_step(before, trial) > target_error:
                longest = max(longest, rates.index(round(1.0 / before.model.dt)) + 1)
            if trial is not None and trial.error <= target_error:
                best = trial if best is None or trial.cost < best.cost else best
                high = middle - 1
                continue
            if trial is not None and before is not None and _at_best(before, trial, rates[-1]) > target_error:
                break
            low, before = middle + 1, trial
    return best


def _of_step(long: Tried, short: Tried) -> float:
    """What the long step's error owes to the step, at least: what falls with its square from one trial to the other."""
    return (long.error - short.error) / (1.0 - (short.model.dt / long.model.dt) ** 2)


def _at_best(long: Tried, short: Tried, rate: int) -> float:
    """The error with ``rate`` steps a second, on the straight line over the step through two trials."""
    slope = (long.error - short.error) / (long.model.dt - short.model.dt)
    return short.error - slope * (short.model.dt - 1.0 / rate)
