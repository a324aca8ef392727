"""Figures of a calibration, as SVG text for a page or as files."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator, StrMethodFormatter

from calibration.tuning import Calibration
from sim import LAWS, RULES

#: Of a report's figures [in]: wide enough for a desk, and their words not too small on a phone.
WIDTH = 5.8
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
    "axes.axisbelow": True,
    "grid.color": "#e4e8ec",
    "legend.frameon": False,
}


def curves(result: Calibration) -> Figure:
    """Both load–deflection curves, and below them by how much they differ."""
    reference, push = result.reference, result.best.push
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 4.6), layout="constrained")
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        top.plot(1e3 * reference.displacement, 1e-3 * reference.load, color=REFERENCE, lw=2.5, label="reference (FEM)")
        label = f"{push.bodies} rigid bodies, {push.joints} joints"
        top.plot(1e3 * push.displacement, 1e-3 * push.load, color=MODEL, lw=1.4, ls=(0, (4, 2)), label=label)
        factor = bool(result.scene.loads_of("proportional"))
        top.set_ylabel("load factor / 1000" if factor else "load [kN]")
        legend_above(figure, top)
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
    markers = dict(zip(RULES, "o^sD", strict=True))
    colours = dict(zip(LAWS, (INK, FAINT, REFERENCE, MODEL), strict=True))
    clouds = [
        Cloud(f"{rule}, {law}", markers[rule], colours[law], points) for (rule, law), points in sorted(groups.items())
    ]
    chosen = (result.best.push.seconds_per_simulated_second, result.best.errors.path_max)
    return error_against_cost(clouds, chosen, result.target_error, "path error [% of peak load]")


#: Numbers that an axis has at least.
_FEWEST_TICKS = 3


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
        figure = Figure(figsize=(WIDTH, 4.4), layout="constrained")
        axes = figure.subplots()
        for name, marker, colour, points in clouds:
            cost, error = _in_units(points)
            axes.scatter(cost, error, s=26, marker=marker, color=colour, label=name)
        cost, error = _in_units([chosen])
        axes.scatter(cost, error, s=120, facecolors="none", edgecolors=INK, linewidths=1.4, label="chosen")
        cost_axes(axes, target_error)
        axes.set_ylabel(ordinate)
        legend_above(figure, axes)
    return figure


def legend_above(figure: Figure, axes: Axes) -> None:
    """The legend of ``axes`` outside of it, where it hides nothing, in two columns."""
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper left", ncols=2, fontsize=9)


def _in_units(points: Sequence[tuple[float, float]]) -> tuple[list[float], list[float]]:
    """Costs [ms] and errors [%]."""
    return [1e3 * cost for cost, _ in points], [100.0 * error for _, error in points]


def cost_axes(axes: Axes, target_error: float) -> None:
    """Logarithmic axes of computing time and an error in per cent, with the target's line."""
    axes.axhline(100.0 * target_error, color=INK, lw=1.0, ls=(0, (4, 2)))
    axes.annotate("target", (1.0, 100.0 * target_error), xycoords=("axes fraction", "data"), ha="right", va="bottom")
    logarithmic(axes)
    axes.set_xlabel("computing time for a simulated second [ms]")


def logarithmic(axes: Axes) -> None:
    """Make both axes logarithmic, each with a few plain numbers: round ones, and as round as three of them can be."""
    axes.set(xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(_round_numbers(axis))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.set_minor_locator(NullLocator())


def _round_numbers(axis: Axis) -> LogLocator | MaxNLocator:
    low, high = axis.get_view_interval()
    for multiples in ((1.0,), (1.0, 3.0), (1.0, 2.0, 5.0), range(1, 10)):
        locator = LogLocator(subs=multiples)
        ticks = np.asarray(locator.tick_values(low, high))
        if np.count_nonzero((low <= ticks) & (ticks <= high)) >= _FEWEST_TICKS:
            return locator
    return MaxNLocator(5)


def svg(figure: Figure) -> str:
    """The figure as an ``<svg>`` element, the same text for the same numbers."""
    text = io.StringIO()
    with matplotlib.rc_context(STYLE):
        figure.savefig(text, format="svg", metadata={"Date": None})
    whole = text.getvalue()
    return whole[whole.index("<svg") :]
