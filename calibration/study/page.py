"""A study on the terminal and as one self-contained HTML page."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, select_autoescape
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from calibration.figures import svg
from calibration.study import figures
from calibration.study.measure import REPEATS
from calibration.study.outcome import Outcome, speed
from calibration.versions import versions


def print_study(study: Outcome, console: Console) -> None:
    """The frontier first, then what failed."""
    best = study.frontier
    console.print(
        f"{len(study.models)} models pushed over, {len(best)} on the frontier of speed and error; "
        f"{sum(found['stable'] for _, found in study.hard)} of {len(study.hard)} hard cases stayed near their answer."
    )
    table = Table(
        title="Frontier: no faster one is as close (ms a simulated second, µs a joint and step)",
        title_justify="left",
        box=SIMPLE_HEAD,
    )
    for heading in ("model", "bodies", "path", "peak", "ms/s", "µs"):
        table.add_column(heading, justify="left" if heading == "model" else "right", no_wrap=heading != "model")
    for point, found in best:
        table.add_row(
            point.name,
            str(found["bodies"]),
            f"{100 * found['path_max']:.3g} %",
            f"{100 * found['collapse_load']:+.2f} %",
            f"{1e3 * speed(found):.3g}",
            f"{found['microseconds_per_joint_step']:.2f}",
        )
    console.print(table)
    if study.failures:
        failed, reason = study.failures[0]
        console.print(f"{len(study.failures)} could not be stepped, the first of them {failed.name}: {reason}")


def study_page(study: Outcome) -> str:
    """HTML text of the study; no file beside it is needed."""
    environment = Environment(
        loader=PackageLoader("calibration"), autoescape=select_autoescape(), trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("study.html").render(
        study=study,
        best=study.frontier,
        models=sorted(study.models, key=lambda one: one[1]["path_max"]),
        frontier=figures.frontier_svg(study),
        maps=svg(figures.hard_maps(study)) if study.hard else "",
        speed=speed,
        repeats=REPEATS,
        versions=versions(),
    )
