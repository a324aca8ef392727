"""A report as one self-contained HTML page."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, select_autoescape

from calibration.figures import svg
from calibration.sheets import WRAPPED, Report
from calibration.versions import versions


def report_page(report: Report) -> str:
    """HTML text of the report: the verdict, figures and tables; no file beside it needed."""
    environment = Environment(
        loader=PackageLoader("calibration"), autoescape=select_autoescape(), trim_blocks=True, lstrip_blocks=True
    )
    pictures = [(picture.title, svg(picture.figure), picture.caption) for picture in report.pictures]
    return environment.get_template("report.html").render(
        report=report, wrapped=WRAPPED, pictures=pictures, versions=versions()
    )
