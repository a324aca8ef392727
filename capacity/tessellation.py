"""Outlines as shapely polygons, where whether pieces overlap or how far they erode is asked, and no more."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from capacity.outline import Outline


def polygon_of(outline: Outline, chords: int = 64) -> Any:
    """The enclosed region as a shapely geometry, arcs as chords of a circle of ``chords`` sides."""
    from shapely import polygonize
    from shapely.geometry import LineString
    from shapely.ops import unary_union

    lines = []
    for i in range(len(outline.radius)):
        turn = abs(float(outline.sweep[i]))
        count = 1 if outline.radius[i] == 0.0 else max(1, math.ceil(turn * chords / (2.0 * math.pi)))
        x, y, _ = outline.coordinates(np.array([i]), np.linspace(0.0, 1.0, count + 1)[None, :])
        # Rounded so that edges that meet do so exactly.
        points = np.round(np.column_stack([x[0], y[0]]), 10)
        if len(np.unique(points, axis=0)) > 1:
            lines.append(LineString(points))
    faces = polygonize([unary_union(lines)])
    inside = []
    for face in faces.geoms:
        point = face.representative_point()
        if winding(outline, point.x, point.y) > 0.5:
            inside.append(face)
    return unary_union(inside)


def winding(outline: Outline, x: float, y: float) -> float:
    """How often the boundary goes round (x, y): chords to its right, rising less falling."""
    at, edge, t, rises = outline.crossings(np.array([y]))
    del at
    right = outline.coordinates(edge, t[:, None])[0][:, 0] > x
    return float(np.sum(np.where(rises, 1.0, -1.0)[right]))
