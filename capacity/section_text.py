"""Section texts such as ``"rectangle 50x100 mm"`` or ``"IPE 300"`` to sections."""

import csv
import difflib
import re
from collections.abc import Callable
from functools import cache, partial
from importlib import resources

from capacity import sections
from capacity.errors import InputError
from capacity.sections import Section
from capacity.units import length_unit

# Word, dimensions in the order written, constructor, an example for messages.
_SHAPES: dict[str, tuple[int, Callable[..., Section], str]] = {
    "rectangle": (2, lambda b, h: sections.rectangle(b, h), "rectangle 50x100 mm"),
    "circle": (1, sections.circle, "circle 80 mm"),
    "chs": (2, sections.circular_hollow, "CHS 168.3x8 mm"),
    "rhs": (3, sections.rectangular_hollow, "RHS 200x100x8 mm"),
    "i": (4, sections.i_section, "I 300x150x7.1x10.7 mm"),
}

_TEXT = re.compile(r"^\s*([A-Za-z]+)\s+([-+0-9.eE]+(?:\s*[xX×]\s*[-+0-9.eE]+)*)\s*([A-Za-z]+)?\s*$")


def parse_section(text: str, place: str = "section") -> Section:
    """The section that ``text`` names.

    Parameters
    ----------
    text : str
        A shape with dimensions (``"rectangle 100x200 mm"`` is b × h, ``"circle 80 mm"``, ``"CHS 168.3x8 mm"``,
        ``"RHS 200x100x8 mm"`` is h × b × t, ``"I 300x150x7.1x10.7 mm"`` is h × b × tw × tf and an optional root
        radius) or a name from the catalogue (``"IPE 300"``).
    place : str
        Where the text stands, for messages.

    Raises
    ------
    InputError
        For an unknown shape or name, wrong dimensions or a unit that does not fit.
    """
    named = _catalogue().get(_key(text))
    if named is not None:
        return named()
    match = _TEXT.match(text)
    if match is None or match[1].lower() not in _SHAPES:
        raise InputError(place, f'"{text}" is no known section', _suggestion(text))
    word, numbers, unit = match[1].lower(), match[2], match[3]
    count, build, example = _SHAPES[word]
    values = [_number(part, text, place, example) for part in re.split(r"\s*[xX×]\s*", numbers)]
    optional = 1 if word == "i" else 0
    if not count <= len(values) <= count + optional:
        raise InputError(place, f'"{text}" has {len(values)} dimensions instead of {count}', f'write "{example}"')
    if unit is None:
        raise InputError(place, f'"{text}" has no unit of length', f'write "{example}"')
    for value in values:
        if value <= 0.0:
            raise InputError(place, f'"{text}" has a dimension that is not greater than zero', f'write "{example}"')
    scale = length_unit(unit, place)
    try:
        return build(*(value * scale for value in values))
    except ValueError as error:
        raise InputError(place, f'"{text}": {error}', f'write dimensions such as "{example}"') from error


def _number(part: str, text: str, place: str, example: str) -> float:
    try:
        return float(part)
    except ValueError as error:
        raise InputError(place, f'"{text}": "{part}" is not a number', f'write "{example}"') from error


def _key(text: str) -> str:
    return re.sub(r"\s+", "", text).upper()


@cache
def _catalogue() -> dict[str, Callable[[], Section]]:
    """Catalogue names (no spaces, upper case) to constructors; dimensions in mm in the data file."""
    table: dict[str, Callable[[], Section]] = {}
    with resources.files("capacity").joinpath("data/i_sections.csv").open(encoding="utf-8") as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            sizes = [float(row[key]) * 1e-3 for key in ("h", "b", "tw", "tf", "r")]
            table[_key(row["name"])] = partial(_from_catalogue, row["name"], sizes)
    return table


def _from_catalogue(name: str, sizes: list[float]) -> Section:
    return sections.i_section(*sizes).renamed(name)


def _suggestion(text: str) -> str:
    near = difflib.get_close_matches(_key(text), _catalogue(), n=3, cutoff=0.6)
    shapes = ", ".join(f'"{example}"' for _, _, example in _SHAPES.values())
    return (f"did you mean {', '.join(near)}? Or " if near else "") + f'write {shapes}, or a name such as "IPE 300"'
