"""The report as one self-contained HTML page."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, select_autoescape

from calibration import figures
from calibration.export import joint_table, settings, versions
from calibration.tuning import Calibration
from capacity.units import engineering


def report_page(result: Calibration) -> str:
    """HTML text of the report: capacities, joints, both curves, speed against error; no file beside it is needed."""
    environment = Environment(
        loader=PackageLoader("calibration"), autoescape=select_autoescape(), trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["si"] = engineering
    return environment.get_template("report.html").render(
        result=result,
        best=result.best,
        settings=settings,
        capacities={name: capacity.values() for name, capacity in result.capacity.items()},
        table=joint_table(result.scene, result.best.model),
        curves=figures.svg(figures.curves(result)),
        frontier=figures.svg(figures.frontier(result)),
        versions=versions(),
    )
