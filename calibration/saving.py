"""Once a model meets the target, members that bear least are given less."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

from calibration.member_plans import MemberPlan
from calibration.planner import cheaper, groups
from scene import Scene
from sim import Model

#: Trials that are spent on it.
_MOST_TRIALS = 16


class Tried(Protocol):
    """A model that was tried, with its error [-] and its `calibration.planner.relative_cost`."""

    @property
    def model(self) -> Model: ...
    @property
    def error(self) -> float: ...
    @property
    def cost(self) -> float: ...


def give_less(
    scene: Scene,
    trial: Tried,
    plans: Mapping[str, MemberPlan],
    target_error: float,
    try_out: Callable[[Model], Tried | None],
    watch: Callable[[str, float], None],
) -> None:
    """Try members of ``trial`` with less, those that bear least first, while the target is met; those alike get alike.

    A scene in which all members are alike has been tried with less already.
    """
    alike = groups(scene, plans)
    left = _MOST_TRIALS if len(alike) > 1 else 0
    for names in alike:
        for own in cheaper(trial.model.of(names[0]), plans[names[0]]):
            if left == 0:
                return
            left -= 1
            watch(f"{names[0]} with {own.joints} joints", 1.0 - left / _MOST_TRIALS)
            less = try_out(replace(trial.model, members={**trial.model.members, **dict.fromkeys(names, own)}))
            if less is not None and less.error <= target_error and less.cost < trial.cost:
                trial = less
                break
