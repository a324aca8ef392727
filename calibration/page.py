"""The report as one self-contained HTML page."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, select_autoescape

from calibration import figures
from calibration.export import versions
from calibration.tables import WRAPPED, sheets, verdict
from calibration.tuning import Calibration


def report_page(result: Calibration) -> str:
    """HTML text of the report: the verdict, both curves, all tables, speed against error; no file beside it needed."""
    environment = Environment(
        loader=PackageLoader("calibration"), autoescape=select_autoescape(), trim_blocks=True, lstrip_blocks=True
    )
    *first, last = sheets(result)
    return environment.get_template("report.html").render(
        result=result,
        verdict=verdict(result),
        sheets=first,
        trials=last,
        wrapped=WRAPPED,
        curves=figures.svg(figures.curves(result)),
        frontier=figures.svg(figures.frontier(result)),
        versions=versions(),
    )
