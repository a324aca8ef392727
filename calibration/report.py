"""The report on the terminal."""

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from calibration.tuning import Calibration
from capacity.units import engineering

_SHOWN_TRIALS = 12


def print_report(result: Calibration, console: Console) -> None:
    """The verdict first, then capacities, errors, and speed against error."""
    best, push = result.best, result.best.push
    verdict = Text(
        "Target met" if result.target_met else "Target missed", "bold green" if result.target_met else "bold red"
    )
    verdict.append(
        f": {push.bodies} bodies, {push.joints} {best.model.law} joints ({best.model.rule}), "
        f"path error {100 * best.errors.path_max:.2f} % of the peak load, {100 * result.target_error:.2g} % asked, "
        f"{1.0 / push.seconds_per_simulated_second:.0f} times faster than real time at 1/dt = {1 / best.model.dt:.0f}",
        "default not bold",
    )
    console.print(verdict)
    if not result.reference_good_enough:
        console.print(
            f"The reference's own estimated error, {100 * result.reference.error_estimate:.2g} %, "
            "is more than a fifth of the target.",
            style="red",
        )
    console.print(_capacities(result))
    console.print(_errors(result))
    console.print(_trials(result))
    if result.failures:
        console.print(
            f"{len(result.failures)} more models could not be stepped: {result.failures[0].reason}", style="red"
        )


def _capacities(result: Calibration) -> Table:
    table = Table(title="Capacities", title_justify="left", box=SIMPLE_HEAD)
    for heading in ("member", "section", "N_max", "Q_max", "M_max", "EA", "EI"):
        table.add_column(heading, justify="left" if heading in ("member", "section") else "right")
    for name, c in result.capacity.items():
        cells = [
            engineering(value, unit)
            for value, unit in ((c.N_max, "N"), (c.Q_max, "N"), (c.M_max, "N m"), (c.EA, "N"), (c.EI, "N m²"))
        ]
        table.add_row(name, result.scene.members[name].section.name, *cells)
    return table


def _errors(result: Calibration) -> Table:
    reference, errors = result.reference, result.best.errors
    table = Table(title="Errors, of the peak load", title_justify="left", box=SIMPLE_HEAD)
    table.add_column("quantity")
    table.add_column("error", justify="right")
    table.add_row("reference, by its own estimate", f"{100 * reference.error_estimate:.3f} %")
    table.add_row("model: path", f"{100 * errors.path_max:.3f} %")
    table.add_row("model: initial stiffness", f"{100 * errors.stiffness:+.3f} %")
    table.add_row("model: largest load", f"{100 * errors.collapse_load:+.3f} %")
    return table


def _trials(result: Calibration) -> Table:
    title = "Speed against error: the models tried last (ms a simulated second, µs a joint and step)"
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD)
    for heading in ("rule", "points", "law", "fibres", "1/dt", "bodies", "path", "ms/s", "µs"):
        table.add_column(heading, justify="left" if heading in ("rule", "law") else "right")
    for trial in result.trials[-_SHOWN_TRIALS:]:
        model, push = trial.model, trial.push
        table.add_row(
            model.rule,
            str(model.joints),
            model.law,
            str(model.fibres) if model.law == "fibre" else "–",
            f"{1 / model.dt:.0f}",
            str(push.bodies),
            f"{100 * trial.errors.path_max:.2f} %",
            f"{1e3 * push.seconds_per_simulated_second:.3g}",
            f"{push.microseconds_per_joint_step:.2f}",
            style="bold" if trial is result.best else "",
        )
    return table
