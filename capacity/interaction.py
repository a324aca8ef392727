"""What axial force, shear and moment a section bears together.

With a plastic neutral axis at y0 and the part above in tension, N = ∫fy (±1) dA and M = ∫fy (±1) y dA: one clipping of
the outline for each point of the exact N–M curve. Shear takes its share of the yield stress where it is borne,
σ² + (fy/τ_y)² τ² = fy² (Tresca or von Mises): in the walls along the load fy falls to fy √(1 - (Q/Q_max)²), in a solid
section everywhere. N is positive in tension, M where it pulls the upper face; both are about the centroid.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from capacity.errors import InputError
from capacity.materials import Material
from capacity.outline import Outline
from capacity.paths import arc
from capacity.sections import Part, Section
from capacity.yield_criteria import shear_ratio


@dataclass(frozen=True)
class FacetSurface:
    """A yield surface of flat facets in N and M that shear draws in, for a joint to return to at once.

        a_k N + b_k M ≤ f_k + w_k √(1 - (Q/Q_max)²)   for every facet k

    f_k is what the parts that bear no shear reach in the direction (a_k, b_k), w_k what the walls along the load reach.
    The region is convex, and exact in Q. `value` is homogeneous of degree one.

    Attributes
    ----------
    normals : (n, 2) float
        a_k [1/N] and b_k [1/(N m)].
    fixed, walls : (n,) float
        f_k and w_k [-].
    Q_max : float
        [N]
    error : float
        Greatest `value` on the exact surface, less one: how much the facets underrate the section, as a share of the
        load; they never overrate it.
    """

    normals: np.ndarray
    fixed: np.ndarray
    walls: np.ndarray
    Q_max: float
    error: float

    def value(self, N: float | np.ndarray, Q: float | np.ndarray, M: float | np.ndarray) -> np.ndarray:
        """Share of the capacity that (N, Q, M) uses [N, N, N m]: 1 on the surface, less inside; shape of N, Q, M.

        The λ at which (N, Q, M) / λ lies on the facet, λ f + w √(λ² - q²) = a N + b M, greatest over the facets.
        """
        q = np.abs(np.asarray(Q) / self.Q_max)[..., None]
        c = np.asarray(N)[..., None] * self.normals[:, 0] + np.asarray(M)[..., None] * self.normals[:, 1]
        f, w = self.fixed, self.walls
        c = np.maximum(c, q * f)  # below this the shear alone decides, λ = q
        root = np.sqrt(np.maximum(c * c - (f * f - w * w) * q * q, 0.0))
        below = c * f + w * root
        share: np.ndarray = np.where(below > 0.0, (c * c + (w * q) ** 2) / np.where(below > 0.0, below, 1.0), q)
        greatest: np.ndarray = share.max(axis=-1)
        return greatest


class Interaction:
    """The exact yield surface of a section in axial force, shear and moment.

    Parameters
    ----------
    section : Section
    material : Material
        Of pieces that name none.
    criterion : str
        ``"tresca"`` or ``"von-mises"``.

    Raises
    ------
    InputError
        For an unknown criterion.
    """

    def __init__(self, section: Section, material: Material, criterion: str = "von-mises") -> None:
        ratio = shear_ratio(criterion)
        self._full = section.weighted(lambda m: m.yield_stress, material)
        walls = [
            region.scaled_weight((part.material or material).yield_stress)
            for part in section.parts
            for region in _shear_regions(part)
        ]
        self._walls = walls[0]
        for wall in walls[1:]:
            self._walls = self._walls + wall
        self.Q_max = sum(ratio * (p.material or material).yield_stress * p.wall_area() for p in section.parts)
        self.N_max = float(self._full.moments()[0])
        self.M_max = self.moments_at(0.0)[1]

    def _reduced(self, Q: float) -> Outline:
        if Q == 0.0:
            return self._full
        if abs(Q) > self.Q_max:
            raise InputError("shear force", f"{Q:.6g} N exceeds Q_max = {self.Q_max:.6g} N", "take a smaller one")
        left = math.sqrt(max(0.0, 1.0 - (Q / self.Q_max) ** 2))
        return self._full + self._walls.scaled_weight(left - 1.0)

    def axial_at(self, Q: float) -> float:
        """Greatest axial force beside ``Q`` and no moment about the plastic centroid [N].

        Raises
        ------
        InputError
            When Q alone is beyond Q_max.
        """
        return float(self._reduced(Q).moments()[0])

    def moments_at(self, N: float, Q: float = 0.0) -> tuple[float, float]:
        """Least and greatest moment about the centroid that go with ``N`` and ``Q`` [N m].

        Raises
        ------
        InputError
            When N or Q alone is beyond what the section bears.
        """
        outline = self._reduced(Q)
        whole = outline.moments()
        if abs(N) > whole[0] * (1.0 + 1e-12):
            fault = f"{N:.6g} N exceeds the {whole[0]:.6g} N that are left beside the shear force"
            raise InputError("axial force", fault, "take a smaller one")
        force = min(abs(N), float(whole[0])) * math.copysign(1.0, N)
        up = outline.moments(outline.height_of(0.5 * (float(whole[0]) + force)))
        down = outline.moments(outline.height_of(0.5 * (float(whole[0]) - force)))
        return float(whole[2] - 2.0 * down[2]), float(2.0 * up[2] - whole[2])

    def curve(self, count: int = 181, Q: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Points (N, M) of the exact curve beside ``Q``, once round, 2 × ``count`` of them [N, N m].

        Raises
        ------
        InputError
            When Q alone is beyond Q_max.
        """
        outline = self._reduced(Q)
        low, high = outline.extent()
        even = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.linspace(0.0, math.pi, count))
        whole, above = outline.moments(), outline.moments(even)
        N, M = 2.0 * above[:, 0] - whole[0], 2.0 * above[:, 2] - whole[2]
        return np.concatenate([N, -N]), np.concatenate([M, -M])

    def bears(self, N: float, Q: float, M: float) -> bool:
        """Whether the section bears (N, Q, M) together [N, N, N m]."""
        if abs(Q) > self.Q_max:
            return False
        outline = self._reduced(Q)
        whole = outline.moments()
        if abs(N) > whole[0]:
            return False
        side = 1.0 if M >= 0.0 else -1.0
        first = outline.moments(outline.height_of(0.5 * float(whole[0] + side * N)))[2]
        return bool(abs(M) <= 2.0 * first - whole[2])

    def load_factor(self, N: float, Q: float, M: float) -> float:
        """By how much (N, Q, M) may grow together until the section yields through; below 1 it is outside.

        Raises
        ------
        InputError
            When all three are zero.
        """
        if N == 0.0 and Q == 0.0 and M == 0.0:
            raise InputError("N, Q, M", "all are zero", "give at least one of them")
        near = 1.0 / float(self._facets.value(N, Q, M))
        low, high = 0.9 * near, 1.2 * near  # wider than the facets' error; the ray leaves the convex region once
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.bears(middle * N, middle * Q, middle * M) else (low, middle)
        return 0.5 * (low + high)

    @cached_property
    def _facets(self) -> FacetSurface:
        return self.facets()

    def facets(self, count: int = 64) -> FacetSurface:
        """The surface by ``count`` facets, all on the safe side, with its error against the exact surface.

        A facet belongs to a neutral axis at y0: M - y0 N reaches ∫fy |y - y0| dA. These tangents of the exact curve are
        drawn in together until they lie within it.
        """
        height = self._spread(count // 2)
        side = np.repeat([1.0, -1.0], len(height))
        normals = side[:, None] * np.column_stack([-np.tile(height, 2), np.ones(2 * len(height))]) / self.M_max
        whole, walls = (np.tile(_reach(outline, height), 2) / self.M_max for outline in (self._full, self._walls))
        fixed = np.maximum(whole - walls, 0.0)
        shares = np.array([*np.linspace(0.0, 0.95, 20), 0.98, 0.99, 0.997, 0.999])
        curves = [np.column_stack(self.curve(361, share * self.Q_max)) for share in shares.tolist()]
        left = np.sqrt(1.0 - shares**2)
        least = min(
            float((curve @ normals.T / (fixed + r * walls)).max(axis=1).min())
            for curve, r in zip(curves, left.tolist(), strict=True)
        )
        # Only N and M are drawn in: Q_max is exact.
        inner = FacetSurface(normals, fixed * least, walls * least, self.Q_max, 0.0)
        greatest = max(
            float(inner.value(curve[:, 0], share * self.Q_max, curve[:, 1]).max())
            for curve, share in zip(curves, shares.tolist(), strict=True)
        )
        return replace(inner, error=greatest - 1.0)

    def _spread(self, count: int) -> np.ndarray:
        """Heights of neutral axes, dense where area is: thin flanges count even when shear leaves nothing else."""
        low, high = self._full.extent()
        fine = np.linspace(low, high, 1001)
        below = 1.0 - self._full.moments(fine)[:, 0] / self.N_max
        share = 0.5 * below + 0.5 * (fine - low) / (high - low)
        return np.interp(np.linspace(0.0, 1.0, count), share, fine)


def _reach(outline: Outline, height: np.ndarray) -> np.ndarray:
    """∫ weight |y - height| dA for each height."""
    whole, above = outline.moments(), outline.moments(height)
    reach: np.ndarray = 2.0 * (above[:, 2] - height * above[:, 0]) - (whole[2] - height * whole[0])
    return reach


def _shear_regions(part: Part) -> list[Outline]:
    """Where a piece bears shear along y: its thin walls that have an extent along y, all of a solid piece."""
    if part.walls is None:
        return [part.outline]
    walls, (first, last) = part.walls, part.walls.ends
    region: list[Outline] = []
    for i in np.flatnonzero(np.abs(last[:, 1] - first[:, 1]) > 1e-9 * np.ptp(part.outline.extent())).tolist():
        t = float(walls.weight[i])
        if walls.radius[i] == 0.0:
            along = walls.span[i] / math.hypot(*walls.span[i])
            across = 0.5 * t * np.array([-along[1], along[0]])
            corners = [first[i] - across, last[i] - across, last[i] + across, first[i] + across]
            region.append(Outline.polygon([(float(x), float(y)) for x, y in corners]))
        else:
            (cx, cy), r = walls.point[i].tolist(), float(walls.radius[i])
            start, sweep = float(walls.start[i]), float(walls.sweep[i])
            outer, inner = r + 0.5 * t, r - 0.5 * t
            ring = (
                Outline.from_edges(arc(cx, cy, outer, start, sweep) + arc(cx, cy, inner, start + sweep, -sweep))
                + _radial(cx, cy, start + sweep, outer, inner)
                + _radial(cx, cy, start, inner, outer)
            )
            region.append(ring)
    return region


def _radial(cx: float, cy: float, angle: float, r0: float, r1: float) -> Outline:
    c, s = math.cos(angle), math.sin(angle)
    return Outline.from_edges([(cx + r0 * c, cy + r0 * s, (r1 - r0) * c, (r1 - r0) * s, 0.0, 0.0, 0.0)])
