"""Chipmunk's own constraints, those that pymunk brings: what they work along, and where their numbers lie.

Beside `sim.chipmunk` the only file that knows offsets, in 8-byte words; `sim.installed` holds them against the pymunk
that there is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pymunk

from sim.chipmunk import CONSTRAINT_CLASS, CONTROL, address, words

#: What an impulse works along: a line between two points, both directions at a point, or the bodies' turning.
LINE, POINT, TURN = 0, 1, 2
#: Words of a row of `kinds`.
KIND_CLASS, KIND_IMPULSE, KIND_COUNT, KIND_WAY, KIND_MASS, KIND_ARMS, KIND_AXIS = range(7)
KIND_RATIO, KIND_TARGET, KIND_COEFFICIENT, KIND_DAMPING, KIND_HOLDS, KIND_WORDS = 7, 8, 9, 10, 11, 12


@dataclass(frozen=True)
class Kind:
    """One kind of constraint; words that it does not have are 0.

    Attributes
    ----------
    make : callable
        A constraint of this kind between two bodies.
    impulse : int
        Impulse of the last step, ``count`` words; the next one starts with it, unless there is a ``damping``.
    way : int
        `LINE`, `POINT` or `TURN`.
    mass : int
        Inverse of how easily the two bodies' ends move against each other along the way; 2 × 2 at a `POINT`.
    arms : int
        From the two bodies' centres to the points, x and y each.
    axis : int
        Direction of a `LINE`.
    ratio : int
        Of the two bodies' spins.
    target, coefficient, damping : int
        Of a spring's damper: velocity of the ends against each other that it has led to in this step, share of what is
        above that which it takes, and its constant.
    holds : bool
        Whether it keeps a point of one body at the other, however these move.
    """

    make: Callable[[pymunk.Body, pymunk.Body], pymunk.Constraint]
    impulse: int
    way: int
    mass: int
    count: int = 1
    arms: int = 0
    axis: int = 0
    ratio: int = 0
    target: int = 0
    coefficient: int = 0
    damping: int = 0
    holds: bool = False


#: Where the constraints of `Kind.make` hold the two bodies, from their centres.
ON_A, ON_B = (0.5, 0.0), (-0.25, 0.0)

KINDS: dict[type[pymunk.Constraint], Kind] = {
    pymunk.PinJoint: Kind(lambda a, b: pymunk.PinJoint(a, b, ON_A, ON_B), 25, LINE, 24, arms=18, axis=22, holds=True),
    pymunk.SlideJoint: Kind(lambda a, b: pymunk.SlideJoint(a, b, ON_A, ON_B, 0.0, 1.0), 26, LINE, 25, arms=19, axis=23),
    pymunk.PivotJoint: Kind(
        lambda a, b: pymunk.PivotJoint(a, b, ON_A, ON_B), 25, POINT, 21, count=2, arms=17, holds=True
    ),
    pymunk.GrooveJoint: Kind(
        lambda a, b: pymunk.GrooveJoint(a, b, (0.0, 0.0), ON_A, ON_B), 32, POINT, 28, count=2, arms=24, holds=True
    ),
    pymunk.RotaryLimitJoint: Kind(lambda a, b: pymunk.RotaryLimitJoint(a, b, 0.0, 1.0), 17, TURN, 15),
    pymunk.RatchetJoint: Kind(lambda a, b: pymunk.RatchetJoint(a, b, 0.0, 1.0), 18, TURN, 16),
    pymunk.GearJoint: Kind(lambda a, b: pymunk.GearJoint(a, b, 0.0, 1.0), 18, TURN, 16, ratio=14),
    pymunk.SimpleMotor: Kind(lambda a, b: pymunk.SimpleMotor(a, b, 1.0), 15, TURN, 14),
    pymunk.DampedSpring: Kind(
        lambda a, b: pymunk.DampedSpring(a, b, ON_A, ON_B, 0.0, 1.0, 1.0),
        30,
        LINE,
        27,
        arms=23,
        axis=28,
        target=21,
        coefficient=22,
        damping=19,
    ),
    pymunk.DampedRotarySpring: Kind(
        lambda a, b: pymunk.DampedRotarySpring(a, b, 1.0, 1.0, 1.0),
        20,
        TURN,
        19,
        target=17,
        coefficient=18,
        damping=15,
    ),
}


@cache
def kinds() -> np.ndarray:
    """All of them for the kernels, a row each: address of the function table, then what `Kind` says, (n, words)."""
    a, b = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    rows = np.zeros((len(KINDS), KIND_WORDS), dtype=np.int64)
    for row, kind in zip(rows, KINDS.values(), strict=True):
        constraint = address(kind.make(a, b)._constraint)
        row[KIND_CLASS] = words(constraint, 1, np.int64)[CONSTRAINT_CLASS]
        row[KIND_IMPULSE:KIND_WAY] = kind.impulse, kind.count
        row[KIND_WAY:KIND_TARGET] = kind.way, kind.mass, kind.arms, kind.axis, kind.ratio
        row[KIND_TARGET:] = kind.target, kind.coefficient, kind.damping, kind.holds
    return rows


def starts_from_last(constraint: pymunk.Constraint) -> bool:
    """Whether a constraint of Chipmunk's own starts a step with its impulse of the last one; springs do not."""
    return type(constraint) in KINDS and not KINDS[type(constraint)].damping


def cached_impulse(constraint: pymunk.Constraint) -> np.ndarray:
    """Impulse of one of Chipmunk's own constraints in the last step, to be changed in place."""
    kind = KINDS[type(constraint)]
    return words(address(constraint._constraint), kind.impulse + kind.count)[kind.impulse :]


def own_numbers(constraint: pymunk.Constraint) -> np.ndarray:
    """All numbers of one of Chipmunk's own constraints up to its impulse, to be changed in place.

    pymunk makes some anew from where bodies are: the distance of a pin joint, where a ratchet has got to.
    """
    kind = KINDS[type(constraint)]
    return words(address(constraint._constraint), kind.impulse + kind.count)[CONTROL:]
