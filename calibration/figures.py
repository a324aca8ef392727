"""Figures of a calibration, as SVG text for a page or as files."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter

from calibration.tuning import Calibration
from sim import LAWS, RULES

INK, REFERENCE, MODEL, FAINT = "#22303c", "#1f6fb2", "#d1495b", "#9aa5b1"
STYLE = {
    "svg.hashsalt": "ductile-joints",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 11,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e8ec",
    "legend.frameon": False,
}


def curves(result: Calibration) -> Figure:
    """Both load–deflection curves, and below them by how much they differ."""
    reference, push = result.reference, result.best.push
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.6), layout="constrained")
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        top.plot(1e3 * reference.displacement, 1e-3 * reference.load, color=REFERENCE, lw=2.5, label="reference (FEM)")
        label = f"{push.bodies} rigid bodies, {push.joints} joints"
        top.plot(1e3 * push.displacement, 1e-3 * push.load, color=MODEL, lw=1.4, ls=(0, (4, 2)), label=label)
        factor = bool(result.scene.loads_of("proportional"))
        top.set_ylabel("load factor / 1000" if factor else "load [kN]")
        top.legend(loc="lower right")
        difference = push.load_at_distances - reference.load
        share = 100.0 * difference / np.abs(reference.load).max()
        bottom.axhspan(-100.0 * result.target_error, 100.0 * result.target_error, color="#e9f3ec", lw=0)
        bottom.plot(1e3 * reference.displacement, share, color=MODEL, lw=1.4)
        bottom.set_ylim(-150.0 * result.target_error, 150.0 * result.target_error)
        if np.abs(share).max() > 150.0 * result.target_error:
            bottom.set_ylim(auto=True)
        bottom.set_ylabel("difference\n[% of peak]")
        bottom.set_xlabel("displacement of the pushed node [mm]")
    return figure


def frontier(result: Calibration) -> Figure:
    """Path error of every model tried against what a simulated second of it costs."""
    groups: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for trial in result.trials:
        point = (trial.push.seconds_per_simulated_second, trial.errors.path_max)
        groups.setdefault((trial.model.rule, trial.model.law), []).append(point)
    markers = dict(zip(RULES, "osD", strict=True))
    colours = dict(zip(LAWS, (INK, FAINT, REFERENCE, MODEL), strict=True))
    clouds = [
        Cloud(f"{rule}, {law}", markers[rule], colours[law], points) for (rule, law), points in sorted(groups.items())
    ]
    chosen = (result.best.push.seconds_per_simulated_second, result.best.errors.path_max)
    return error_against_cost(clouds, chosen, result.target_error, "path error [% of peak load]")


class Cloud(NamedTuple):
    """Models of one kind: seconds for a simulated second, and error [-], of each."""

    name: str
    marker: str
    colour: str
    points: Sequence[tuple[float, float]]


def error_against_cost(
    clouds: Iterable[Cloud], chosen: tuple[float, float], target_error: float, ordinate: str
) -> Figure:
    """Errors of models against what a simulated second of them costs, the chosen one ringed."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.2), layout="constrained")
        axes = figure.subplots()
        for name, marker, colour, points in clouds:
            cost, error = _in_units(points)
            axes.scatter(cost, error, s=26, marker=marker, color=colour, label=name)
        cost, error = _in_units([chosen])
        axes.scatter(cost, error, s=120, facecolors="none", edgecolors=INK, linewidths=1.4, label="chosen")
        cost_axes(axes, target_error)
        axes.set_ylabel(ordinate)
        axes.legend(loc="best", fontsize=9)
    return figure


def _in_units(points: Sequence[tuple[float, float]]) -> tuple[list[float], list[float]]:
    """Costs [ms] and errors [%]."""
    return [1e3 * cost for cost, _ in points], [100.0 * error for _, error in points]


def cost_axes(axes: Axes, target_error: float) -> None:
    """Logarithmic axes of computing time and an error in per cent, with the target's line."""
    axes.axhline(100.0 * target_error, color=INK, lw=1.0, ls=(0, (4, 2)))
    axes.annotate("target", (1.0, 100.0 * target_error), xycoords=("axes fraction", "data"), ha="right", va="bottom")
    axes.set_yscale("log")
    axes.set_xscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.set_minor_formatter(StrMethodFormatter("{x:g}"))
    axes.set_xlabel("computing time for a simulated second [ms]")


def svg(figure: Figure) -> str:
    """The figure as an ``<svg>`` element, the same text for the same numbers."""
    text = io.StringIO()
    with matplotlib.rc_context(STYLE):
        figure.savefig(text, format="svg", metadata={"Date": None})
    whole = text.getvalue()
    return whole[whole.index("<svg") :]
