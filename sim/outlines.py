"""What a recording keeps of the shapes of a body."""

from __future__ import annotations

import numpy as np
import pymunk
import shapely

from sim.recorded import Outline

# Corners of neighbouring blocks that are nearer than this are one [m].
_SEAM = 1e-6


def outlines_of(body: pymunk.Body) -> tuple[Outline, ...]:
    """The shapes of ``body`` as they are now; sharp polygons of a static one that meet are drawn as one."""
    outlines = [_outline(shape) for shape in body.shapes]
    if body.body_type != pymunk.Body.STATIC:
        return tuple(outlines)
    sharp = [outline.kind == "polygon" and outline.radius == 0.0 for outline in outlines]
    others = [outline for outline, merged in zip(outlines, sharp, strict=True) if not merged]
    return (*_merged([outline for outline, merged in zip(outlines, sharp, strict=True) if merged]), *others)


def _merged(blocks: list[Outline]) -> list[Outline]:
    """``blocks`` without the seams between them, unless they enclose a hole, which an outline cannot say."""
    whole = shapely.union_all([shapely.Polygon(block.points) for block in blocks], grid_size=_SEAM)
    parts = [part for part in shapely.get_parts(whole) if isinstance(part, shapely.Polygon)]
    if any(part.interiors for part in parts):
        return blocks
    return [Outline("polygon", np.array(part.exterior.coords[:-1]), 0.0) for part in parts]


def _outline(shape: pymunk.Shape) -> Outline:
    if isinstance(shape, pymunk.Circle):
        return Outline("circle", np.array([shape.offset]), shape.radius)
    if isinstance(shape, pymunk.Segment):
        return Outline("segment", np.array([shape.a, shape.b]), shape.radius)
    assert isinstance(shape, pymunk.Poly)
    return Outline("polygon", np.array(shape.get_vertices()), shape.radius)
