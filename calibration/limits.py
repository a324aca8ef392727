"""What keeps a model's error from falling."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.trials import Failure, Trial
from scene import Scene
from sim import Model

#: An error that falls by less than this share from one model to the next does not fall.
_LEVEL = 0.1


def what_limits(scene: Scene, best: Trial, trials: Sequence[Trial], failures: Sequence[Failure]) -> str:
    """What the best model's error does not fall for, judged by the models beside it."""
    causes = []
    for what, key in (("joints", _but_joints), ("fibres", _but_fibres), ("steps", _but_steps)):
        others = [trial for trial in trials if trial is not best and key(trial.model) == key(best.model)]
        fewer = [trial for trial in others if trial.cost < best.cost]
        if not fewer:
            continue
        last = max(fewer, key=lambda trial: trial.cost)
        before, now = last.errors.path_max, best.errors.path_max
        if now <= (1.0 - _LEVEL) * before:
            causes.append(
                f"finer {what} still help, {100.0 * before:.3g} to {100.0 * now:.3g} %, and finer ones are not tried"
            )
    if not causes:
        causes.append("neither joints, fibres nor shorter steps make it fall any more")
        if scene.kinematics == "p-delta":
            causes.append('rigid bodies turn by what they turn, P–Δ by little: compare with kinematics = "large"')
    if _sheared(scene, best):
        causes.append("a joint bears all of Q_max, but the reference's beams do not yield in shear")
    if failures:
        causes.append(f"{len(failures)} finer or coarser models could not be stepped: {failures[-1].reason}")
    return "; ".join(causes)


def _sheared(scene: Scene, best: Trial) -> bool:
    """Whether a joint comes to its shear capacity."""
    return any(
        np.abs(best.push.force[:, i, 1]).max() >= 0.99 * scene.capacity(place.member).Q_max
        for i, place in enumerate(best.push.places)
    )


def _but_joints(model: Model) -> tuple[object, ...]:
    return model.rule, model.law, model.dt


def _but_fibres(model: Model) -> tuple[object, ...]:
    return model.rule, model.law, model.dt, model.joints


def _but_steps(model: Model) -> tuple[object, ...]:
    return model.rule, model.law, model.joints, model.fibres
