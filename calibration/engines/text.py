"""Numbers, comments and templates for the files that are handed over."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from functools import partial
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

_WIDTH = 110


def number(value: float | None, infinite: str = "math.inf", suffix: str = "") -> str:
    """``value`` with nine digits, enough for any engine; ``infinite`` where nothing limits it."""
    if value is None:
        return "None"
    if math.isinf(value):
        return infinite
    text = f"{value:.9g}"
    return (text if set(text) & set(".e") else f"{text}.0") + suffix


def comment(notes: Sequence[str], prefix: str) -> str:
    """``notes`` as wrapped lines that begin with ``prefix``."""
    lines = [line for note in notes for line in textwrap.wrap(note, _WIDTH - len(prefix))]
    return "\n".join(f"{prefix}{line}" for line in lines)


def render(template: str, infinite: str, suffix: str = "", **values: Any) -> str:
    """The template of that name under ``templates/engines``, its numbers in the language's own way."""
    environment = Environment(
        loader=PackageLoader("calibration", "templates/engines"),
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    environment.filters |= {
        "num": partial(number, infinite=infinite, suffix=suffix),
        "quoted": repr,
        "deg": math.degrees,
    }
    return environment.get_template(template).render(**values)
