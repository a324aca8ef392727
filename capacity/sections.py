"""Cross-sections: what their geometry gives, whatever they are made of.

Axes: y up in the plane of bending, x across it, origin at the centroid; the load acts along y, bending is about x.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from capacity.outline import Outline, arc, path

# Strips next to the plastic centroid end at this power of an even division. On the path of a cantilever of rectangle,
# I section or tube, 12 to 16 fibres then do what 24 evenly spaced ones do.
_GRADING = 1.5


@dataclass(frozen=True)
class Fibres:
    """A section as lumped areas.

    Attributes
    ----------
    y : (n,) float
        Distance of each fibre from the centroid, up positive [m].
    area : (n,) float
        Area of each fibre [m²].
    """

    y: np.ndarray
    area: np.ndarray


class Section:
    """A cross-section; never changed once made.

    Parameters
    ----------
    name : str
        How the section was asked for.
    outline : Outline
        Boundary, with the centroid at the origin [m].
    wall_area : float
        Area of the walls along the load, which carry shear once the section is plastic [m²].
    curved_wall_shear_area : float, optional
        Elastic shear area of a section whose walls turn with the shear stress, where `shear_area`'s formula for
        straight walls does not hold [m²].
    """

    def __init__(
        self, name: str, outline: Outline, wall_area: float, curved_wall_shear_area: float | None = None
    ) -> None:
        self.name = name
        self.outline = outline
        self.wall_area = wall_area
        self.curved_wall_shear_area = curved_wall_shear_area

    def __repr__(self) -> str:
        return f"Section({self.name!r})"

    def renamed(self, name: str) -> Section:
        """The same section under another name."""
        return Section(name, self.outline, self.wall_area, self.curved_wall_shear_area)

    @staticmethod
    def centred(name: str, outline: Outline, wall_area: float | None = None) -> Section:
        """A section from an outline placed anywhere; ``wall_area`` is the whole area when not given."""
        area, sx, sy = outline.moments()[:3]
        shape = outline.shifted(-sx / area, -sy / area)
        return Section(name, shape, float(area if wall_area is None else wall_area))

    @cached_property
    def _moments(self) -> np.ndarray:
        return self.outline.moments()

    @property
    def area(self) -> float:
        """Area A [m²]."""
        return float(self._moments[0])

    @property
    def second_moment_of_area(self) -> float:
        """Second moment of area I = ∫y² dA [m⁴]."""
        return float(self._moments[5])

    @property
    def depth(self) -> float:
        """Extent along y [m]."""
        low, high = self.outline.extent()
        return high - low

    @property
    def elastic_modulus(self) -> float:
        """Elastic modulus W_el = I / |y|max [m³]."""
        low, high = self.outline.extent()
        return self.second_moment_of_area / max(high, -low)

    @cached_property
    def plastic_centroid(self) -> float:
        """Height of the line that halves the area, from the centroid [m]."""
        low, high = self.outline.extent()
        half = 0.5 * self.area
        for _ in range(200):  # bisection: the area above is monotone, with kinks at every corner
            middle = 0.5 * (low + high)
            if middle in (low, high):
                break
            if self.outline.moments(middle)[0] > half:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)

    @cached_property
    def plastic_modulus(self) -> float:
        """Plastic modulus W_pl = ∫|y - y_pc| dA [m³]."""
        area, _, first = self.outline.moments(self.plastic_centroid)[:3]
        # The first moment of the whole about its centroid is zero, so both halves give the same moment.
        return float(2.0 * (first - self.plastic_centroid * area) + self.plastic_centroid * self.area)

    @property
    def shape_factor(self) -> float:
        """W_pl / W_el [-]."""
        return self.plastic_modulus / self.elastic_modulus

    @cached_property
    def shear_area(self) -> float:
        """Elastic shear area A_s = I² / ∫ S(y)² / b(y) dy, from the shear stresses of Jourawski's formula [m²].

        5/6 of the area for a rectangle, 9/10 for a solid circle (Gere & Goodno, Mechanics of Materials, 8th ed.,
        section 9.10).
        """
        if self.curved_wall_shear_area is not None:
            return self.curved_wall_shear_area
        stops = np.unique(np.round(self.outline.corners()[:, 1], 15))
        nodes, weights = np.polynomial.legendre.leggauss(16)
        total = 0.0
        for low, high in itertools.pairwise(stops):
            # y = c - r cos φ takes the square root out of the width of an arc at its ends.
            phi = 0.5 * math.pi * (nodes + 1.0)
            heights = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(phi)
            steps = 0.25 * math.pi * weights * (high - low) * np.sin(phi)
            for y, dy in zip(heights, steps, strict=True):
                total += dy * self.outline.moments(y)[2] ** 2 / self.outline.width(y)
        return float(self.second_moment_of_area**2 / total)

    def fibres(self, count: int) -> Fibres:
        """The section as ``count`` fibres with exact A, first moment, I, and plastic modulus.

        Each half of the area, above and below the plastic centroid, is cut into strips; each strip becomes two fibres
        of half its area at its own radius of gyration from its own centroid (the two-point rule that is exact to the
        second moment). Strips end where the width jumps, at the flanges of an I section for one, and grow thinner
        towards the plastic centroid: the last fibres to yield decide how a moment approaches M_p.

        Parameters
        ----------
        count : int
            Number of fibres, a multiple of 4.

        Raises
        ------
        ValueError
            When ``count`` is not a positive multiple of 4.
        """
        if count < 4 or count % 4:
            raise ValueError(f"{count} fibres: the number must be a positive multiple of 4")
        cuts = self._strip_cuts(count // 4)
        above = np.array([self.outline.moments(y) for y in cuts])
        strips = above[:-1] - above[1:]
        area, first, second = strips[:, 0], strips[:, 2], strips[:, 5]
        centre = first / area
        reach = np.sqrt(np.maximum(second / area - centre**2, 0.0))
        y = np.column_stack([centre - reach, centre + reach]).ravel()
        return Fibres(y=y, area=np.repeat(0.5 * area, 2))

    def _strip_cuts(self, strips: int) -> np.ndarray:
        """Heights that cut each half of the section into ``strips`` strips, from the lowest to the highest."""
        low, high = self.outline.extent()
        centre = self.plastic_centroid
        flat = (self.outline.radius == 0.0) & (np.abs(self.outline.span[:, 1]) <= 1e-12 * (high - low))
        jumps = self.outline.point[flat, 1]
        cuts = [np.array([centre])]
        for edge in (low, high):
            inside = np.abs(jumps - 0.5 * (centre + edge)) < (0.5 - 1e-9) * abs(edge - centre)
            stops = np.unique(np.concatenate([[centre, edge], np.round(jumps[inside], 12)]))
            stops = stops if edge > centre else stops[::-1]
            if len(stops) - 1 > strips:
                stops = np.array([centre, edge])
            areas = np.abs(np.diff([self.outline.moments(y)[0] for y in stops]))
            areas[0] *= 2.0  # what yields last is worth more strips
            counts = np.ones(len(areas), dtype=int)
            while counts.sum() < strips:
                counts[np.argmax(areas / counts)] += 1
            for i, count in enumerate(counts):
                share = np.arange(1, count + 1) / count
                cuts.append(stops[i] + (stops[i + 1] - stops[i]) * (share**_GRADING if i == 0 else share))
        return np.sort(np.concatenate(cuts))


def rectangle(b: float, h: float) -> Section:
    """Solid rectangle of width ``b`` and height ``h`` [m]."""
    corners = [(0.0, 0.0), (b, 0.0), (b, h), (0.0, h)]
    return Section.centred(f"rectangle {b * 1e3:g}x{h * 1e3:g} mm", Outline.polygon(corners))


def circle(d: float) -> Section:
    """Solid circle of diameter ``d`` [m]."""
    return Section.centred(f"circle {d * 1e3:g} mm", Outline.from_edges(arc(0.0, 0.0, 0.5 * d, 0.0, 2.0 * math.pi)))


def circular_hollow(d: float, t: float) -> Section:
    """Circular hollow section of outer diameter ``d`` and wall ``t`` [m].

    Walls along the load: 2 A / π (EN 1993-1-1, 6.2.6). Elastic shear area: Cowper, The shear coefficient in
    Timoshenko's beam theory, J. Appl. Mech. 33 (1966), with a Poisson's ratio of 0.3.
    """
    if 2.0 * t >= d:
        raise ValueError(f"a wall of {t * 1e3:g} mm leaves no hollow in a tube of {d * 1e3:g} mm")
    outer = arc(0.0, 0.0, 0.5 * d, 0.0, 2.0 * math.pi)
    inner = arc(0.0, 0.0, 0.5 * d - t, 0.0, -2.0 * math.pi)
    nu, m = 0.3, 1.0 - 2.0 * t / d
    area = math.pi * t * (d - t)
    ring = (1.0 + m * m) ** 2
    shear = area * 6.0 * (1.0 + nu) * ring / ((7.0 + 6.0 * nu) * ring + (20.0 + 12.0 * nu) * m * m)
    outline = Outline.from_edges(outer + inner)
    return Section(f"CHS {d * 1e3:g}x{t * 1e3:g} mm", outline, 2.0 * area / math.pi, shear)


def rectangular_hollow(h: float, b: float, t: float) -> Section:
    """Rectangular hollow section with sharp corners, height ``h``, width ``b``, wall ``t`` [m]."""
    if 2.0 * t >= min(b, h):
        raise ValueError(f"a wall of {t * 1e3:g} mm leaves no hollow in {h * 1e3:g}x{b * 1e3:g} mm")
    outer = Outline.polygon([(0.0, 0.0), (b, 0.0), (b, h), (0.0, h)])
    inner = Outline.polygon([(t, t), (t, h - t), (b - t, h - t), (b - t, t)])
    name = f"RHS {h * 1e3:g}x{b * 1e3:g}x{t * 1e3:g} mm"
    return Section.centred(name, outer + inner, 2.0 * t * (h - t))


def i_section(h: float, b: float, tw: float, tf: float, r: float = 0.0) -> Section:
    """Doubly symmetric I or H section: height, width, web, flange, root radius [m]."""
    if tw >= b or 2.0 * tf >= h:
        raise ValueError("web or flanges fill the whole section")
    w, f = 0.5 * tw, 0.5 * h - tf
    half, top = 0.5 * b, 0.5 * h
    corners = [
        (half, -top, 0.0),
        (half, -f, 0.0),
        (w, -f, r),
        (w, f, r),
        (half, f, 0.0),
        (half, top, 0.0),
        (-half, top, 0.0),
        (-half, f, 0.0),
        (-w, f, r),
        (-w, -f, r),
        (-half, -f, 0.0),
        (-half, -top, 0.0),
    ]
    sizes = "x".join(f"{v * 1e3:g}" for v in (h, b, tw, tf, r))
    return Section.centred(f"I {sizes} mm", path(corners), tw * (h - tf))
