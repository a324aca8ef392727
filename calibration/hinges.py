"""Where plastic hinges form, and in which order: the reference's beside the model's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from fem_reference import HingeEvent, HingeTime
from fem_reference.hinge_events import Hinge, plastic_moment
from scene import Scene
from sim import Course, JointPlace, Push

_FIBRES = 64
#: Share of M_pl,N at which a joint counts as a hinge: its rotation is spread over the length that it stands for, and a
#: yield surface of facets lies up to a hundredth inside.
FULL = 0.985
#: Loads or times closer than this, as shares of the largest, are not in any order.
_TOGETHER = 0.005

_H = TypeVar("_H", bound=Hinge)


@dataclass(frozen=True)
class HingePair:
    """A hinge of the reference, and the joint of the model that stands for it.

    Attributes
    ----------
    where : str
        Its node, or its member and the distance from the member's start.
    reference : float
        The reference's load, or the time in a motion [s], when it forms.
    model : float or None
        The model's, when the joint nearest to it comes to 98.5 % of M_pl,N; None when it never does.
    step : int
        Step in which it does; -1 when it never does.
    """

    where: str
    reference: float
    model: float | None
    step: int


def push_hinges(scene: Scene, hinges: Sequence[HingeEvent], push: Push) -> tuple[HingePair, ...]:
    """The reference's hinges in its order, with their loads and those of ``push``."""
    return tuple(
        HingePair(_where(hinge), hinge.load, float(push.load[step]) if step >= 0 else None, step)
        for hinge, step in _with_steps(scene, hinges, push)
    )


def motion_hinges(scene: Scene, hinges: Sequence[HingeTime], course: Course) -> tuple[HingePair, ...]:
    """The reference's hinges in its order, with their times and those of ``course`` [s]."""
    return tuple(
        HingePair(_where(hinge), hinge.time, float(course.time[step]) if step >= 0 else None, step)
        for hinge, step in _with_steps(scene, hinges, course)
    )


def in_order(pairs: tuple[HingePair, ...]) -> bool:
    """Whether the model has all the reference's hinges, and in its order."""
    if any(pair.model is None for pair in pairs):
        return False
    scale = max((abs(pair.reference) for pair in pairs), default=0.0)
    return all(
        early.step <= late.step or abs(late.reference - early.reference) <= _TOGETHER * scale
        for i, early in enumerate(pairs)
        for late in pairs[i + 1 :]
    )


def _where(hinge: Hinge) -> str:
    return hinge.node or f"{hinge.member} at {hinge.position:.4g} m"


def _with_steps(scene: Scene, hinges: Sequence[_H], answer: Push | Course) -> list[tuple[_H, int]]:
    """Each hinge with the step in which the first joint that stands for it is one; -1 when none ever is."""
    pairs = []
    for hinge in hinges:
        steps = []
        for i, place in enumerate(answer.places):
            if _stands_for(scene, place, hinge.member, hinge.position, hinge.node):
                full = _reached(scene, place.member, answer.force[:, i])
                steps += full[:1].tolist()
        pairs.append((hinge, min(steps, default=-1)))
    return pairs


def _stands_for(scene: Scene, place: JointPlace, member: str, position: float, node: str) -> bool:
    """Whether a joint is at ``node``, or, for a hinge inside its member, the part that it stands for reaches there."""
    if node:
        ends = scene.members[place.member]
        length = scene.axis(place.member)[2]
        return (ends.start == node and place.position <= 1e-9 * length) or (
            ends.end == node and place.position >= (1.0 - 1e-9) * length
        )
    reach = max(place.length, float(scene.members[member].section.depth))
    return place.member == member and abs(place.position - position) <= reach


def _reached(scene: Scene, member: str, force: np.ndarray) -> np.ndarray:
    """Steps in which a joint bears 98.5 % of M_pl,N, from its forces (k, 3)."""
    own = scene.members[member]
    fibres = own.section.fibres(_FIBRES)
    full = plastic_moment(fibres.y, fibres.area, own.material.yield_stress, force[:, 0], force[:, 2])
    return np.flatnonzero(np.abs(force[:, 2]) >= FULL * np.maximum(full, 1e-12 * full.max()))
