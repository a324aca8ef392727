"""Edges, arcs and filleted paths: how outlines are drawn."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable

import numpy as np

from capacity.outline import Outline


def line(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, ...]]:
    """One straight edge [m]."""
    return [(x0, y0, x1 - x0, y1 - y0, 0.0, 0.0, 0.0)]


def arc(cx: float, cy: float, radius: float, start: float, sweep: float) -> list[tuple[float, ...]]:
    """A circular arc, split at the quadrants so that each edge is monotone in y [m, rad]."""
    end = start + sweep
    first, last = sorted((start, end))
    quarter = 0.5 * math.pi
    inner = np.arange(math.floor(first / quarter + 1e-9) + 1, math.ceil(last / quarter - 1e-9)) * quarter
    stops = [first, *inner.tolist(), last]
    if sweep < 0.0:
        stops = stops[::-1]
    return [(cx, cy, 0.0, 0.0, radius, a, b - a) for a, b in itertools.pairwise(stops)]


def circle_outline(cx: float, cy: float, radius: float) -> Outline:
    """A full circle [m]."""
    return Outline.from_edges(arc(cx, cy, radius, 0.0, 2.0 * math.pi))


def path(vertices: Iterable[tuple[float, float, float]]) -> Outline:
    """Closed path through corners (x, y, fillet radius), counter-clockwise; each corner is rounded by its radius.

    Raises
    ------
    ValueError
        When a fillet is longer than the edges that meet there, or two corners coincide; the corner is named.
    """
    corners = list(vertices)
    n = len(corners)
    directions, lengths = [], []
    for (x0, y0, _), (x1, y1, _) in zip(corners, corners[1:] + corners[:1], strict=True):
        length = math.hypot(x1 - x0, y1 - y0)
        if length == 0.0:
            raise ValueError(f"two corners coincide at {_place(x0, y0)}")
        directions.append(((x1 - x0) / length, (y1 - y0) / length))
        lengths.append(length)
    # Distance along both edges that a fillet takes away from a corner: r tan(turn / 2).
    turns, taken = [], []
    for i, (_, _, r) in enumerate(corners):
        (ax, ay), (bx, by) = directions[i - 1], directions[i]
        turns.append(math.atan2(ax * by - ay * bx, ax * bx + ay * by))
        taken.append(r * math.tan(0.5 * abs(turns[i])) if r > 0.0 else 0.0)
    edges: list[tuple[float, ...]] = []
    for i, (x, y, r) in enumerate(corners):
        j = (i + 1) % n
        if taken[i] + taken[j] > lengths[i] * (1.0 + 1e-12):
            k = i if taken[i] >= taken[j] else j
            where = _place(corners[k][0], corners[k][1])
            raise ValueError(
                f"the {corners[k][2] * 1e3:g} mm fillet is too large for the edges that meet at corner {where}"
            )
        (ax, ay), (bx, by) = directions[i - 1], directions[i]
        if r > 0.0 and taken[i] > 0.0:
            side = math.copysign(1.0, turns[i])
            cx, cy = x - taken[i] * ax - side * r * ay, y - taken[i] * ay + side * r * ax
            edges += arc(cx, cy, r, math.atan2(-side * ax, side * ay), turns[i])
        if lengths[i] - taken[i] - taken[j] > 1e-12 * lengths[i]:
            x1, y1, _ = corners[j]
            edges += line(x + taken[i] * bx, y + taken[i] * by, x1 - taken[j] * bx, y1 - taken[j] * by)
    return Outline.from_edges(edges)


def _place(x: float, y: float) -> str:
    return f"({x * 1e3:g}, {y * 1e3:g}) mm"
