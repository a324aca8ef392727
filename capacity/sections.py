"""Cross-sections: what their geometry gives, whatever they are made of.

Axes: y up in the plane of bending, x across it, origin at the centroid; the load acts along y, bending is about x.
Properties about any other axis are those of the turned section: ``section.rotated(angle)``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from capacity.fibres import Fibres, cut_fibres
from capacity.materials import Material
from capacity.outline import Outline


@dataclass(frozen=True)
class Part:
    """A piece of a section, in the section's axes.

    Attributes
    ----------
    outline : Outline
        Boundary [m].
    walls : Outline, optional
        Centrelines of thin walls with their thickness as weight; none for a solid piece, whose whole area bears shear.
    material : Material, optional
        What this piece is made of, when it is not what the whole section is made of.
    """

    outline: Outline
    walls: Outline | None = None
    material: Material | None = None

    def moved(self, by: Callable[[Outline], Outline]) -> Part:
        """The same piece with its outline and walls moved, turned or mirrored by ``by``."""
        return Part(by(self.outline), None if self.walls is None else by(self.walls), self.material)

    def wall_area(self) -> float:
        """Area that bears shear along y once plastic: Σ t |Δy| of thin walls, all of a solid piece [m²]."""
        if self.walls is None:
            return float(self.outline.moments()[0])
        first, last = self.walls.ends
        return float(np.sum(self.walls.weight * np.abs(last[:, 1] - first[:, 1])))


class Section:
    """A cross-section; never changed once made. `Section.drawn` makes one from pieces drawn anywhere.

    Parameters
    ----------
    name : str
        How the section was asked for.
    parts : tuple of Part
        What it consists of, with the centroid of the whole at the origin.
    centroid : (float, float)
        Where the centroid lies in the axes the section was drawn in [m].
    curved_wall_shear_area : float, optional
        Elastic shear area of a section whose walls turn with the shear stress, where `shear_area`'s formula for
        straight walls does not hold [m²].
    plastic_torsion_modulus : float, optional
        T_max / τ_y [m³], where the shape has a closed form for it.
    """

    def __init__(
        self,
        name: str,
        parts: tuple[Part, ...],
        centroid: tuple[float, float],
        curved_wall_shear_area: float | None = None,
        plastic_torsion_modulus: float | None = None,
    ) -> None:
        self.name = name
        self.parts = parts
        self.centroid = centroid
        self.curved_wall_shear_area = curved_wall_shear_area
        self.plastic_torsion_modulus = plastic_torsion_modulus

    def __repr__(self) -> str:
        return f"Section({self.name!r})"

    @staticmethod
    def drawn(
        name: str,
        parts: Iterable[Part],
        curved_wall_shear_area: float | None = None,
        plastic_torsion_modulus: float | None = None,
    ) -> Section:
        """A section from pieces drawn anywhere; the origin moves to the centroid of their area."""
        parts = tuple(parts)
        area, sx, sy = np.sum([part.outline.moments()[:3] for part in parts], axis=0).tolist()
        x, y = sx / area, sy / area
        centred = tuple(part.moved(lambda outline: outline.shifted(-x, -y)) for part in parts)
        return Section(name, centred, (x, y), curved_wall_shear_area, plastic_torsion_modulus)

    def renamed(self, name: str) -> Section:
        """The same section under another name."""
        return Section(name, self.parts, self.centroid, self.curved_wall_shear_area, self.plastic_torsion_modulus)

    def rotated(self, angle: float) -> Section:
        """The section turned counter-clockwise about its centroid by ``angle`` [rad]."""
        x, y = self.centroid
        c, s = math.cos(angle), math.sin(angle)
        parts = tuple(part.moved(lambda outline: outline.rotated(angle)) for part in self.parts)
        curved, torsion = self.curved_wall_shear_area, self.plastic_torsion_modulus
        return Section(self.name, parts, (c * x - s * y, s * x + c * y), curved, torsion)

    def mirrored(self) -> Section:
        """The section mirrored in its y axis, x → -x."""
        parts = tuple(part.moved(Outline.mirrored) for part in self.parts)
        curved, torsion = self.curved_wall_shear_area, self.plastic_torsion_modulus
        return Section(self.name, parts, (-self.centroid[0], self.centroid[1]), curved, torsion)

    @cached_property
    def outline(self) -> Outline:
        """Boundary of all pieces together [m]."""
        whole = self.parts[0].outline
        for part in self.parts[1:]:
            whole = whole + part.outline
        return whole

    @property
    def has_own_materials(self) -> bool:
        """Whether any piece names its material."""
        return any(part.material is not None for part in self.parts)

    def weighted(self, value: Callable[[Material], float], material: Material) -> Outline:
        """The outline whose integrals are ∫ value dA; ``material`` is that of pieces that name none."""
        outlines = [part.outline.scaled_weight(value(part.material or material)) for part in self.parts]
        whole = outlines[0]
        for outline in outlines[1:]:
            whole = whole + outline
        return whole

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
    def second_moments(self) -> tuple[float, float, float]:
        """∫y² dA, ∫x² dA and ∫xy dA [m⁴]."""
        return float(self._moments[5]), float(self._moments[3]), float(self._moments[4])

    @property
    def principal_moments(self) -> tuple[float, float, float]:
        """Greatest and least second moment of area [m⁴], and the angle from the x axis to the axis of the greatest,
        counter-clockwise, in (-π/2, π/2] [rad]; 0 when the two are equal.
        """
        ix, iy, ixy = self.second_moments
        mean, half = 0.5 * (ix + iy), math.hypot(0.5 * (ix - iy), ixy)
        # An angle of rounding errors is none.
        twist = 0.0 - 2.0 * ixy if abs(ixy) > 1e-14 * mean else 0.0
        angle = 0.5 * math.atan2(twist, ix - iy) if half > 1e-12 * mean else 0.0
        return mean + half, mean - half, angle

    @property
    def depth(self) -> float:
        """Extent along y [m]."""
        low, high = self.outline.extent()
        return high - low

    @property
    def elastic_moduli(self) -> tuple[float, float]:
        """I / |y| at the upper and the lower face [m³]."""
        low, high = self.outline.extent()
        return self.second_moment_of_area / high, self.second_moment_of_area / -low

    @property
    def elastic_modulus(self) -> float:
        """Elastic modulus W_el = I / |y|max [m³]."""
        return min(self.elastic_moduli)

    @cached_property
    def _plastic(self) -> tuple[float, float]:
        half = 0.5 * self.area
        y, above = 0.0, self.outline.moments(0.0)
        if abs(above[0] - half) > 1e-14 * self.area:  # else a symmetric section, at once
            y = self.outline.height_of(half)
            above = self.outline.moments(y)
        # The first moment of the whole about its centroid is zero, so both halves give the same moment.
        return y, float(2.0 * (above[2] - y * above[0]) + y * self.area)

    @property
    def plastic_centroid(self) -> float:
        """Height of the line that halves the area, from the centroid [m]."""
        return self._plastic[0]

    @property
    def plastic_modulus(self) -> float:
        """Plastic modulus W_pl = ∫|y - y_pc| dA [m³]."""
        return self._plastic[1]

    @property
    def shape_factor(self) -> float:
        """W_pl / W_el [-]."""
        return self.plastic_modulus / self.elastic_modulus

    @property
    def wall_area(self) -> float:
        """Area of the walls along the load, which carry shear once the section is plastic [m²]."""
        return sum(part.wall_area() for part in self.parts)

    @cached_property
    def shear_area(self) -> float:
        """Elastic shear area A_s = I² / ∫ S(y)² / b(y) dy, from the shear stresses of Jourawski's formula [m²].

        5/6 of the area for a rectangle, 9/10 for a solid circle (Gere & Goodno, Mechanics of Materials, 8th ed.,
        section 9.10).
        """
        if self.curved_wall_shear_area is not None:
            return self.curved_wall_shear_area
        return shear_stiffness(self.outline, self.outline)

    def fibres(self, count: int) -> Fibres:
        """The section as ``count`` fibres with exact A, first moment, I, and plastic modulus (`fibres.cut_fibres`).

        Parameters
        ----------
        count : int
            Number of fibres, at least 4.

        Raises
        ------
        ValueError
            When ``count`` is below 4, or pieces have materials of their own: then each piece has
            fibres of its own, `fibres_by_material`.
        """
        if self.has_own_materials:
            raise ValueError(f"{self.name} is made of several materials: take fibres_by_material")
        return cut_fibres(self.outline, self.plastic_centroid, count)

    def fibres_by_material(self, count: int, material: Material) -> list[tuple[Material, Fibres]]:
        """Each piece's material (``material`` where it names none) and its ``count`` fibres.

        Strips of a piece end at the plastic centroid of the whole where that passes through the piece.

        Raises
        ------
        ValueError
            When ``count`` is below 4.
        """
        plastic = self.weighted(lambda m: m.yield_stress, material)
        centre = plastic.height_of(0.5 * float(plastic.moments()[0]))
        answer = []
        for part in self.parts:
            low, high = part.outline.extent()
            inside = low + 1e-9 * (high - low) < centre < high - 1e-9 * (high - low)
            own = centre if inside else part.outline.height_of(0.5 * float(part.outline.moments()[0]))
            answer.append((part.material or material, cut_fibres(part.outline, own, count)))
        return answer


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_ARC_NODES, _ARC_WEIGHTS = np.polynomial.legendre.leggauss(14)


def shear_stiffness(bending: Outline, shear: Outline) -> float:
    """(∫ E y² dA)² / ∫ (∫ E y dA above)² / (∫ G dx) dy: GA_s when weighted with E and G, A_s with neither.

    The strain energy of the shear flow that equilibrium asks for (Jourawski); y is from the centroid weighted with E.
    """
    area, _, first, _, _, second = bending.moments()
    centre = first / area
    stops = bending.stops()
    middle, half = 0.5 * (stops[:-1] + stops[1:]), 0.5 * np.diff(stops)
    first_y, last_y = (end[bending.radius > 0.0, 1] for end in bending.ends)
    curved = np.any((middle[:, None] - first_y) * (middle[:, None] - last_y) < 0.0, axis=1)
    # y = c - r cos φ takes the square root out of the width of an arc at its ends.
    phi = 0.5 * math.pi * (_ARC_NODES + 1.0)
    nodes, weights = -np.cos(phi), 0.5 * math.pi * _ARC_WEIGHTS * np.sin(phi)
    y = np.concatenate([middle[~curved].repeat(len(_NODES)), middle[curved].repeat(len(nodes))])
    y += np.concatenate([np.outer(half[~curved], _NODES).ravel(), np.outer(half[curved], nodes).ravel()])
    dy = np.concatenate([np.outer(half[~curved], _WEIGHTS).ravel(), np.outer(half[curved], weights).ravel()])
    above = bending.moments(y)
    flow = above[:, 2] - centre * above[:, 0]
    width = shear.width(y)
    solid = width > 0.0  # a gap between pieces has no width to bear shear
    return float((second - centre * first) ** 2 / np.sum(dy[solid] * flow[solid] ** 2 / width[solid]))
