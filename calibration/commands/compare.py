"""``ductile compare``: what changed between two calibrations."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from calibration.commands.options import Json, share

if TYPE_CHECKING:
    from calibration.comparison import Comparison


def compare(before: Path, after: Path, /, *, tolerance: str = "0.1 %", as_json: Json = False) -> int:
    """Say what changed between two calibrations; exit status 1 when an error grew past the tolerance.

    Parameters
    ----------
    before, after
        The calibration.json of two runs of `ductile calibrate`.
    tolerance
        By how much an error may grow, as a share of what it is a share of ("0.1 %").
    """
    from calibration.comparison import compare_calibrations, read_calibration

    allowed = share(tolerance, "--tolerance")
    found = compare_calibrations(read_calibration(before), read_calibration(after), allowed)
    if as_json:
        print(json.dumps(found.plain()))
    else:
        _print(found, Console(highlight=False))
    return 1 if found.grown else 0


def _print(found: Comparison, console: Console) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    if found.grown:
        names = ", ".join(change.name for change in found.grown)
        console.print(f"Grown by more than {100 * found.tolerance:.3g} %: {names}", style="bold red", soft_wrap=True)
    else:
        console.print(f"No error grew by more than {100 * found.tolerance:.3g} %.", style="bold green")
    if not found.changes:
        console.print("Nothing changed.")
        return
    table = Table(box=SIMPLE_HEAD)
    for heading in ("what", "before", "after", "after / before"):
        table.add_column(heading, justify="left" if heading == "what" else "right", overflow="fold")
    for change in found.changes:
        ratio = "" if change.ratio is None else f"{change.ratio:.3g}"
        style = "red" if change in found.grown else ""
        table.add_row(
            change.name, _shown(change.before, change.part), _shown(change.after, change.part), ratio, style=style
        )
    console.print(table)


def _shown(value: Any, part: str) -> str:
    if value is None:
        return "–"
    if isinstance(value, float):
        return f"{100 * value:.3f} %" if part in ("errors", "target") else f"{value:.6g}"
    return str(value)
