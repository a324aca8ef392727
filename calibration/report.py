"""The report on the terminal and as Markdown."""

from __future__ import annotations

from collections.abc import Iterable

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from calibration.export import versions
from calibration.tables import WRAPPED, Sheet, sheets, verdict
from calibration.tuning import Calibration

#: Rows of a table on the terminal; files hold them all.
_SHOWN = 14


def print_report(result: Calibration, console: Console) -> None:
    """The verdict first, then capacities, joints, errors, and speed against error."""
    head, text = verdict(result)
    line = Text(f"{head}. ", "bold green" if result.target_met else "bold red")
    console.print(line.append(text, "default not bold"))
    if result.limit:
        console.print(f"What limits it: {result.limit}.", style="red")
    for sheet in sheets(result):
        console.print(_table(sheet))


def _table(sheet: Sheet) -> Table:
    # What was tried last is what matters; of all else, the beginning.
    start = max(0, len(sheet.rows) - _SHOWN) if sheet.marked >= 0 else 0
    start = min(start, max(sheet.marked, 0))
    shown = sheet.rows[start : start + _SHOWN]
    left = f" ({len(shown)} of {len(sheet.rows)} rows)" if len(shown) < len(sheet.rows) else ""
    table = Table(title=f"{sheet.title}{left}", title_justify="left", box=SIMPLE_HEAD)
    columns = [i for i, head in enumerate(sheet.heads) if head not in sheet.wide]
    for i in columns:
        words = sheet.heads[i].startswith("<")
        table.add_column(
            sheet.heads[i].lstrip("<"), justify="left" if words else "right", no_wrap=sheet.heads[i] not in WRAPPED
        )
    for k, row in enumerate(shown, start):
        table.add_row(*(row[i] for i in columns), style="bold" if k == sheet.marked else "")
    return table


def report_markdown(result: Calibration) -> str:
    """The report as Markdown text."""
    head, text = verdict(result)
    lines = [f"# Calibration: {result.scene.title}", "", f"Scene `{result.name}`.", "", f"**{head}.** {text}", ""]
    if result.limit:
        lines += [f"What limits it: {result.limit}.", ""]
    for sheet in sheets(result):
        lines += [f"## {sheet.title}", ""]
        if sheet.note:
            lines += [sheet.note, ""]
        lines.append(_row(head.lstrip("<") for head in sheet.heads))
        lines.append(_row("---" if head.startswith("<") else "---:" for head in sheet.heads))
        for i, row in enumerate(sheet.rows):
            lines.append(_row(f"**{cell}**" if i == sheet.marked else cell for cell in row))
        lines.append("")
    lines.append("Made with " + ", ".join(f"{name} {number}" for name, number in versions().items()) + ".")
    return "\n".join(lines) + "\n"


def _row(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
