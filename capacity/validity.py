"""Polygons that enclose what they seem to: no crossing, no zero area, every hole inside. Checked with shapely."""

from __future__ import annotations

from collections.abc import Sequence

Vertices = Sequence[tuple[float, float]]


def check_polygon(exterior: Vertices, holes: Sequence[Vertices]) -> None:
    """Nothing, when the polygon is sound.

    Raises
    ------
    ValueError
        For a boundary with fewer than three corners, one that crosses itself or encloses nothing, and for a hole that
        is not inside or crosses another; the place is named in mm.
    """
    from shapely import Polygon

    whole = _ring("outline", exterior)
    cut: list[Polygon] = []
    for number, vertices in enumerate(holes, start=1):
        hole = _ring(f"hole {number}", vertices)
        if not whole.contains(hole) or whole.exterior.intersection(hole).length > 0.0:
            x, y = hole.difference(whole).representative_point().coords[0] if not whole.covers(hole) else vertices[0]
            raise ValueError(f"hole {number} is not inside the outline, see ({x * 1e3:.6g}, {y * 1e3:.6g}) mm")
        for other, earlier in enumerate(cut, start=1):
            if hole.intersects(earlier):
                x, y = hole.intersection(earlier).representative_point().coords[0]
                raise ValueError(f"holes {other} and {number} meet at ({x * 1e3:.6g}, {y * 1e3:.6g}) mm")
        cut.append(hole)


def _ring(what: str, vertices: Vertices):  # type: ignore[no-untyped-def]  # shapely comes without types
    from shapely import Polygon
    from shapely.validation import explain_validity

    if len(vertices) < 3:
        raise ValueError(f"the {what} has {len(vertices)} corners; three are the least")
    for i, (a, b) in enumerate(zip(vertices, [*vertices[1:], vertices[0]], strict=True), start=1):
        if a == b:
            raise ValueError(f"corners {i} and {i % len(vertices) + 1} of the {what} coincide, at {_mm(a)}")
    scaled = Polygon([(x * 1e3, y * 1e3) for x, y in vertices])
    if scaled.convex_hull.area <= 1e-12 * scaled.length**2:
        raise ValueError(f"the {what} encloses nothing, see corner 1 at {_mm(vertices[0])}")
    fault, _, place = explain_validity(scaled).partition("[")
    if fault == "Self-intersection" or "Ring Self" in fault:
        raise ValueError(f"the {what} crosses itself at ({place.rstrip(']').replace(' ', ', ')}) mm")
    if fault != "Valid Geometry":
        raise ValueError(f"the {what} encloses nothing, see corner 1 at {_mm(vertices[0])}")
    return Polygon(vertices)


def _mm(point: tuple[float, float]) -> str:
    return f"({point[0] * 1e3:.6g}, {point[1] * 1e3:.6g}) mm"
