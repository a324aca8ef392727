"""Numbers, comments and templates for the files that are handed over."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

_WIDTH = 110


def number(value: float | None, infinite: str = "math.inf") -> str:
    """``value`` with nine digits, enough for any engine; ``infinite`` where nothing limits it."""
    if value is None:
        return "None"
    if math.isinf(value):
        return infinite
    text = f"{value:.9g}"
    return text if set(text) & set(".en") else f"{text}.0"


def comment(notes: Sequence[str], prefix: str = "") -> str:
    """``notes`` as a block of wrapped lines that begin with ``prefix``."""
    lines = [line for note in notes for line in textwrap.wrap(note, _WIDTH - len(prefix))]
    return "\n".join(f"{prefix}{line}" for line in lines)


def render(template: str, **values: Any) -> str:
    """The template of that name under ``templates/engines``, filled in."""
    environment = Environment(
        loader=PackageLoader("calibration", "templates/engines"),
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    environment.filters |= {"num": number, "pyrepr": repr}
    return environment.get_template(template).render(**values)
