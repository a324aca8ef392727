"""Where plastic hinges form, and in which order: the reference's beside the model's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference import PushAnswer
from fem_reference.hinge_events import plastic_moment
from scene import Scene
from sim import JointPlace, Push

_FIBRES = 64
#: Share of M_pl,N at which a joint counts as a hinge: its rotation is spread over the length that it stands for, and a
#: yield surface of facets lies up to a hundredth inside.
FULL = 0.985
#: Loads closer than this, as shares of the largest, are not in any order.
_TOGETHER = 0.005


@dataclass(frozen=True)
class HingePair:
    """A hinge of the reference, and the joint of the model that stands for it.

    Attributes
    ----------
    where : str
        Its node, or its member and the distance from the member's start.
    load : float
        The reference's load when it forms.
    model_load : float or None
        The model's, when the joint nearest to it comes to 98.5 % of M_pl,N; None when it never does.
    step : int
        Step in which it does; -1 when it never does.
    """

    where: str
    load: float
    model_load: float | None
    step: int


def hinge_pairs(scene: Scene, reference: PushAnswer, push: Push) -> tuple[HingePair, ...]:
    """The reference's hinges, in its order."""
    pairs = []
    for hinge in reference.hinges:
        steps = []
        for i, place in enumerate(push.places):
            if _stands_for(scene, place, hinge.member, hinge.position, hinge.node):
                full = _reached(scene, place.member, push.force[:, i])
                steps += full[:1].tolist()
        step = min(steps, default=-1)
        where = hinge.node or f"{hinge.member} at {hinge.position:.4g} m"
        pairs.append(HingePair(where, hinge.load, float(push.load[step]) if steps else None, step))
    return tuple(pairs)


def in_order(pairs: tuple[HingePair, ...]) -> bool:
    """Whether the model has all the reference's hinges, and in its order."""
    if any(pair.model_load is None for pair in pairs):
        return False
    scale = max((abs(pair.load) for pair in pairs), default=0.0)
    return all(
        early.step <= late.step or abs(late.load - early.load) <= _TOGETHER * scale
        for i, early in enumerate(pairs)
        for late in pairs[i + 1 :]
    )


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
