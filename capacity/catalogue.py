"""Standard sections by name, from the data files beside this one."""

from __future__ import annotations

import csv
import difflib
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from importlib import resources

from capacity import shapes
from capacity.errors import InputError
from capacity.sections import Section

_MM, _INCH = 1e-3, 0.0254


@dataclass(frozen=True)
class Entry:
    """One line of the catalogue.

    Attributes
    ----------
    name, family : str
        ``"IPE 300"`` of ``"IPE"``.
    dimensions : dict
        Tabulated dimensions by their symbols, in the unit of the data file.
    build : callable
        Makes the section.
    """

    name: str
    family: str
    dimensions: dict[str, float]
    build: Callable[[], Section]

    def section(self) -> Section:
        """The section, under its catalogue name."""
        return self.build().renamed(self.name)


def key(text: str) -> str:
    """A name without its spaces and case, as it is looked up; ``HE 200 B`` is HEB 200, ``SHS 100x100x5`` SHS 100x5."""
    plain = re.sub(r"\s+", "", text).upper().replace("×", "X")
    return re.sub(r"^SHS([\d.]+)X\1X", r"SHS\1X", re.sub(r"^HE(\d+)([ABM])$", r"HE\2\1", plain))


@cache
def entries() -> dict[str, Entry]:
    """Every catalogue section by `key` of its name, in the order of the data files."""
    return {
        key(entry.name): entry for rows in (_i_sections, _channels, _angles, _hollow, _w_shapes) for entry in rows()
    }


def families() -> list[str]:
    """Names of the families, such as ``"IPE"``."""
    return list(dict.fromkeys(entry.family for entry in entries().values()))


def family(name: str, place: str = "family") -> list[Entry]:
    """All sections of a family, in the order of the data file.

    Raises
    ------
    InputError
        When there is no such family; the nearest are named.
    """
    known = families()
    found = [entry for entry in entries().values() if key(entry.family) == key(name)]
    if not found:
        near = difflib.get_close_matches(name.upper(), known, n=3, cutoff=0.4) or known
        raise InputError(place, f'"{name}" is no family of the catalogue', f"write one of {', '.join(near)}")
    return found


def nearest(text: str, count: int = 3) -> list[str]:
    """Names of the catalogue that look most like ``text``."""
    wanted = _sizes(key(text))
    found = difflib.get_close_matches(key(text), entries(), n=20, cutoff=0.6)
    # Among names that look alike those of nearby sizes come first.
    found.sort(
        key=lambda name: (name[0] != key(text)[0], sum(abs(a - b) for a, b in zip(wanted, _sizes(name), strict=False)))
    )
    return [entries()[name].name for name in found[:count]]


def _sizes(name: str) -> list[float]:
    return [float(number) for number in re.findall(r"\d+(?:\.\d+)?", name)]


def _rows(file: str) -> Iterator[dict[str, str]]:
    with resources.files("capacity").joinpath(f"data/{file}").open(encoding="utf-8") as lines:
        yield from csv.DictReader(line for line in lines if not line.startswith("#"))


def _numbers(row: dict[str, str]) -> dict[str, float]:
    return {name: float(value) for name, value in row.items() if name != "name"}


def _i_sections() -> Iterator[Entry]:
    for row in _rows("i_sections.csv"):
        d = _numbers(row)
        sizes = [d[symbol] * _MM for symbol in ("h", "b", "tw", "tf", "r")]
        yield Entry(row["name"], row["name"].split()[0], d, partial(shapes.i_section, *sizes))


def _channels() -> Iterator[Entry]:
    for row in _rows("channels.csv"):
        d = _numbers(row)
        h, b, tw, tf, r1, r2, x_tf = (d[symbol] * _MM for symbol in ("h", "b", "tw", "tf", "r1", "r2", "x_tf"))
        yield Entry(
            row["name"],
            row["name"].split()[0],
            d,
            partial(shapes.tapered_channel, h, b, tw, tf, r1, r2, d["slope"], x_tf),
        )


def _angles() -> Iterator[Entry]:
    for row in _rows("angles.csv"):
        d = _numbers(row)
        a, t, r1 = (d[symbol] * _MM for symbol in ("a", "t", "r1"))
        yield Entry(row["name"], "L", d, partial(shapes.angle, a, a, t, r1, 0.5 * r1))


def corner_radii(standard: str, t: float) -> tuple[float, float]:
    """Outer and inner corner radius of a hollow section of wall ``t`` [m], for calculation.

    EN 10210-2:2006, Annex A, and EN 10219-2:2006, Annex B.
    """
    if standard == "EN 10210":
        return 1.5 * t, 1.0 * t
    if t <= 6.0 * _MM:
        return 2.0 * t, 1.0 * t
    return (2.5 * t, 1.5 * t) if t <= 10.0 * _MM else (3.0 * t, 2.0 * t)


def _hollow() -> Iterator[Entry]:
    for row in _rows("hollow_sections.csv"):
        standard, suffix = row["standard"], "" if row["standard"] == "EN 10210" else f" {row['standard']}"
        h = float(row["h"])
        for text in row["thicknesses"].split():
            t = float(text)
            if not row["b"]:
                tube = (h * _MM, t * _MM)
                yield Entry(f"CHS {h:g}x{text}", "CHS", {"d": h, "t": t}, partial(shapes.circular_hollow, *tube))
                continue
            b = float(row["b"])
            word = "SHS" if h == b else "RHS"
            sizes = f"{h:g}x{text}" if h == b else f"{h:g}x{b:g}x{text}"
            r_out, r_in = corner_radii(standard, t * _MM)
            box = (h * _MM, b * _MM, t * _MM, r_out, r_in)
            d = {"h": h, "b": b, "t": t, "r_out": r_out / _MM, "r_in": r_in / _MM}
            yield Entry(f"{word} {sizes}{suffix}", word, d, partial(shapes.rectangular_hollow, *box))


def _w_shapes() -> Iterator[Entry]:
    for row in _rows("w_shapes.csv"):
        d = _numbers(row)
        h, b, tw, tf, k = (d[symbol] * _INCH for symbol in ("d", "bf", "tw", "tf", "k_des"))
        yield Entry(row["name"], "W", d, partial(shapes.i_section, h, b, tw, tf, k - tf))
