"""A report before it is laid out: what the terminal, Markdown and HTML all say."""

from __future__ import annotations

from dataclasses import dataclass

from matplotlib.figure import Figure

#: Heads of columns whose words may take several lines.
WRAPPED = ("<why", "<model", "<kind", "<remark")


@dataclass(frozen=True)
class Sheet:
    """A table.

    Attributes
    ----------
    title, note : str
    heads : tuple of str
        Of the columns; those whose values are words begin with "<".
    rows : tuple of tuple of str
    marked : int
        The row that matters most; -1 for none.
    wide : tuple of str
        Heads of columns that a narrow terminal goes without.
    """

    title: str
    note: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    marked: int = -1
    wide: tuple[str, ...] = ()


@dataclass(frozen=True)
class Picture:
    """A figure with what it is called and what it shows."""

    title: str
    figure: Figure
    caption: str


@dataclass(frozen=True)
class Report:
    """A report.

    Attributes
    ----------
    kind, title, scene : str
        Such as ``"Calibration"``; what the scene is called in it, and by whoever asked.
    met : bool
        Whether what was asked for is reached.
    verdict : (str, str)
        That in a few words, and what reaches it.
    limit : str
        What keeps it from being reached; empty when it is.
    remarks : tuple of str
        What to mind.
    sheets : tuple of Sheet
    pictures : tuple of Picture
        The first before the tables, the others behind them.
    """

    kind: str
    title: str
    scene: str
    met: bool
    verdict: tuple[str, str]
    limit: str
    remarks: tuple[str, ...]
    sheets: tuple[Sheet, ...]
    pictures: tuple[Picture, ...]


def percent(share: float, digits: int = 3) -> str:
    """A share as text."""
    return f"{100.0 * share:.{digits}g} %"
