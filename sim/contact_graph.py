"""Which bodies touch: Chipmunk's arbiters, in the order in which each body knows them.

pymunk saves the arbiters themselves, but not those of bodies that sleep, and not whose shapes still touched in the last
step: only those start the next one with the impulses they bear.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pymunk

from sim.chipmunk import (
    ARBITER_BODY_A,
    ARBITER_NEXT_A,
    ARBITER_NEXT_B,
    ARBITER_SHAPE_A,
    ARBITER_SHAPE_B,
    ARBITER_WORDS,
    ARBITERS,
    ARBITERS_OF_SPACE,
    BODY_FULL_WORDS,
    add_arbiter,
    address,
    arbiters_known,
    body_address,
    listed,
    save_arbiter,
    words,
)

#: The places of two shapes in a list.
_Pair = tuple[int, int]


@dataclass(frozen=True)
class ContactGraph:
    """Arbiters, known by their two shapes.

    Attributes
    ----------
    touching : list of pairs
        Those of bodies that are awake, in the order in which Chipmunk solved them.
    of_bodies : list of lists of pairs
        Those of each body.
    asleep : list of dict
        What pymunk would save of those that it does not see.
    """

    touching: list[_Pair]
    of_bodies: list[list[_Pair]]
    asleep: list[dict[str, Any]]

    @classmethod
    def of(cls, space: pymunk.Space, bodies: Sequence[pymunk.Body], shapes: Sequence[pymunk.Shape]) -> ContactGraph:
        """That of ``space`` between two steps."""
        place = {address(shape._shape): i for i, shape in enumerate(shapes)}

        seen = set(arbiters_known(space))
        known = [arbiters_of(body) for body in bodies]
        unseen = dict.fromkeys(arbiter for one in known for arbiter in one if arbiter not in seen)
        return cls(
            [_pair(arbiter, place) for arbiter in listed(space, ARBITERS_OF_SPACE).tolist()],
            [[_pair(arbiter, place) for arbiter in one] for one in known],
            [save_arbiter(arbiter, space) for arbiter in unseen],
        )

    def restore(self, space: pymunk.Space, bodies: Sequence[pymunk.Body], shapes: Sequence[pymunk.Shape]) -> list[int]:
        """Put it back, nobody sleeping yet; returns the addresses of the arbiters that are ``touching``."""
        for saved in self.asleep:
            add_arbiter(saved, space)
        place = {address(shape._shape): i for i, shape in enumerate(shapes)}
        at = {_pair(arbiter, place): arbiter for arbiter in arbiters_known(space)}
        for body, pairs in zip(bodies, self.of_bodies, strict=True):
            chain = [at[pair] for pair in pairs]
            where = body_address(body)
            words(where, BODY_FULL_WORDS, np.int64)[ARBITERS] = chain[0] if chain else 0
            for before, arbiter, after in zip([0, *chain], chain, [*chain[1:], 0], strict=False):
                w = words(arbiter, ARBITER_WORDS, np.int64)
                thread = ARBITER_NEXT_A if w[ARBITER_BODY_A] == where else ARBITER_NEXT_B
                w[thread : thread + 2] = after, before
        return [at[pair] for pair in self.touching]


def _pair(arbiter: int, place: Mapping[int, int]) -> _Pair:
    w = words(arbiter, ARBITER_WORDS, np.int64)
    return place[int(w[ARBITER_SHAPE_A])], place[int(w[ARBITER_SHAPE_B])]


def arbiters_of(body: pymunk.Body) -> list[int]:
    """Addresses of a body's arbiters, in their order."""
    where = body_address(body)
    found, arbiter = [], int(words(where, BODY_FULL_WORDS, np.int64)[ARBITERS])
    while arbiter:
        found.append(arbiter)
        w = words(arbiter, ARBITER_WORDS, np.int64)
        arbiter = int(w[ARBITER_NEXT_A if w[ARBITER_BODY_A] == where else ARBITER_NEXT_B])
    return found
