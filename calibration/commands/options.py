"""What several commands take, said once, and how it is read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token

from capacity.errors import InputError


def _whole(kind: type, tokens: Sequence[Token]) -> int:  # noqa: ARG001
    """A whole number from what stands on the command line; "2.5" is none, where it would be cut to 2."""
    text = tokens[0].value
    if not text.strip().removeprefix("-").isdecimal():
        raise ValueError(f'"{text}" is no whole number')
    return int(text)


WholeNumber = Annotated[int, Parameter(converter=_whole)]
SceneName = Annotated[str, Parameter(help="A TOML file, or the name of a built-in scene.")]
Json = Annotated[
    bool, Parameter(name="--json", negative=(), help="Print one JSON object, in SI units, in place of tables.")
]
Folder = Annotated[Path | None, Parameter(name=["-o", "--output"], help="Folder for the files; out/SCENE by default.")]


def share(text: str, option: str) -> float:
    """A share above 0 and below 1 from text such as "1 %" or "0.003" [-]."""
    from capacity.units import positive

    value = positive(text, "number", option)
    if value >= 1.0:
        raise InputError(option, f'"{text}" is not below 100 %', 'write a share such as "1 %"')
    return value


def at_least(value: int, least: int, option: str) -> int:
    """``value``, unless it is less than ``least``."""
    if value < least:
        raise InputError(option, f"{value} is too few", f"write {least} or more")
    return value
