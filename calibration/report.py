"""The report on the terminal and as Markdown."""

from __future__ import annotations

from collections.abc import Iterable

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from calibration.sheets import WRAPPED, Report, Sheet
from calibration.versions import versions

#: Rows of a table on the terminal; files hold them all.
_SHOWN = 14


def print_report(report: Report, console: Console) -> None:
    """The verdict first, then the tables."""
    head, text = report.verdict
    line = Text(f"{head}. ", "bold green" if report.met else "bold red")
    console.print(line.append(text, "default not bold"))
    if report.limit:
        console.print(f"What limits it: {report.limit}.", style="red")
    for remark in report.remarks:
        console.print(f"Mind: {remark}.", style="yellow")
    for sheet in report.sheets:
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


def report_markdown(report: Report) -> str:
    """The report as Markdown text."""
    head, text = report.verdict
    lines = [f"# {report.kind}: {report.title}", "", f"Scene `{report.scene}`.", "", f"**{head}.** {text}", ""]
    if report.limit:
        lines += [f"What limits it: {report.limit}.", ""]
    for remark in report.remarks:
        lines += [f"Mind: {remark}.", ""]
    for sheet in report.sheets:
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
