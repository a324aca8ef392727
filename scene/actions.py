"""What happens to a structure: loads on it, a push, a motion. These structs are part of the schema of a scene file."""

from __future__ import annotations

import itertools
import math
from typing import Literal

import msgspec

from scene.quantities import Duration, Force, ForcePerLength, Length, Moment, Speed, si

LoadKind = Literal["dead", "proportional", "step", "history"]


class Load(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A load on a node, or spread evenly over a member; in global axes.

    Attributes
    ----------
    node : str, optional
        Where ``force`` and ``moment`` act.
    force : (Force, Force)
        Force on the node [N].
    moment : Moment
        Moment on the node, counter-clockwise [N m].
    member : str, optional
        Where ``per_length`` acts, instead of a node.
    per_length : (ForcePerLength, ForcePerLength)
        Force per length of the member [N/m].
    kind : str
        ``"proportional"``: multiplied by the load factor of the push; ``"dead"``: applied first, and kept;
        ``"step"``: applied suddenly when a motion begins, and kept; ``"history"``: multiplied by ``history``.
    history : tuple of (Duration, float)
        Times [s] and factors between which the factor runs straight; the first and the last are kept before and
        after.
    """

    node: str | None = None
    force: tuple[Force, Force] = (si(0.0), si(0.0))
    moment: Moment = si(0.0)
    member: str | None = None
    per_length: tuple[ForcePerLength, ForcePerLength] = (si(0.0), si(0.0))
    kind: LoadKind = "proportional"
    history: tuple[tuple[Duration, float], ...] = ()


class Push(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A displacement-controlled push of one node.

    What pushes is a force on the node along ``direction``, or, when the scene has proportional loads, these, multiplied
    by a load factor.

    Attributes
    ----------
    node : str
    direction : (float, float)
        Direction in which the displacement is measured, and of the force, any length but zero.
    distance : Length
        How far the node is pushed [m]; 0 when ``turning_points`` say it.
    turning_points : tuple of Length
        Displacements at which a cyclic push turns, the last of which is its end [m].
    unload : bool
        Go back to zero load at the end.
    control : str
        What leads along the path: ``"displacement"`` of the node; ``"load"``, up to ``largest_load``; or
        ``"arc-length"``, which follows the path where both turn back, until the node has gone ``distance``.
    largest_load : float
        Load, or load factor, at which a push under load control ends; 0 otherwise.
    """

    node: str
    direction: tuple[float, float]
    distance: Length = si(0.0)
    turning_points: tuple[Length, ...] = ()
    unload: bool = False
    control: Literal["displacement", "load", "arc-length"] = "displacement"
    largest_load: float = 0.0

    def stops(self) -> tuple[float, ...]:
        """Displacements to which the node goes one after the other, from 0 [m]."""
        return tuple(map(float, self.turning_points)) or (float(self.distance),)

    def way(self) -> float:
        """Length of the way through all the stops [m]."""
        return sum(abs(b - a) for a, b in itertools.pairwise((0.0, *self.stops())))


class Motion(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Motion in time: what velocities, masses and sudden loads do.

    Attributes
    ----------
    duration : Duration
        How long it is followed [s].
    velocity : (Speed, Speed)
        Velocity of all members at the start, where no support holds them [m/s]: that of a fall, say.
    watch : str, optional
        The node whose displacement is reported; by default the one that moves furthest.
    direction : (float, float)
        Direction in which that displacement is measured, any length but zero.
    """

    duration: Duration
    velocity: tuple[Speed, Speed] = (si(0.0), si(0.0))
    watch: str | None = None
    direction: tuple[float, float] = (0.0, 1.0)


def unit_vector(direction: tuple[float, float]) -> tuple[float, float]:
    """``direction`` with length 1."""
    dx, dy = direction
    size = math.hypot(dx, dy)
    return dx / size, dy / size
