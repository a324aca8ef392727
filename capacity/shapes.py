"""Sections by their dimensions: solid and hollow shapes, and thin walls with root and toe radii.

Each is drawn with its lower left corner at the origin, except circles and tubes (centre), channels (back of the web,
mid-height) and angles (heel); `Section.centroid` is given in these axes. All dimensions in m.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from capacity.outline import Outline
from capacity.paths import arc, circle_outline, line, path
from capacity.sections import Part, Section

Wall = tuple[float, float, float, float, float]


def _walls(walls: Iterable[Wall]) -> Outline:
    """Centrelines (x0, y0, x1, y1) of thickness t as an outline whose weight is the thickness."""
    rows = list(walls)
    shape = Outline.from_edges(edge for x0, y0, x1, y1, _ in rows for edge in line(x0, y0, x1, y1))
    return Outline(shape.point, shape.span, shape.radius, shape.start, shape.sweep, shape.weight * [w[4] for w in rows])


def _torsion_of_open(walls: Iterable[Wall]) -> float:
    """Σ l t² / 2 of thin open walls [m³]: the sand heap over each (Nadai), ends left out."""
    return sum(0.5 * math.hypot(x1 - x0, y1 - y0) * t * t for x0, y0, x1, y1, t in walls)


def _open_section(name: str, outline: Outline, walls: Sequence[Wall]) -> Section:
    return Section.drawn(name, [Part(outline, _walls(walls))], plastic_torsion_modulus=_torsion_of_open(walls))


def _name(word: str, *sizes: float) -> str:
    return f"{word} {'x'.join(f'{size * 1e3:.10g}' for size in sizes)} mm"


def rectangle(b: float, h: float) -> Section:
    """Solid rectangle of width ``b`` and height ``h`` [m]."""
    outline = Outline.polygon([(0.0, 0.0), (b, 0.0), (b, h), (0.0, h)])
    thin, wide = sorted((b, h))
    heap = thin * thin * (3.0 * wide - thin) / 6.0  # sand heap over a rectangle (Nadai)
    return Section.drawn(_name("rectangle", b, h), [Part(outline)], plastic_torsion_modulus=heap)


def circle(d: float) -> Section:
    """Solid circle of diameter ``d`` [m]."""
    outline = circle_outline(0.0, 0.0, 0.5 * d)
    return Section.drawn(_name("circle", d), [Part(outline)], plastic_torsion_modulus=math.pi * d**3 / 12.0)


def polygon(
    exterior: Sequence[tuple[float, float]], holes: Sequence[Sequence[tuple[float, float]]] = (), name: str = "polygon"
) -> Section:
    """Solid polygon with holes; vertices in either sense [m].

    Raises
    ------
    ValueError
        For a boundary that crosses itself, encloses nothing, or a hole that is not inside; the place is named.
    """
    from capacity.validity import check_polygon

    check_polygon(exterior, holes)
    outline = _oriented(exterior, solid=True)
    for hole in holes:
        outline = outline + _oriented(hole, solid=False)
    return Section.drawn(name, [Part(outline)])


def _oriented(vertices: Sequence[tuple[float, float]], solid: bool) -> Outline:
    outline = Outline.polygon(vertices)
    return outline if (outline.moments()[0] > 0.0) == solid else outline.reversed()


def circular_hollow(d: float, t: float) -> Section:
    """Circular hollow section of outer diameter ``d`` and wall ``t`` [m].

    Walls along the load: 2 A / π (EN 1993-1-1, 6.2.6). Elastic shear area: Cowper, The shear coefficient in
    Timoshenko's beam theory, J. Appl. Mech. 33 (1966), with a Poisson's ratio of 0.3.
    """
    if 2.0 * t >= d:
        raise ValueError(f"a wall of {t * 1e3:g} mm leaves no hollow in a tube of {d * 1e3:g} mm")
    outline = circle_outline(0.0, 0.0, 0.5 * d) + circle_outline(0.0, 0.0, 0.5 * d - t).reversed()
    walls = Outline.from_edges(arc(0.0, 0.0, 0.5 * (d - t), 0.0, 2.0 * math.pi)).scaled_weight(t)
    nu, m = 0.3, 1.0 - 2.0 * t / d
    ring = (1.0 + m * m) ** 2
    shear = math.pi * t * (d - t) * 6.0 * (1.0 + nu) * ring / ((7.0 + 6.0 * nu) * ring + (20.0 + 12.0 * nu) * m * m)
    torsion = math.pi * (d**3 - (d - 2.0 * t) ** 3) / 12.0
    return Section.drawn(_name("CHS", d, t), [Part(outline, walls)], shear, torsion)


def rectangular_hollow(h: float, b: float, t: float, r_out: float = 0.0, r_in: float | None = None) -> Section:
    """Rectangular hollow section: height, width, wall, outer and inner corner radius [m].

    The inner radius is max(r_out - t, 0) when not given. Plastic torsion: 2 A_m t with the area A_m within the
    centreline, corners sharp (Bredt's flow at τ_y).
    """
    if 2.0 * t >= min(b, h):
        raise ValueError(f"a wall of {t * 1e3:g} mm leaves no hollow in {h * 1e3:g}x{b * 1e3:g} mm")
    r = max(r_out - t, 0.0) if r_in is None else r_in
    outer = path([(0.0, 0.0, r_out), (b, 0.0, r_out), (b, h, r_out), (0.0, h, r_out)])
    inner = path([(t, t, r), (b - t, t, r), (b - t, h - t, r), (t, h - t, r)])
    # The radii may differ so much that the corner's wall vanishes.
    if math.sqrt(2.0) * t + (math.sqrt(2.0) - 1.0) * (r - r_out) <= 0.0:
        raise ValueError(f"an outer radius of {r_out * 1e3:g} mm cuts through the wall of {t * 1e3:g} mm at the corner")
    x0, x1, y0, y1 = 0.5 * t, b - 0.5 * t, 0.5 * t, h - 0.5 * t
    walls = [(x0, y0, x1, y0, t), (x1, y0, x1, y1, t), (x1, y1, x0, y1, t), (x0, y1, x0, y0, t)]
    name = _name("RHS", h, b, t, *((r_out, r) if r_out or r else ()))
    torsion = 2.0 * (h - t) * (b - t) * t
    return Section.drawn(name, [Part(outer + inner.reversed(), _walls(walls))], plastic_torsion_modulus=torsion)


def i_section(h: float, b: float, tw: float, tf: float, r: float = 0.0) -> Section:
    """Doubly symmetric I or H section: height, width, web, flange, root radius [m]."""
    sizes = (h, b, tw, tf, r) if r else (h, b, tw, tf)
    return mono_symmetric_i(h, b, tf, b, tf, tw, r).renamed(_name("I", *sizes))


def mono_symmetric_i(h: float, b1: float, t1: float, b2: float, t2: float, tw: float, r: float = 0.0) -> Section:
    """I section of two flanges: height, upper width and thickness, lower width and thickness, web, root radius [m]."""
    if tw >= min(b1, b2) or t1 + t2 >= h:
        raise ValueError("web or flanges fill the whole section")
    c = 0.5 * max(b1, b2)
    w, upper, lower = 0.5 * tw, 0.5 * b1, 0.5 * b2
    right = [
        (c + lower, 0.0, 0.0),
        (c + lower, t2, 0.0),
        (c + w, t2, r),
        (c + w, h - t1, r),
        (c + upper, h - t1, 0.0),
        (c + upper, h, 0.0),
    ]
    outline = path(right + [(2.0 * c - x, y, radius) for x, y, radius in reversed(right)])
    walls = [
        (c, 0.5 * t2, c, h - 0.5 * t1, tw),
        (c - upper, h - 0.5 * t1, c + upper, h - 0.5 * t1, t1),
        (c - lower, 0.5 * t2, c + lower, 0.5 * t2, t2),
    ]
    return _open_section(_name("I", h, b1, t1, b2, t2, tw, r), outline, walls)


def channel(h: float, b: float, tw: float, tf: float, r1: float = 0.0, r2: float = 0.0, slope: float = 0.0) -> Section:
    """Channel: height, width, web, flange, root radius, toe radius [m], slope of the flanges' inner faces [-].

    A tapered flange has thickness ``tf`` at half the width (EN 10365, UPN up to 300).
    """
    return tapered_channel(h, b, tw, tf, r1, r2, slope, 0.5 * b)


def tapered_channel(
    h: float, b: float, tw: float, tf: float, r1: float, r2: float, slope: float, x_tf: float
) -> Section:
    """As `channel`, with the flange thickness ``tf`` at distance ``x_tf`` from the back of the web [m]."""
    top = 0.5 * h
    toe, root = tf - slope * (b - x_tf), tf + slope * (x_tf - tw)
    if tw >= b or root >= top or toe <= 0.0:
        raise ValueError("web or flanges fill the whole section, or the flanges taper to nothing")
    lower = [(0.0, -top, 0.0), (b, -top, 0.0), (b, -top + toe, r2), (tw, -top + root, r1)]
    outline = path(lower + [(x, -y, r) for x, y, r in reversed(lower)])
    walls = [
        (0.5 * tw, -top + 0.5 * tf, 0.5 * tw, top - 0.5 * tf, tw),
        (0.0, -top + 0.5 * tf, b, -top + 0.5 * tf, tf),
        (0.0, top - 0.5 * tf, b, top - 0.5 * tf, tf),
    ]
    return _open_section(_name("U", h, b, tw, tf, r1, r2), outline, walls)


def tee(h: float, b: float, tw: float, tf: float, r: float = 0.0) -> Section:
    """Tee with its flange on top: height, width, web, flange, root radius [m]."""
    if tw >= b or tf >= h:
        raise ValueError("web or flange fills the whole section")
    c, w = 0.5 * b, 0.5 * tw
    right = [(c + w, 0.0, 0.0), (c + w, h - tf, r), (b, h - tf, 0.0), (b, h, 0.0)]
    outline = path(right + [(b - x, y, radius) for x, y, radius in reversed(right)])
    walls = [(c, 0.0, c, h - 0.5 * tf, tw), (0.0, h - 0.5 * tf, b, h - 0.5 * tf, tf)]
    return _open_section(_name("T", h, b, tw, tf, r), outline, walls)


def angle(h: float, b: float, t: float, r1: float = 0.0, r2: float = 0.0) -> Section:
    """Angle with its heel lower left: height, width, thickness, root and toe radius [m]."""
    if t >= min(h, b):
        raise ValueError("the thickness fills the whole section")
    corners = [(0.0, 0.0, 0.0), (b, 0.0, 0.0), (b, t, r2), (t, t, r1), (t, h, r2), (0.0, h, 0.0)]
    walls = [(0.5 * t, 0.5 * t, 0.5 * t, h, t), (0.5 * t, 0.5 * t, b, 0.5 * t, t)]
    return _open_section(_name("L", h, b, t, r1, r2), path(corners), walls)
