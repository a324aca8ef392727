"""Figures of a study: speed against error with every point named, and the maps of hard cases."""

from __future__ import annotations

import io
import math
from xml.sax.saxutils import escape

import matplotlib
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from calibration.figures import FAINT, INK, MODEL, REFERENCE, STYLE, logarithmic, svg
from calibration.study.outcome import Outcome, speed
from calibration.study.points import HARD_STEPS, KINDS, MASS_RATIOS, STIFFNESS_FACTORS, HardPoint, step_name

_STOCK = {"gear": "#c98b2b", "spring": "#7a5195"}
_MARKERS = ("o", "s", "^", "D", "v", "P")
_LAWS = (FAINT, MODEL, REFERENCE, "#3a8f5c", "#22303c")
#: Errors of a sag, from too stiff to too soft, where the maps' colours change.
_BANDS = (-1.5, -0.5, -0.05, 0.05, 0.5, 1e3)
_BAND_COLOURS = ("#2f6db3", "#a9c9e8", "#e3efe6", "#f3b6a6", "#c8452f")
_BAND_NAMES = ("too stiff by half", "too stiff", "right within 5 %", "too soft", "too soft by half")
_RAN_AWAY = "#2b2b2b"


def frontier(study: Outcome) -> Figure:
    """Path error of every model against its processor time; those on the frontier numbered and named beside."""
    best = study.frontier
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10.5, 5.8), layout="constrained")
        axes, names = figure.subplots(1, 2, width_ratios=(2.2, 1))
        rules = list(dict.fromkeys(point.model.rule for point, _ in study.models))
        laws = list(dict.fromkeys(point.model.law for point, _ in study.models if point.kind == "ductile"))
        labels: set[str] = set()
        for i, (point, found) in enumerate(study.models):
            stock = point.kind != "ductile"
            label = f"stock {point.kind}" if stock else f"{point.model.law}, {point.model.rule}"
            axes.scatter(
                [1e3 * speed(found)],
                [100.0 * found["path_max"]],
                s=22,
                marker="x" if stock else _MARKERS[rules.index(point.model.rule) % len(_MARKERS)],
                color=_STOCK[point.kind] if stock else _LAWS[laws.index(point.model.law) % len(_LAWS)],
                label="_" if label in labels else label,
                gid=f"model-{i}",
            )
            labels.add(label)
        axes.step(
            [1e3 * speed(found) for _, found in best],
            [100.0 * found["path_max"] for _, found in best],
            where="post",
            color=INK,
            lw=1.0,
            zorder=0,
        )
        lines = []
        for i, (point, found) in enumerate(best, 1):
            at = (1e3 * speed(found), 100.0 * found["path_max"])
            # Below and left of the frontier nothing lies, by what a frontier is.
            axes.annotate(
                str(i), at, xytext=(-5, -4), textcoords="offset points", ha="right", va="top", weight="bold", size=9
            )
            lines.append(f"{i}  {point.name}\n    {100.0 * found['path_max']:.2g} %, {1e3 * speed(found):.3g} ms")
        names.axis("off")
        names.text(0.0, 1.0, "On the frontier", va="top", weight="bold", transform=names.transAxes)
        size = min(7.5, 120.0 / max(1, len(best)))
        names.text(0.0, 0.95, "\n".join(lines), va="top", size=size, linespacing=1.25, transform=names.transAxes)
        logarithmic(axes)
        axes.set_xlabel("processor time for a simulated second [ms]")
        axes.set_ylabel("path error [% of peak load]")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=5, fontsize=8)
    return figure


def frontier_svg(study: Outcome) -> str:
    """`frontier` as SVG in which every point tells its name when pointed at."""
    text = svg(frontier(study))
    for i, (point, found) in enumerate(study.models):
        group = f'<g id="model-{i}">'
        title = f"{point.name}: {100.0 * found['path_max']:.3g} %, {1e3 * speed(found):.3g} ms"
        text = text.replace(group, f"{group}<title>{escape(title)}</title>")
    return text


def hard_maps(study: Outcome) -> Figure:
    """Error of the sag in per cent, over step and mass ratio, and over step and stiffness, for each kind of joint."""
    found = dict(study.hard)
    colours = ListedColormap(_BAND_COLOURS)
    colours.set_bad(_RAN_AWAY)
    titles = {"ductile": "ductile joints", "gear": "stock pivot and gear", "spring": "stock pivot and rotary spring"}
    with matplotlib.rc_context({**STYLE, "axes.grid": False}):
        figure = Figure(figsize=(10.5, 6.2), layout="constrained")
        maps = figure.subplots(2, len(KINDS), sharey=True)
        for column, kind in enumerate(KINDS):
            by_mass = [[HardPoint(kind, dt, mass_ratio=x) for x in MASS_RATIOS] for dt in HARD_STEPS]
            by_stiffness = [[HardPoint(kind, dt, stiffness_factor=x) for x in STIFFNESS_FACTORS] for dt in HARD_STEPS]
            rows = (
                (MASS_RATIOS, "mass at the tip over a piece's", by_mass),
                (STIFFNESS_FACTORS, "stiffness over the member's", by_stiffness),
            )
            for axes, (ticks, label, cells) in zip(maps[:, column], rows, strict=True):
                errors = np.array([[_sag_error(found.get(cell)) for cell in row] for row in cells])
                axes.imshow(errors, cmap=colours, norm=BoundaryNorm(_BANDS, len(_BAND_COLOURS)), aspect="auto")
                for (row, place), error in np.ndenumerate(errors):
                    dark = np.isnan(error) or abs(error) >= 0.5
                    axes.text(
                        place, row, _per_cent(error), ha="center", va="center", size=7, color="white" if dark else INK
                    )
                axes.set_xticks(range(len(ticks)), [f"$10^{{{math.log10(x):.0f}}}$" for x in ticks])
                axes.set_yticks(range(len(HARD_STEPS)), [step_name(dt) for dt in HARD_STEPS])
                axes.set_xlabel(label)
            maps[0, column].set_title(titles[kind], size=10)
        patches = [
            matplotlib.patches.Patch(color=colour, label=name)
            for colour, name in zip((*_BAND_COLOURS, _RAN_AWAY), (*_BAND_NAMES, "ran away"), strict=True)
        ]
        figure.legend(handles=patches, loc="outside lower center", ncols=6, fontsize=8)
    return figure


def _per_cent(error: float) -> str:
    if math.isnan(error):
        return "×"
    return f"{100.0 * error:+.0f}".replace("+0", "0").replace("-0", "0") if error < 9.995 else "≫"


def _sag_error(found: dict[str, float | None] | None) -> float:
    """Error of a cell; nan where the tip ran away or there is no answer."""
    error = None if found is None else found["sag_error"]
    return float("nan") if error is None else error


def png(figure: Figure) -> bytes:
    """The figure as a picture."""
    data = io.BytesIO()
    with matplotlib.rc_context(STYLE):
        figure.savefig(data, format="png", dpi=130, metadata={"Software": None})
    return data.getvalue()
