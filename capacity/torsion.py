"""Plastic torsion by the sand heap over a section (Nadai), with level roofs over its hollows (Sadowsky).

    T_max = 2 τ_y V,   V = ∫ A(s) ds,

A(s) being the area further than s from the outside, where a hollow lies as high as the shortest way to it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from capacity.materials import Material
from capacity.outline import Outline
from capacity.sections import Section
from capacity.yield_criteria import shear_ratio


def plastic_torsion_modulus(section: Section) -> float:
    """T_max / τ_y [m³]: in closed form for the shapes of `shapes`, else by the heap over the outline, to about 0.1 %.

    Closed forms take thin walls as such: Σ l t² / 2 for open ones, 2 A_m t for a box.
    """
    if section.plastic_torsion_modulus is not None:
        return section.plastic_torsion_modulus
    return 2.0 * heap_volume(section.outline)


def torsion_capacity(section: Section, material: Material, criterion: str = "von-mises") -> float:
    """T_max [N m].

    Of pieces of several materials each counts for itself, which is on the safe side: no shear flow passes from one
    to another.

    Raises
    ------
    InputError
        For an unknown criterion.
    """
    ratio = shear_ratio(criterion)
    if not section.has_own_materials:
        return ratio * material.yield_stress * plastic_torsion_modulus(section)
    pieces = ((part.material or material, part.outline) for part in section.parts)
    return sum(ratio * m.yield_stress * 2.0 * heap_volume(outline) for m, outline in pieces)


def heap_volume(outline: Outline) -> float:
    """Volume of the sand heap of slope 1 over an outline [m³], by erosion."""
    from capacity.tessellation import polygon_of

    region = polygon_of(outline)
    return sum(_heap(piece) for piece in getattr(region, "geoms", [region]))


def _heap(region: Any) -> float:
    from shapely import Polygon

    filled = Polygon(region.exterior)
    holes = [Polygon(ring) for ring in region.interiors]
    levels = _hole_levels(filled, holes)
    low, high = 0.0, float(np.sqrt(filled.area))
    for _ in range(40):  # inradius of what is filled
        middle = 0.5 * (low + high)
        low, high = (low, middle) if filled.buffer(-middle).is_empty else (middle, high)
    stops = np.unique(np.concatenate([np.linspace(0.0, high, 25), np.clip(levels, 0.0, high)]))
    nodes, weights = np.polynomial.legendre.leggauss(3)
    volume = 0.0
    for a, b in zip(stops[:-1].tolist(), stops[1:].tolist(), strict=True):
        for node, weight in zip(nodes.tolist(), weights.tolist(), strict=True):
            s = 0.5 * (a + b) + 0.5 * (b - a) * node
            over = filled.buffer(-s)
            for hole, level in zip(holes, levels, strict=True):
                if level < s:
                    over = over.difference(hole.buffer(s - level))
            volume += 0.5 * (b - a) * weight * over.area
    return volume


def _hole_levels(filled: Any, holes: list[Any]) -> list[float]:
    """Height of each hollow's roof: the shortest way from the outside, which may lead across other hollows."""
    levels = [filled.exterior.distance(hole) for hole in holes]
    for _ in holes:
        levels = [
            min([level, *(other + hole.distance(holes[j]) for j, other in enumerate(levels) if j != i)])
            for i, (hole, level) in enumerate(zip(holes, levels, strict=True))
        ]
    return levels
