"""In which order to eliminate the bodies of a structure, and where its factor fills in.

Minimum degree: the body with the fewest neighbours goes first, and its neighbours become neighbours of each other. A
chain fills in nothing; a frame is condensed to its nodes first.
"""

import heapq
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Pattern:
    """Sparsity of the factor, with bodies renumbered in order of elimination.

    Attributes
    ----------
    order : (n,) int
        Which body is eliminated at each place.
    column_start, column_rows : int
        Below-diagonal rows of each column, ascending (compressed columns).
    fill_targets : int
        For each column, for each pair of its rows (p < q): the entry (q, p) that the elimination updates.
    """

    order: np.ndarray
    column_start: np.ndarray
    column_rows: np.ndarray
    fill_targets: np.ndarray

    def slot(self, row: int, column: int) -> int:
        """Index of entry (row, column), row > column, in ``column_rows``."""
        first, last = self.column_start[column], self.column_start[column + 1]
        return int(first + np.searchsorted(self.column_rows[first:last], row))


def minimum_degree(count: int, edges: Iterable[tuple[int, int]]) -> Pattern:
    """Order and pattern for ``count`` bodies joined by ``edges`` (pairs of bodies, in any order, repeats allowed)."""
    neighbours: list[set[int]] = [set() for _ in range(count)]
    for a, b in edges:
        neighbours[a].add(b)
        neighbours[b].add(a)
    queue = [(len(near), body) for body, near in enumerate(neighbours)]
    heapq.heapify(queue)
    place = np.full(count, -1)
    order: list[int] = []
    later: list[set[int]] = []
    while queue:
        degree, body = heapq.heappop(queue)
        if place[body] >= 0 or degree != len(neighbours[body]):
            continue
        place[body] = len(order)
        order.append(body)
        near = neighbours[body]
        later.append(near)
        for other in near:
            neighbours[other] |= near
            neighbours[other] -= {other, body}
            heapq.heappush(queue, (len(neighbours[other]), other))
    columns = [np.sort(place[list(near)]) if near else np.empty(0, int) for near in later]
    start = np.concatenate([[0], np.cumsum([len(rows) for rows in columns])]).astype(np.int64)
    rows = np.concatenate([*columns, np.empty(0, int)]).astype(np.int64)
    pattern = Pattern(np.array(order, dtype=np.int64), start, rows, np.empty(0, np.int64))
    targets = [
        pattern.slot(below[q], below[p])
        for below in columns
        for p in range(len(below))
        for q in range(p + 1, len(below))
    ]
    return Pattern(pattern.order, start, rows, np.array(targets, dtype=np.int64))
