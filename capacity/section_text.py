"""Section texts such as ``"rectangle 50x100 mm"``, ``"IPE 300"`` or ``"IPE 300 + rectangle 200x20 mm at 0,160 mm"``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from capacity import catalogue, shapes
from capacity.built_up import Piece, built_up
from capacity.errors import InputError
from capacity.materials import parse_material
from capacity.sections import Section
from capacity.units import length_unit, to_si


@dataclass(frozen=True)
class _Shape:
    counts: tuple[int, ...]
    build: Callable[..., Section]
    example: str
    may_be_zero: int = 99  # dimensions from this one on are radii, which may be zero


def _angle(*sizes: float) -> Section:
    """Standard sizes without radii given are the rolled ones: an angle is never sharp."""
    h, b, t = sizes[:3]
    rolled = catalogue.entries().get(f"L{h * 1e3:g}X{b * 1e3:g}X{t * 1e3:g}") if len(sizes) == 3 else None
    return rolled.section() if rolled else shapes.angle(*sizes)


def _square_hollow(a: float, t: float, *more: float) -> Section:
    """``SHS 100x5 mm``; the side may be said twice, as in ``SHS 100x100x5 mm``."""
    t, *radii = more if more and t == a else (t, *more)
    return shapes.rectangular_hollow(a, a, t, *radii)


_SHAPES = {
    "rectangle": _Shape((2,), shapes.rectangle, "rectangle 50x100 mm"),
    "circle": _Shape((1,), shapes.circle, "circle 80 mm"),
    "chs": _Shape((2,), shapes.circular_hollow, "CHS 168.3x8 mm"),
    "rhs": _Shape((3, 4, 5), shapes.rectangular_hollow, "RHS 200x100x8 mm", 3),
    "shs": _Shape((2, 3, 4, 5), _square_hollow, "SHS 100x5 mm", 2),
    "i": _Shape((4, 5), shapes.i_section, "I 300x150x7.1x10.7 mm", 4),
    "mi": _Shape((6, 7), shapes.mono_symmetric_i, "MI 300x150x10x100x8x7 mm", 6),
    "u": _Shape((4, 5, 6), shapes.channel, "U 200x80x6x11 mm", 4),
    "t": _Shape((4, 5), shapes.tee, "T 150x150x7.1x10.7 mm", 4),
    "l": _Shape((3, 4, 5), _angle, "L 100x100x10 mm", 3),
}
_WORDS = {"h": "i", "tee": "t", "channel": "u", "angle": "l", "rect": "rectangle", "pfc": "u"}

_SIZES = re.compile(r"^\s*([A-Za-z]+)\s+([-+0-9.eE]+(?:\s*[xX×]\s*[-+0-9.eE]+)*)\s*([A-Za-z]+)?(.*)$")
_FILES = (".msh", ".vtk", ".vtu", ".inp", ".xdmf", ".mesh", ".off", ".obj", ".stl", ".med", ".dxf")
_POINT = r"[-+0-9.eE]+\s*,\s*[-+0-9.eE]+"


def parse_section(text: str, place: str = "section") -> Section:
    """The section that ``text`` names.

    Parameters
    ----------
    text : str
        A shape with dimensions: ``"rectangle 100x200 mm"`` (b × h), ``"circle 80 mm"``, ``"CHS 168.3x8 mm"``,
        ``"RHS 200x100x8 mm"`` (h × b × t, then outer and inner radius), ``"SHS 100x5 mm"``,
        ``"I 300x150x7.1x10.7 mm"`` (h × b × tw × tf, then the root radius), ``"MI h x b1 x t1 x b2 x t2 x tw"`` with
        unequal flanges (upper, lower), ``"U 200x75x8.5x11.5x11.5x6 mm slope 8%"`` (h × b × tw × tf, root and toe
        radius), ``"T 150x150x7.1x10.7 mm"``, ``"L 100x75x8 mm"`` (h × b × t, root and toe radius; a standard size
        without radii is the rolled one); ``"polygon 0,0 100,0 100,60 0,60 hole 20,20 40,20 40,40 mm"``; a name of the
        catalogue (``"IPE 300"``); a path of a mesh or a DXF drawing, with its unit (``"part.msh mm"``; a mesh without
        one is in m, a drawing in its own); or several of these, joined by `` + `` and
        `` - ``, each followed by any of ``at x,y mm`` (the origin of its drawing, see `shapes`), ``rotated 90 deg``,
        ``mirrored``, ``of S355``.
    place : str
        Where the text stands, for messages.

    Raises
    ------
    InputError
        For an unknown shape or name, wrong dimensions, a unit that does not fit, or geometry that cannot be.
    """
    words = re.split(r"\s+([+-])\s+", text.strip())
    if len(words) == 1 and not re.search(r"\s(at|rotated|mirrored|of)\b", text):
        return _single(text, place)
    signs = ["+", *words[1::2]]
    pieces = [_piece(piece, sign == "-", place) for piece, sign in zip(words[0::2], signs, strict=True)]
    try:
        return built_up(pieces, text.strip())
    except ValueError as error:
        raise InputError(place, f'"{text}": {error}', "move or resize that piece") from error


def _piece(text: str, hole: bool, place: str) -> Piece:
    """One piece of a built-up section with where it lies and what it is made of."""
    match = re.match(r"^(.*?)((?:\s+(?:at|rotated|mirrored|of)\b.*)?)$", text)
    assert match is not None  # the expression matches any line
    section, rest = _single(match[1], place), match[2]
    at, angle, mirrored, material = (0.0, 0.0), 0.0, False, None
    for word, value in re.findall(
        r"\b(at|rotated|mirrored|of)\b\s*(.*?)\s*(?=$|\bat\b|\brotated\b|\bmirrored\b|\bof\b)", rest
    ):
        if word == "at":
            point = re.fullmatch(rf"({_POINT})\s*([A-Za-z]+)", value)
            if point is None:
                raise InputError(place, f'"{text}": "{value}" is no place', 'write "at 0,160 mm"')
            scale = length_unit(point[2], place)
            x, y = _point(point[1], text, place)
            at = (x * scale, y * scale)
        elif word == "rotated":
            angle = to_si(value, "angle", f"{place} > rotated")
        elif word == "mirrored":
            mirrored = True
        else:
            material = parse_material(value, f"{place} > of")
    return Piece(section, at, angle, mirrored, material, hole)


def _single(text: str, place: str) -> Section:
    named = catalogue.entries().get(catalogue.key(text))
    if named is not None:
        return named.section()
    file = re.fullmatch(r"\s*(.*?\.\w+)(?:\s+([A-Za-z]+))?\s*", text)
    if file and file[1].lower().endswith(_FILES):
        return _from_file(Path(file[1]), length_unit(file[2], place) if file[2] else None, place)
    if text.split()[:1] == ["polygon"]:
        return _polygon(text, place)
    match = _SIZES.match(text)
    word = match[1].lower() if match else ""
    word = _WORDS.get(word, word)
    if match is None or word not in _SHAPES:
        raise InputError(place, f'"{text}" is no known section', _suggestion(text))
    shape, unit, rest = _SHAPES[word], match[3], match[4].strip()
    example = f'write "{shape.example}"'
    values = [_number(part, text, place, example) for part in re.split(r"\s*[xX×]\s*", match[2])]
    if len(values) not in shape.counts:
        counts = " or ".join(str(count) for count in shape.counts)
        raise InputError(place, f'"{text}" has {len(values)} dimensions instead of {counts}', example)
    if unit is None:
        near = catalogue.nearest(text)
        cure = f"did you mean {', '.join(near)}? Or {example}" if near else example
        raise InputError(place, f'"{text}" has no unit of length', cure)
    for i, value in enumerate(values):
        if value < 0.0 or (value == 0.0 and i < shape.may_be_zero):
            raise InputError(place, f'"{text}" has a dimension that is not greater than zero', example)
    scale = length_unit(unit, place)
    sizes = [value * scale for value in values]
    build = shape.build
    if rest:
        slope = re.fullmatch(r"slope\s+(.+)", rest)
        if slope is None or word != "u":
            raise InputError(place, f'"{text}" goes on with "{rest}" after the dimensions', example)
        share = to_si(slope[1], "number", f"{place} > slope")
        sizes += [0.0] * (6 - len(sizes)) + [share]
    try:
        return build(*sizes)
    except ValueError as error:
        raise InputError(place, f'"{text}": {error}', f'write dimensions such as "{shape.example}"') from error


def _polygon(text: str, place: str) -> Section:
    example = 'write "polygon 0,0 100,0 100,60 0,60 hole 20,20 40,20 40,40 mm"'
    body = re.fullmatch(rf"polygon\s+((?:{_POINT}\s+|hole\s+)+)([A-Za-z]+)", text.strip())
    if body is None:
        raise InputError(place, f'"{text}" is no polygon', example)
    scale = length_unit(body[2], place)
    rings = [
        [(x * scale, y * scale) for x, y in (_point(p, text, place) for p in re.findall(_POINT, ring))]
        for ring in body[1].split("hole")
    ]
    try:
        return shapes.polygon(rings[0], rings[1:], text.strip())
    except ValueError as error:
        raise InputError(place, f'"{text}": {error}', example) from error


def _from_file(path: Path, scale: float | None, place: str) -> Section:
    if not path.is_file():
        raise InputError(place, f'there is no file "{path}"', "write the path of a mesh or a DXF drawing")
    if path.suffix.lower() == ".dxf":
        from capacity.drawing_section import section_from_dxf

        return section_from_dxf(path, scale, place)
    from capacity.mesh_section import section_from_mesh

    return section_from_mesh(path, 1.0 if scale is None else scale, place)


def _point(text: str, whole: str, place: str) -> tuple[float, float]:
    x, y = (_number(part.strip(), whole, place, 'write points such as "0,160"') for part in text.split(","))
    return x, y


def _number(part: str, text: str, place: str, cure: str) -> float:
    try:
        value = float(part)
    except ValueError as error:
        raise InputError(place, f'"{text}": "{part}" is not a number', cure) from error
    if not math.isfinite(value):
        raise InputError(place, f'"{text}": "{part}" is not a finite number', cure)
    return value


def _suggestion(text: str) -> str:
    near = catalogue.nearest(text)
    known = ", ".join(f'"{shape.example}"' for shape in _SHAPES.values())
    return (f"did you mean {', '.join(near)}? Or " if near else "") + f'write {known}, or a name such as "IPE 300"'
