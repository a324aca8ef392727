"""Sections from drawings: DXF files (extra ``dxf``), and objects of `sectionproperties` (extra ``sections``)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from capacity.errors import InputError
from capacity.materials import Material, checked
from capacity.outline import Outline
from capacity.paths import arc, circle_outline, line
from capacity.sections import Part, Section

Edge = tuple[float, ...]

# Metres in a unit of $INSUNITS (DXF reference); a drawing that names none is in mm.
_UNITS = {0: 1e-3, 1: 0.0254, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0}


def section_from_dxf(path: Path, scale: float | None = None, place: str = "drawing") -> Section:
    """The region within the closed loops of a drawing; a loop inside another is a hole, and so on inwards.

    Lines, arcs, circles and polylines with bulges are taken exactly.

    Parameters
    ----------
    path : Path
    scale : float, optional
        Metres in a unit of the drawing; the drawing's own unit when not given, mm when it has none.
    place : str
        For messages.

    Raises
    ------
    InputError
        When the file or ezdxf is missing, the file is no DXF, a curve is of another kind, or a loop is open.
    """
    try:
        import ezdxf
    except ImportError as error:
        raise InputError(place, "DXF needs ezdxf", 'install it with pip install "ductile-joints[dxf]"') from error
    try:
        drawing = ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError) as error:
        raise InputError(place, f'"{path}" is no DXF drawing ({error})', "write the path of a DXF file") from error
    unit = _UNITS.get(drawing.units) if scale is None else scale
    if unit is None:
        raise InputError(place, f'"{path.name}" is in an unknown unit', "draw it in mm, cm, m, in or ft")
    loops: list[Outline] = []
    loose: list[list[Edge]] = []
    for entity in drawing.modelspace():
        kind = entity.dxftype()
        if kind == "CIRCLE":
            x, y = entity.dxf.center.x * unit, entity.dxf.center.y * unit
            loops.append(circle_outline(x, y, entity.dxf.radius * unit))
        elif kind == "LINE":
            a, b = entity.dxf.start, entity.dxf.end
            loose.append(line(a.x * unit, a.y * unit, b.x * unit, b.y * unit))
        elif kind == "ARC":
            c, first = entity.dxf.center, math.radians(entity.dxf.start_angle)
            turn = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0)
            loose.append(arc(c.x * unit, c.y * unit, entity.dxf.radius * unit, first, turn))
        elif kind == "LWPOLYLINE":
            corners = [(x * unit, y * unit, bulge) for x, y, bulge in entity.get_points("xyb")]
            edges = _polyline(corners, entity.closed)
            if entity.closed:
                loops.append(Outline.from_edges(edges))
            else:
                loose.append(edges)
        else:
            cure = "draw sections with lines, arcs, circles and polylines"
            raise InputError(place, f'"{path.name}" holds a {kind}', cure)
    loops += _chained(loose, place)
    if not loops:
        raise InputError(place, f'"{path.name}" has no closed loop', "draw the section's outline")
    return Section.drawn(path.name, [Part(_nested(loops))])


def _polyline(corners: list[tuple[float, float, float]], closed: bool) -> list[Edge]:
    edges: list[Edge] = []
    following = [*corners[1:], corners[0]] if closed else corners[1:]
    for (x0, y0, bulge), (x1, y1, _) in zip(corners, following, strict=False):
        if x0 == x1 and y0 == y1:
            continue
        if bulge == 0.0:
            edges += line(x0, y0, x1, y1)
            continue
        # The bulge is the tangent of a quarter of the swept angle.
        off = (1.0 - bulge * bulge) / (4.0 * bulge)
        cx, cy = 0.5 * (x0 + x1) - off * (y1 - y0), 0.5 * (y0 + y1) + off * (x1 - x0)
        edges += arc(cx, cy, math.hypot(x0 - cx, y0 - cy), math.atan2(y0 - cy, x0 - cx), 4.0 * math.atan(bulge))
    return edges


def _chained(pieces: Iterable[list[Edge]], place: str) -> list[Outline]:
    """Loops from curves that meet end to end, in any order and direction."""
    rest = [Outline.from_edges(edges) for edges in pieces]
    loops = []
    while rest:
        chain = rest.pop()
        begin, end = chain.ends[0][0], chain.ends[1][-1]
        size = max(float(np.ptp(np.concatenate(chain.ends), axis=0).max()), 1e-9)
        while np.hypot(*(end - begin)) > 1e-6 * size:
            for i, piece in enumerate(rest):
                first, last = piece.ends[0][0], piece.ends[1][-1]
                if np.hypot(*(first - end)) <= 1e-6 * size or np.hypot(*(last - end)) <= 1e-6 * size:
                    forward = np.hypot(*(first - end)) <= 1e-6 * size
                    chain, end = chain + (piece if forward else piece.reversed()), last if forward else first
                    del rest[i]
                    size = max(size, float(np.ptp(np.concatenate(chain.ends), axis=0).max()))
                    break
            else:
                x, y = end.tolist()
                where = f"({x * 1e3:.6g}, {y * 1e3:.6g}) mm"
                raise InputError(place, f"the outline is open at {where}", "close it there")
        loops.append(chain)
    return loops


def _nested(loops: list[Outline]) -> Outline:
    """Loops turned so that those within an even number of others are solid."""
    from capacity.tessellation import polygon_of

    upright = [loop if loop.moments()[0] > 0.0 else loop.reversed() for loop in loops]
    regions = [polygon_of(loop) for loop in upright]
    whole: Outline | None = None
    for i, loop in enumerate(upright):
        inside = regions[i].representative_point()
        depth = sum(
            j != i and region.area > regions[i].area and region.contains(inside) for j, region in enumerate(regions)
        )
        turned = loop if depth % 2 == 0 else loop.reversed()
        whole = turned if whole is None else whole + turned
    assert whole is not None  # the caller has at least one loop
    return whole


def section_from_sectionproperties(source: Any, scale: float = 1e-3) -> Section:
    """The section that a `sectionproperties` geometry or section describes, with its materials.

    Parameters
    ----------
    source : sectionproperties Geometry, CompoundGeometry or Section
    scale : float
        Metres in its unit of length, mm by default; forces are taken in N, so that stresses are in N per unit squared,
        and masses in kg.

    Raises
    ------
    InputError
        When it is none of these.
    """
    geometry = getattr(source, "geometry", source)
    pieces = getattr(geometry, "geoms", [geometry])
    if not all(hasattr(piece, "geom") and hasattr(piece, "material") for piece in pieces):
        kind = type(source).__name__
        raise InputError("section", f"a {kind} is no section of sectionproperties", "hand over a Geometry or Section")
    parts = []
    for piece in pieces:
        material = None if piece.material.name == "default" else _material(piece.material, scale)
        for polygon in getattr(piece.geom, "geoms", [piece.geom]):
            outline = _ring(polygon.exterior, scale, solid=True)
            for hole in polygon.interiors:
                outline = outline + _ring(hole, scale, solid=False)
            parts.append(Part(outline, material=material))
    return Section.drawn("sectionproperties", parts)


def _ring(ring: Any, scale: float, solid: bool) -> Outline:
    outline = Outline.polygon([(x * scale, y * scale) for x, y, *_ in ring.coords[:-1]])
    return outline if (outline.moments()[0] > 0.0) == solid else outline.reversed()


def _material(source: Any, scale: float) -> Material:
    return checked(
        Material(
            source.name,
            youngs_modulus=source.elastic_modulus / scale**2,
            yield_stress=source.yield_strength / scale**2,
            density=source.density / scale**3,
            poissons_ratio=source.poissons_ratio,
        ),
        f'material "{source.name}"',
    )
