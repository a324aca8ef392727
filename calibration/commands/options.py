"""What several commands take, and how it is read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from capacity.errors import InputError

Json = Annotated[bool, Parameter(name="--json", negative=())]
Folder = Annotated[Path | None, Parameter(name=["-o", "--output"])]


def share(text: str, option: str) -> float:
    """A share above 0 and below 1 from text such as "1 %" or "0.003" [-]."""
    from capacity.units import positive

    value = positive(text, "number", option)
    if value >= 1.0:
        raise InputError(option, f'"{text}" is not below 100 %', 'write a share such as "1 %"')
    return value
