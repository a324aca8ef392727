"""Plane outlines of straight edges and circular arcs, and integrals over what they enclose.

Green's theorem turns an area integral into one along the boundary,

    ∫ x^p y^q dA = ∮ x^(p+1)/(p+1) y^q dy,

so a straight closing line y = const adds nothing: the part of a section above y0 is integrated by leaving out the
pieces of boundary below y0. That one fact gives plastic moduli, fibres and interaction curves of any section, exactly
for straight edges (the integrand is a polynomial) and to rounding for arcs (twelve Gauss points on a quarter circle).
Each edge may carry a weight, a modulus or a yield stress, and then the same integrals give stiffnesses and forces of
a section of several materials.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(12)
_GAUSS_T = 0.5 * (_GAUSS_X + 1.0)
_GAUSS_W = 0.5 * _GAUSS_W
_LINE_T, _LINE_W = 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3.0), np.array([0.5, 0.5])

#: Powers (p, q) of the moments that `Outline.moments` returns, in order: A, ∫x, ∫y, ∫x², ∫xy, ∫y².
POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


@dataclass(frozen=True)
class Outline:
    """Closed boundary as edges ``point + span t + radius (cos, sin)(start + sweep t)``, t in [0, 1].

    A straight edge has radius 0, an arc span 0. The inside lies to the left of each edge. Every edge is monotone in y
    (`capacity.paths` sees to that), so a horizontal line cuts an edge at most once.

    Attributes
    ----------
    point, span : (n, 2) float
        Start point and extent of a straight edge, or centre and zeros [m].
    radius, start, sweep : (n,) float
        Radius [m], start angle and swept angle [rad] of an arc; zeros for a straight edge.
    weight : (n,) float
        What the integrals of the area that an edge bounds are multiplied by; 1 for plain geometry.
    """

    point: np.ndarray
    span: np.ndarray
    radius: np.ndarray
    start: np.ndarray
    sweep: np.ndarray
    weight: np.ndarray

    @staticmethod
    def from_edges(edges: Iterable[tuple[float, ...]]) -> Outline:
        """Outline from rows (px, py, sx, sy, radius, start, sweep), as `paths.line` and `paths.arc` make them."""
        table = np.array(list(edges), dtype=float).reshape(-1, 7)
        return Outline(table[:, 0:2], table[:, 2:4], table[:, 4], table[:, 5], table[:, 6], np.ones(len(table)))

    @staticmethod
    def polygon(vertices: Iterable[tuple[float, float]]) -> Outline:
        """Outline of a simple polygon given counter-clockwise (clockwise: a hole)."""
        v = np.asarray(list(vertices), dtype=float)
        zeros = np.zeros(len(v))
        return Outline(v, np.roll(v, -1, axis=0) - v, zeros, zeros, zeros, np.ones(len(v)))

    def __add__(self, other: Outline) -> Outline:
        """Both boundaries together; they must not cross."""
        return Outline(*map(np.concatenate, zip(self._arrays(), other._arrays(), strict=True)))

    def _arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        return self.point, self.span, self.radius, self.start, self.sweep, self.weight

    def shifted(self, dx: float, dy: float) -> Outline:
        """The same outline moved by (dx, dy) [m]."""
        by = np.array([dx, dy])
        moved = Outline(self.point + by, *self._arrays()[1:])
        vars(moved)["ends"] = tuple(end + by for end in self.ends)  # rather than work them out again
        return moved

    def scaled_weight(self, factor: float) -> Outline:
        """The same outline with every weight multiplied by ``factor``."""
        return Outline(*self._arrays()[:-1], self.weight * factor)

    def rotated(self, angle: float) -> Outline:
        """The same outline turned counter-clockwise about the origin by ``angle`` [rad]."""
        # A quarter turn is exact, so that upright sections stay upright.
        quarter = angle / (0.5 * math.pi)
        exact = (1.0, 0.0, -1.0, 0.0)
        if abs(quarter - round(quarter)) < 1e-14:
            c, s = exact[round(quarter) % 4], exact[(round(quarter) - 1) % 4]
        else:
            c, s = math.cos(angle), math.sin(angle)
        turn = np.array([[c, s], [-s, c]])
        outline = Outline(
            self.point @ turn,
            self.span @ turn,
            self.radius,
            self.start + np.where(self.radius > 0.0, angle, 0.0),
            self.sweep,
            self.weight,
        )
        return outline._monotone()

    def mirrored(self) -> Outline:
        """The same outline mirrored in the y axis, x → -x."""
        flip = np.array([-1.0, 1.0])
        end = self.start + self.sweep
        is_arc = self.radius > 0.0
        # Traversed the other way round, which keeps the inside to the left.
        return Outline(
            (self.point + self.span) * flip,
            -self.span * flip,
            self.radius,
            np.where(is_arc, math.pi - end, 0.0),
            np.where(is_arc, self.sweep, 0.0),
            self.weight,
        )

    def reversed(self) -> Outline:
        """The same boundary the other way round: a hole for a solid, a solid for a hole."""
        return Outline(
            self.point + self.span, -self.span, self.radius, self.start + self.sweep, -self.sweep, self.weight
        )

    def _monotone(self) -> Outline:
        """Arcs split where they turn back in y."""
        end = self.start + self.sweep
        first, last = np.minimum(self.start, end), np.maximum(self.start, end)
        turn = (np.floor((first - 0.5 * math.pi) / math.pi + 1e-12) + 1.5) * math.pi  # first π/2 + k π inside the arc
        split = (self.radius > 0.0) & (turn < last - 1e-12)
        if not split.any():
            return self
        share = np.where(split, (turn - self.start) / np.where(split, self.sweep, 1.0), 1.0)
        head = Outline(*self._arrays()[:4], self.sweep * share, self.weight)
        rest = Outline(
            self.point[split],
            self.span[split],
            self.radius[split],
            (self.start + self.sweep * share)[split],
            (self.sweep * (1.0 - share))[split],
            self.weight[split],
        )
        return head + rest._monotone()

    def coordinates(self, edge: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """x, y and dy/dt of edges ``edge`` (m,) at parameters ``t`` (m, k)."""
        px, py = self.point[edge, :1], self.point[edge, 1:]
        sx, sy = self.span[edge, :1], self.span[edge, 1:]
        x, y, dy = px + sx * t, py + sy * t, sy + 0.0 * t
        arcs = np.flatnonzero(self.radius[edge])
        if len(arcs):
            e = edge[arcs]
            r, sweep = self.radius[e, None], self.sweep[e, None]
            angle = self.start[e, None] + sweep * (t if len(t) == 1 else t[arcs])
            across = r * np.cos(angle)
            x[arcs] += across
            y[arcs] += r * np.sin(angle)
            dy[arcs] = across * sweep
        return x, y, dy

    @cached_property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Start and end points of all edges, two of (n, 2) [m]."""
        if not self.radius.any():
            return self.point, self.point + self.span
        t = np.tile([0.0, 1.0], (len(self.radius), 1))
        x, y, _ = self.coordinates(np.arange(len(self.radius)), t)
        return np.column_stack([x[:, 0], y[:, 0]]), np.column_stack([x[:, 1], y[:, 1]])

    def corners(self) -> np.ndarray:
        """Start points of all edges, (n, 2) [m]; they include the extremes in y."""
        return self.ends[0]

    def extent(self) -> tuple[float, float]:
        """Lowest and highest y [m]."""
        y = self.ends[0][:, 1]
        return float(y.min()), float(y.max())

    def stops(self) -> np.ndarray:
        """Heights between which the chord length is smooth, ascending [m]."""
        y = np.sort(self.ends[0][:, 1])
        apart: np.ndarray = np.append(True, np.diff(y) > 1e-12 * (y[-1] - y[0]))
        distinct: np.ndarray = y[apart]
        return distinct

    def _integrals(self, edge: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Contributions of edges ``edge`` between parameters ``low`` and ``high`` to the moments, (m, 6)."""
        # Two points are exact for the cubics that straight edges give.
        nodes, weights = (_GAUSS_T, _GAUSS_W) if self.radius[edge].any() else (_LINE_T, _LINE_W)
        width = (high - low)[:, None]
        x, y, dy = self.coordinates(edge, low[:, None] + width * nodes)
        w = weights * width * dy * self.weight[edge, None] * x
        wx = w * x
        terms = np.stack((w, wx / 2.0, w * y, wx * x / 3.0, wx * y / 2.0, w * y * y))
        contributions: np.ndarray = np.sum(terms, axis=2).T
        return contributions

    @cached_property
    def _edge_moments(self) -> np.ndarray:
        n = len(self.radius)
        return self._integrals(np.arange(n), np.zeros(n), np.ones(n))

    def _cut(self, edge: np.ndarray, heights: np.ndarray) -> np.ndarray:
        """Parameters at which edges ``edge`` cross ``heights``, pair by pair."""
        t = np.empty(len(edge))
        arcs = self.radius[edge] > 0.0
        e, y = edge[~arcs], heights[~arcs]
        t[~arcs] = (y - self.point[e, 1]) / self.span[e, 1]
        e, y = edge[arcs], heights[arcs]
        middle = self.start[e] + 0.5 * self.sweep[e]
        angle = np.arcsin(np.clip((y - self.point[e, 1]) / self.radius[e], -1.0, 1.0))
        angle = np.where(np.cos(middle) < 0.0, math.pi - angle, angle)
        angle += 2.0 * math.pi * np.round((middle - angle) / (2.0 * math.pi))
        t[arcs] = (angle - self.start[e]) / self.sweep[e]
        return np.clip(t, 0.0, 1.0)

    def crossings(self, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Pairs of height and edge that cross: their numbers, the parameter, and whether the edge rises."""
        first, last = self.ends[0][:, 1], self.ends[1][:, 1]
        low, high = np.minimum(first, last), np.maximum(first, last)
        at, edge = np.nonzero((low <= heights[:, None]) & (high > heights[:, None]))
        return at, edge, self._cut(edge, heights[at]), last[edge] > first[edge]

    def moments(self, above: float | np.ndarray = -math.inf) -> np.ndarray:
        """Area moments of the part with y > ``above``, in the order of `POWERS` [m², m³, m⁴].

        Parameters
        ----------
        above : float or (k,) float
            One height or several [m]; the result has shape (6,) or (k, 6).
        """
        if np.ndim(above) == 0 and above == -math.inf:
            whole: np.ndarray = self._edge_moments.sum(axis=0)
            return whole
        heights = np.atleast_1d(np.asarray(above, dtype=float))
        first, last = self.ends[0][:, 1], self.ends[1][:, 1]
        wholly = np.minimum(first, last)[None, :] > heights[:, None]
        total: np.ndarray = wholly.astype(float) @ self._edge_moments
        at, edge, t, rises = self.crossings(heights)
        part = self._integrals(edge, np.where(rises, t, 0.0), np.where(rises, 1.0, t))
        np.add.at(total, at, part)
        return total[0] if np.ndim(above) == 0 else total

    def width(self, at: float | np.ndarray) -> np.ndarray:
        """Total length of the horizontal chords at height(s) ``at`` [m], times the weight; shape of ``at``."""
        heights = np.atleast_1d(np.asarray(at, dtype=float))
        k, edge, t, rises = self.crossings(heights)
        x = self.coordinates(edge, t[:, None])[0][:, 0] * self.weight[edge]
        total = np.zeros(len(heights))
        np.add.at(total, k, np.where(rises, x, -x))
        return total.reshape(np.shape(at))

    def height_of(self, area_above: float) -> float:
        """Height y [m] with ``area_above`` (weighted) above it; the middle of the gap where several will do."""
        heights = self.stops()
        areas = self.moments(heights)[:, 0]
        slack = 1e-14 * areas[0]
        equal = np.flatnonzero(np.abs(areas - area_above) <= slack)
        if len(equal):
            return float(0.5 * (heights[equal[0]] + heights[equal[-1]]))
        i = int(np.clip(np.searchsorted(-areas, -area_above) - 1, 0, len(heights) - 2))
        low, high = float(heights[i]), float(heights[i + 1])
        y = low + (high - low) * float((areas[i] - area_above) / (areas[i] - areas[i + 1]))
        for _ in range(100):  # Newton on a smooth, monotone piece; bisection where a step leaves the bracket
            rest = float(self.moments(y)[0]) - area_above
            if abs(rest) <= slack:
                break
            low, high = (y, high) if rest > 0.0 else (low, y)
            width = float(self.width(y))
            step = y + rest / width if width > 0.0 else low
            following = step if low < step < high else 0.5 * (low + high)
            if following == y or high - low <= 1e-16 * (heights[-1] - heights[0]):
                break
            y = following
        return y
