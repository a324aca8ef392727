"""What keeps a model's error from falling."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.saving import Tried
from calibration.trials import Failure
from scene import Scene
from sim import Course, Model, Push

#: An error that falls by less than this share from one model to the next does not fall.
_LEVEL = 0.1


def what_limits(best: Tried, trials: Sequence[Tried], failures: Sequence[Failure]) -> str:
    """What the best model's error does not fall for, judged by the models beside it."""
    causes = []
    for what, key in (("joints", _but_joints), ("fibres", _but_fibres), ("steps", _but_steps)):
        others = [trial for trial in trials if trial is not best and key(trial.model) == key(best.model)]
        fewer = [trial for trial in others if trial.cost < best.cost]
        if not fewer or len(fewer) < len(others):
            continue
        last = max(fewer, key=lambda trial: trial.cost)
        before, now = last.error, best.error
        if now <= (1.0 - _LEVEL) * before:
            causes.append(
                f"finer {what} still help, {100.0 * before:.3g} to {100.0 * now:.3g} %, and finer ones are not tried"
            )
    if not causes:
        causes.append("neither joints, fibres nor shorter steps make it fall any more")
    if failures:
        causes.append(f"{len(failures)} finer or coarser models could not be stepped: {failures[-1].reason}")
    return "; ".join(causes)


def branch_remarks(branches_at: float | None) -> tuple[str, ...]:
    """That a second path branches off, where one does."""
    if branches_at is None:
        return ()
    return (
        f"compared up to {branches_at:.4g} m: from there on the structure leaves this path for another at the "
        "slightest disturbance, as a symmetric frame sways; add a small load that disturbs it and that is followed",
    )


def shear_remarks(scene: Scene, answer: Push | Course) -> tuple[str, ...]:
    """Members in which a model comes to more than Q_max beside a reference of beams, which do not yield in shear."""
    most: dict[str, float] = {}
    for i, place in enumerate(answer.places):
        most[place.member] = max(most.get(place.member, 0.0), float(np.abs(answer.force[:, i, 1]).max()))
    return tuple(
        f"members.{name}: shear comes to {100.0 * Q / scene.capacity(name).Q_max:.0f} % of Q_max; joints give way "
        "there; the beams of the reference do not, nor did the joints that were compared with them"
        for name, Q in most.items()
        if scene.capacity(name).Q_max < Q
    )


def _but_joints(model: Model) -> tuple[object, ...]:
    return model.rule, model.law, model.dt


def _but_fibres(model: Model) -> tuple[object, ...]:
    return model.rule, model.law, model.dt, model.joints


def _but_steps(model: Model) -> tuple[object, ...]:
    return model.rule, model.law, model.joints, model.fibres
