"""Sections put together from others: joined, cut out, turned, mirrored, of several materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from capacity.materials import Material
from capacity.outline import Outline
from capacity.paths import line
from capacity.sections import Part, Section


@dataclass(frozen=True)
class Piece:
    """A section in its place within a built-up one.

    Attributes
    ----------
    section : Section
    at : (float, float)
        Where the origin of its drawing lies: the lower left corner of most shapes, the centre of a circle, the back of
        a channel's web at mid-height (`shapes`) [m].
    angle : float
        Turned counter-clockwise about that origin [rad].
    mirrored : bool
        Mirrored first, x → -x.
    material : Material, optional
        What it is made of, when it is not what the whole is made of.
    hole : bool
        Cut out of the pieces instead of joined to them.
    """

    section: Section
    at: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0
    mirrored: bool = False
    material: Material | None = None
    hole: bool = False

    def parts(self) -> list[Part]:
        """The parts of the section, in place."""
        section = self.section.mirrored() if self.mirrored else self.section
        section = section.rotated(self.angle)
        dx, dy = self.at[0] + section.centroid[0], self.at[1] + section.centroid[1]
        moved = [part.moved(lambda outline: outline.shifted(dx, dy)) for part in section.parts]
        return [replace(part, material=part.material or self.material) for part in moved]


def built_up(pieces: Sequence[Piece], name: str = "built-up") -> Section:
    """One section from several; they may touch, but not overlap, and a hole lies within one piece.

    A solid rectangle among others bears shear as a wall along its longer side: a cover plate does not carry the shear
    of the web.

    Raises
    ------
    ValueError
        When two pieces overlap or a hole is not inside a piece; the piece and the place are named.
    """
    solids = [piece for piece in pieces if not piece.hole]
    holes = [piece for piece in pieces if piece.hole]
    parts = [part for piece in solids for part in piece.parts()]
    if len(solids) > 1:
        parts = [_as_wall(part) for part in parts]
    _check_overlap([(piece.section.name, part) for piece in solids for part in piece.parts()])
    for hole in holes:
        outline = hole.parts()[0].outline
        for part in hole.parts()[1:]:
            outline = outline + part.outline
        host = _host(outline, parts, hole.section.name)
        parts[host] = replace(parts[host], outline=parts[host].outline + outline.reversed())
    return Section.drawn(name, parts)


def _as_wall(part: Part) -> Part:
    """A solid rectangle with its centreline along the longer side; any other part as it is."""
    outline = part.outline
    if part.walls is not None or len(outline.radius) != 4 or outline.radius.any():
        return part
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = outline.corners().tolist()
    sides = ((x1 - x0) ** 2 + (y1 - y0) ** 2, (x2 - x1) ** 2 + (y2 - y1) ** 2)
    if sides[0] >= sides[1]:
        ends = ((x0 + x3) / 2, (y0 + y3) / 2, (x1 + x2) / 2, (y1 + y2) / 2)
    else:
        ends = ((x0 + x1) / 2, (y0 + y1) / 2, (x2 + x3) / 2, (y2 + y3) / 2)
    return replace(part, walls=Outline.from_edges(line(*ends)).scaled_weight(min(sides) ** 0.5))


def _check_overlap(named: Sequence[tuple[str, Part]]) -> None:
    if len(named) < 2:
        return
    from capacity.tessellation import polygon_of

    shapes = [(name, polygon_of(part.outline)) for name, part in named]
    for i, (name, shape) in enumerate(shapes):
        for other, earlier in shapes[:i]:
            common = shape.intersection(earlier)
            if common.area > 1e-5 * min(shape.area, earlier.area):
                x, y = common.representative_point().coords[0]
                where = f"({x * 1e3:.5g}, {y * 1e3:.5g}) mm"
                raise ValueError(f'"{other}" and "{name}" overlap at {where}')


def _host(hole: Outline, parts: Sequence[Part], name: str) -> int:
    from capacity.tessellation import polygon_of

    inner = polygon_of(hole)
    for i, part in enumerate(parts):
        if polygon_of(part.outline).contains(inner):
            return i
    x, y = inner.representative_point().coords[0]
    raise ValueError(f'hole "{name}" at ({x * 1e3:.5g}, {y * 1e3:.5g}) mm is not inside any piece')
