"""What a recording holds: bodies, joints, contacts and energies of a run, as arrays over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

BodyKind = Literal["static", "kinematic", "dynamic"]
ShapeKind = Literal["polygon", "circle", "segment"]


@dataclass(frozen=True)
class Outline:
    """A shape, in the coordinates of its body.

    Attributes
    ----------
    kind : str
        ``"polygon"`` with at least three points, ``"circle"`` with one, ``"segment"`` with two.
    points : (n, 2) float
        [m].
    radius : float
        Of the circle, half the segment's thickness, or of a polygon's rounded corners [m].
    """

    kind: ShapeKind
    points: np.ndarray
    radius: float


@dataclass(frozen=True)
class RecordedBody:
    """A body: what it is and looks like.

    Attributes
    ----------
    kind : str
        ``"static"``, ``"kinematic"`` or ``"dynamic"``.
    outlines : tuple of Outline
        Its shapes when it was first seen.
    in_structure : bool
        Whether a ductile joint holds it.
    """

    kind: BodyKind
    outlines: tuple[Outline, ...]
    in_structure: bool


@dataclass(frozen=True)
class RecordedJoint:
    """A joint: what it connects, where, and what it can bear.

    Attributes
    ----------
    label : str
        For people.
    bodies : (int, int)
        Indices of a and b.
    anchors : (2, 2) float
        Its position on a and on b, in their coordinates [m].
    rest : (float, float)
        Angle of its x axis on a and on b [rad].
    turn : float
        Share of b's rotation that its axes follow.
    maxima : (float, float, float)
        N_max [N], Q_max [N], M_max [N m]; infinite without a limit.
    """

    label: str
    bodies: tuple[int, int]
    anchors: np.ndarray
    rest: tuple[float, float]
    turn: float
    maxima: tuple[float, float, float]


@dataclass(frozen=True)
class Contacts:
    """Pairs of shapes that touched, one moment after the other.

    Attributes
    ----------
    start : (times + 1,) int
        The rows ``start[k]:start[k + 1]`` of the other arrays belong to time k.
    point : (n, 2) float
        Middle of the pair's points of contact [m].
    force : (n, 2) float
        Force over the step, on that of the two bodies that comes first in the recording, static ones last [N].
    """

    start: np.ndarray
    point: np.ndarray
    force: np.ndarray


@dataclass(frozen=True)
class Recording:
    """A run, sampled.

    Attributes
    ----------
    title : str
    time : (t,) float
        [s].
    settings : dict[str, float]
        ``step`` [s], the last one's; ``gravity`` along y [m/s²]; ``iterations`` of the space's solver.
    bodies : tuple of RecordedBody
    pose : (t, bodies, 3) float
        x, y of each body's origin [m] and its angle [rad]; not a number while the body was not in the space.
    velocity : (t, bodies, 2) float
        Of its centre of gravity [m/s].
    joints : tuple of RecordedJoint
    force : (t, joints, 3) float
        N [N], Q [N] and M [N m]; 0 before the joint was there and once it is broken. Signs as in `scene`.
    capacity_used : (t, joints) float
        Share of the plastic capacity used.
    broken : (t, joints) bool
    peak : (joints, 3) float
        Largest N, Q and M in any step, without sign, between the sampled times, too.
    contacts : Contacts
    energy : dict[str, (t,) float]
        Ledger of all structures that there are or were and of loose bodies, by account [J]; see `sim.energy.Energy`.
    """

    title: str
    time: np.ndarray
    settings: dict[str, float]
    bodies: tuple[RecordedBody, ...]
    pose: np.ndarray
    velocity: np.ndarray
    joints: tuple[RecordedJoint, ...]
    force: np.ndarray
    capacity_used: np.ndarray
    broken: np.ndarray
    peak: np.ndarray
    contacts: Contacts
    energy: dict[str, np.ndarray]

    @property
    def utilisation(self) -> np.ndarray:
        """|N| / N_max, |Q| / Q_max and |M| / M_max, (t, joints, 3); 0 where there is no limit, or nothing to bear."""
        maxima = np.array([joint.maxima for joint in self.joints]).reshape(-1, 3)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.abs(self.force) / maxima
        return np.where(maxima > 0.0, share, 0.0)
