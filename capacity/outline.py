"""Plane outlines of straight edges and circular arcs, and integrals over what they enclose.

Green's theorem turns an area integral into one along the boundary,

    ∫ x^p y^q dA = ∮ x^(p+1)/(p+1) y^q dy,

so a straight closing line y = const adds nothing: the part of a section above y0 is integrated by leaving out the
pieces of boundary below y0. That one fact gives plastic moduli, fibres and interaction curves of any section, exactly
for straight edges (the integrand is a polynomial) and to rounding for arcs (twelve Gauss points on a quarter circle).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(12)
_GAUSS_T = 0.5 * (_GAUSS_X + 1.0)
_GAUSS_W = 0.5 * _GAUSS_W

#: Powers (p, q) of the moments that `Outline.moments` returns, in order: A, ∫x, ∫y, ∫x², ∫xy, ∫y².
POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


@dataclass(frozen=True)
class Outline:
    """Closed boundary as edges ``point + span t + radius (cos, sin)(start + sweep t)``, t in [0, 1].

    A straight edge has radius 0, an arc span 0. The inside lies to the left of each edge. Every edge is monotone in y
    (`line` and `arc` see to that), so a horizontal line cuts an edge at most once.

    Attributes
    ----------
    point, span : (n, 2) float
        Start point and extent of a straight edge, or centre and zeros [m].
    radius, start, sweep : (n,) float
        Radius [m], start angle and swept angle [rad] of an arc; zeros for a straight edge.
    """

    point: np.ndarray
    span: np.ndarray
    radius: np.ndarray
    start: np.ndarray
    sweep: np.ndarray

    @staticmethod
    def from_edges(edges: Iterable[tuple[float, ...]]) -> Outline:
        """Outline from rows (px, py, sx, sy, radius, start, sweep), as `line` and `arc` make them."""
        table = np.array(list(edges), dtype=float).reshape(-1, 7)
        return Outline(table[:, 0:2], table[:, 2:4], table[:, 4], table[:, 5], table[:, 6])

    @staticmethod
    def polygon(vertices: Iterable[tuple[float, float]]) -> Outline:
        """Outline of a simple polygon given counter-clockwise (clockwise: a hole)."""
        v = np.asarray(list(vertices), dtype=float)
        zeros = np.zeros(len(v))
        return Outline(v, np.roll(v, -1, axis=0) - v, zeros, zeros, zeros)

    def __add__(self, other: Outline) -> Outline:
        """Both boundaries together; they must not cross."""
        return Outline(*(np.concatenate(pair) for pair in zip(self._arrays(), other._arrays(), strict=True)))

    def _arrays(self) -> tuple[np.ndarray, ...]:
        return self.point, self.span, self.radius, self.start, self.sweep

    def shifted(self, dx: float, dy: float) -> Outline:
        """The same outline moved by (dx, dy) [m]."""
        return Outline(self.point + np.array([dx, dy]), self.span, self.radius, self.start, self.sweep)

    def _coordinates(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """x, y and dy/dt at parameters ``t`` of shape (n, k)."""
        angle = self.start[:, None] + self.sweep[:, None] * t
        r = self.radius[:, None]
        x = self.point[:, :1] + self.span[:, :1] * t + r * np.cos(angle)
        y = self.point[:, 1:] + self.span[:, 1:] * t + r * np.sin(angle)
        return x, y, self.span[:, 1:] + r * np.cos(angle) * self.sweep[:, None]

    def corners(self) -> np.ndarray:
        """Start points of all edges, (n, 2) [m]; they include the extremes in y."""
        x, y, _ = self._coordinates(np.zeros((len(self.radius), 1)))
        return np.column_stack([x, y])

    def extent(self) -> tuple[float, float]:
        """Lowest and highest y [m]."""
        y = self.corners()[:, 1]
        return float(y.min()), float(y.max())

    def _above(self, y0: float) -> tuple[np.ndarray, np.ndarray]:
        """Parameter range of each edge that lies above ``y0``; empty ranges have equal ends."""
        n = len(self.radius)
        ends = self._coordinates(np.tile([0.0, 1.0], (n, 1)))[1]
        low, high = np.zeros(n), np.ones(n)
        below = (ends <= y0).all(axis=1)
        high[below] = 0.0
        for i in np.flatnonzero((ends.min(axis=1) < y0) & (ends.max(axis=1) > y0)).tolist():
            t = self._cut(i, y0)
            if ends[i, 0] < y0:
                low[i] = t
            else:
                high[i] = t
        return low, high

    def _cut(self, i: int, y0: float) -> float:
        """Parameter at which edge ``i`` crosses y = y0."""
        if self.radius[i] == 0.0:
            return float((y0 - self.point[i, 1]) / self.span[i, 1])
        middle = self.start[i] + 0.5 * self.sweep[i]
        angle = math.asin(min(1.0, max(-1.0, (y0 - self.point[i, 1]) / self.radius[i])))
        if math.cos(middle) < 0.0:
            angle = math.pi - angle
        angle += 2.0 * math.pi * round((middle - angle) / (2.0 * math.pi))
        return min(1.0, max(0.0, float((angle - self.start[i]) / self.sweep[i])))

    def moments(self, above: float = -math.inf) -> np.ndarray:
        """Area moments of the part with y > ``above``, in the order of `POWERS`, shape (6,) [m², m³, m⁴]."""
        if math.isinf(above):
            low, high = np.zeros(len(self.radius)), np.ones(len(self.radius))
        else:
            low, high = self._above(above)
        width = (high - low)[:, None]
        x, y, dy = self._coordinates(low[:, None] + width * _GAUSS_T)
        weight = _GAUSS_W * width * dy
        return np.array([np.sum(weight * x ** (p + 1) * y**q) / (p + 1) for p, q in POWERS])

    def width(self, y0: float) -> float:
        """Total length of the horizontal chords at height ``y0`` [m]."""
        ends = self._coordinates(np.tile([0.0, 1.0], (len(self.radius), 1)))[1]
        total = 0.0
        for i in np.flatnonzero((ends.min(axis=1) <= y0) & (ends.max(axis=1) > y0)).tolist():
            t = self._cut(i, y0)
            x = self.point[i, 0] + self.span[i, 0] * t + self.radius[i] * math.cos(self.start[i] + self.sweep[i] * t)
            total += x if ends[i, 1] > ends[i, 0] else -x
        return total


def line(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, ...]]:
    """One straight edge [m]."""
    return [(x0, y0, x1 - x0, y1 - y0, 0.0, 0.0, 0.0)]


def arc(cx: float, cy: float, radius: float, start: float, sweep: float) -> list[tuple[float, ...]]:
    """A circular arc, split at the quadrants so that each edge is monotone in y [m, rad]."""
    end = start + sweep
    first, last = sorted((start, end))
    quarter = 0.5 * math.pi
    inner = np.arange(math.floor(first / quarter + 1e-9) + 1, math.ceil(last / quarter - 1e-9)) * quarter
    stops = np.concatenate([[first], inner, [last]])
    if sweep < 0.0:
        stops = stops[::-1]
    return [(cx, cy, 0.0, 0.0, radius, float(a), float(b - a)) for a, b in itertools.pairwise(stops)]


def path(vertices: Iterable[tuple[float, float, float]]) -> Outline:
    """Closed path through corners (x, y, fillet radius), counter-clockwise; each corner is rounded by its radius.

    Raises
    ------
    ValueError
        When a fillet is longer than the edges that meet there.
    """
    corners = np.array(list(vertices), dtype=float)
    n = len(corners)
    # Distance along both edges that a fillet takes away from a corner: r tan(turn / 2).
    directions = np.roll(corners, -1, axis=0)[:, :2] - corners[:, :2]
    lengths = np.hypot(directions[:, 0], directions[:, 1])
    if np.any(lengths <= 0.0):
        raise ValueError("two corners coincide")
    directions /= lengths[:, None]
    incoming = np.roll(directions, 1, axis=0)
    cross = incoming[:, 0] * directions[:, 1] - incoming[:, 1] * directions[:, 0]
    turn = np.arctan2(cross, np.sum(incoming * directions, axis=1))
    taken = corners[:, 2] * np.tan(0.5 * np.abs(turn))
    if np.any(taken + np.roll(taken, -1) > lengths * (1.0 + 1e-12)):
        raise ValueError("a fillet is too large for the edges that meet there")
    edges: list[tuple[float, ...]] = []
    for i in range(n):
        x, y, r = corners[i]
        before = (x - taken[i] * incoming[i, 0], y - taken[i] * incoming[i, 1])
        after = (x + taken[i] * directions[i, 0], y + taken[i] * directions[i, 1])
        if r > 0.0:
            side = math.copysign(1.0, turn[i])
            cx, cy = before[0] - side * r * incoming[i, 1], before[1] + side * r * incoming[i, 0]
            start = math.atan2(before[1] - cy, before[0] - cx)
            edges += arc(cx, cy, r, start, turn[i])
        j = (i + 1) % n
        stop = corners[j, :2] - taken[j] * directions[i]
        if math.hypot(stop[0] - after[0], stop[1] - after[1]) > 1e-15:
            edges += line(after[0], after[1], stop[0], stop[1])
    return Outline.from_edges(edges)
