"""What ``ductile fit`` answers: parameters fitted to load cases, and how they do on one that the fit did not see."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, cast, get_args

import matplotlib
from matplotlib.figure import Figure

from calibration.export import joint_table, settings
from calibration.figures import FAINT, MODEL, REFERENCE, STYLE
from calibration.fitting import Fit, LoadCase, fit
from calibration.motion_tuning import REFERENCE_MARGIN as MOTION_MARGIN
from calibration.page import report_page
from calibration.parameters import BOUNDS, Name, check_parameters, fitted
from calibration.report import report_markdown
from calibration.sheets import Picture, Report, percent
from calibration.tables import fit_sheets, in_words, joint_sheet, stepping
from calibration.tuning import REFERENCE_MARGIN
from calibration.versions import versions
from capacity import InputError
from fem_reference import default_tolerance
from scene import Scene
from sim import Model

Bounds = dict[Name, tuple[float, float, float]]


@dataclass(frozen=True)
class FitAnswer:
    """A fit with the load cases it was made from and checked on, and what was asked of it."""

    fit: Fit
    cases: tuple[LoadCase, ...]
    checks: tuple[LoadCase, ...]
    target_error: float

    @property
    def error(self) -> float:
        """Largest error of all load cases, those that the fit did not see among them [-]."""
        return max([self.fit.worst, *(after for _, after in self.fit.checks.values())])

    @property
    def limit(self) -> str:
        """What keeps the target from being met, in words; empty when it is."""
        for case in (*self.cases, *self.checks):
            if case.uncertainty > needed(case.scene, self.target_error):
                return f"the reference of {case.name} itself is only known within {percent(case.uncertainty, 2)}"
        if self.error <= self.target_error:
            return ""
        return "the parameters that were varied leave that much; vary others, or take finer joints"

    @property
    def report(self) -> Report:
        """The verdict, tables and figures."""
        found, met = self.fit, not self.limit
        unseen = ", ".join(f"{percent(after)} ({percent(before)} without)" for before, after in found.checks.values())
        words = f"{len(found.parameters)} parameters of {in_words(found.model, self.cases[0].scene.members)} "
        words += f"({stepping(found.model)}) fitted to {len(self.cases)} load cases: off by {percent(found.worst)} at "
        words += f"most, by {percent(max(found.before.values()))} without; on what the fit did not see by {unseen}. "
        words += f"{percent(self.target_error)} was asked."
        held, loose = ", ".join(found.at_bound), ", ".join(found.undetermined)
        remarks = [
            f"{kind}: {named}" for kind, named in (("at a bound", held), ("not determined by the data", loose)) if named
        ]
        scene, model = fitted(self.cases[0].scene, found.model, found.parameters)
        shown = [*((case, "fitted") for case in self.cases), *((case, "not seen by the fit") for case in self.checks)]
        return Report(
            kind="Fit",
            title=self.cases[0].scene.title,
            scene=", ".join(case.name for case in self.cases),
            met=met,
            verdict=("Target met" if met else "Target missed", words),
            limit=self.limit,
            remarks=tuple(remarks),
            sheets=(*fit_sheets(found), joint_sheet(scene, model)),
            pictures=tuple(Picture(f"{case.name}, {kind}", self._curves(case), _CAPTION) for case, kind in shown),
        )

    def _curves(self, case: LoadCase) -> Figure:
        """The reference of a load case, and the model without and with the fit."""
        moves = case.scene.pushed is None
        across, along = ("time [s]", "displacement [mm]") if moves else ("displacement [mm]", "load [kN]")
        x_scale, y_scale = (1.0, 1e3) if moves else (1e3, 1e-3)
        largest = abs(case.values).max()
        with matplotlib.rc_context(STYLE):
            figure = Figure(figsize=(7.2, 3.6), layout="constrained")
            axes = figure.subplots()
            axes.plot(x_scale * case.points, y_scale * case.values, color=REFERENCE, lw=2.5, label="reference (FEM)")
            lines: tuple[tuple[str, dict[Name, float], str], ...] = (
                ("without the fit", {}, FAINT),
                ("fitted", self.fit.parameters, MODEL),
            )
            for label, parameters, colour in lines:
                values = case.values + largest * case.residuals(self.fit.model, parameters)
                axes.plot(x_scale * case.points, y_scale * values, color=colour, lw=1.4, ls=(0, (4, 2)), label=label)
            axes.set_xlabel(across)
            axes.set_ylabel(along)
            axes.legend(loc="best")
        return figure

    def whole(self) -> dict[str, Any]:
        """The fit as one object for JSON; SI units."""
        return {
            "scenes": [case.name for case in self.cases],
            "weights": [case.weight for case in self.cases],
            **asdict(self.fit),
            "model": settings(self.fit.model),
            "target_error": self.target_error,
            "target_met": not self.limit,
            "versions": versions(),
        }

    def files(self) -> dict[str, str]:
        """All files by name."""
        report = self.report
        scene, model = fitted(self.cases[0].scene, self.fit.model, self.fit.parameters)
        return {
            "report.html": report_page(report),
            "report.md": report_markdown(report),
            "fit.json": json.dumps(self.whole(), indent=1),
            "joints.json": json.dumps(joint_table(scene, model, self.cases[0].name), indent=1),
        }


_CAPTION = "The reference, and the model without and with the fit."


def answer(
    scenes: Sequence[tuple[str, Scene]],
    checks: Sequence[tuple[str, Scene]],
    model: Model,
    names: Sequence[Name],
    bounds: Bounds,
    weights: Sequence[float],
    target_error: float,
    watch: Callable[[str, float], None],
) -> FitAnswer:
    """Fit ``names`` to all ``scenes``, each by its weight, and check them on ``checks``, or on what `unseen` makes."""
    check_parameters(names, model)
    solved = []
    for i, (name, scene) in enumerate((*scenes, *checks)):
        watch(f"reference of {name}", i / (len(scenes) + len(checks) + 2))
        solved.append(LoadCase.solve(name, scene, tolerance=wanted(scene, target_error)))
    cases = [replace(case, weight=weight) for case, weight in zip(solved, weights, strict=False)]
    unseen = solved[len(scenes) :]
    if not unseen:
        watch("reference of a load case that the fit does not see", 0.6)
        unseen = [LoadCase.unseen(scenes[0][1], wanted(scenes[0][1], target_error))]
    watch("fitting", 0.8)
    return FitAnswer(fit(cases, model, names, unseen, bounds), tuple(cases), tuple(unseen), target_error)


def needed(scene: Scene, target_error: float) -> float:
    """How well the reference of ``scene`` must be known to judge by it [-]: as for a calibration."""
    return target_error / (REFERENCE_MARGIN if scene.motion is None else MOTION_MARGIN)


def wanted(scene: Scene, target_error: float) -> float:
    """How well it is asked to know itself [-]."""
    return min(needed(scene, target_error), default_tolerance(scene))


def parameter_names(text: str) -> list[Name]:
    """Parameters from a list such as ``"stiffness, strength"``.

    Raises
    ------
    InputError
        For an unknown one.
    """
    names = list(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    known = get_args(Name)
    for name in names:
        if name not in known:
            raise InputError("--vary", f'there is no parameter "{name}"', f"choose from {', '.join(known)}")
    if not names:
        raise InputError("--vary", "it names nothing", f"choose from {', '.join(known)}")
    return cast("list[Name]", names)


def read_bounds(text: str, names: Sequence[Name]) -> Bounds:
    """Start and bounds of all parameters, from a text such as ``"strength=0.8:1.2, damping=0:0.02"`` for some.

    Raises
    ------
    InputError
        When a part of it says something else.
    """
    bounds = dict(BOUNDS)
    for part in filter(None, (part.strip() for part in text.split(","))):
        name, _, span = part.partition("=")
        low, _, high = span.partition(":")
        if name.strip() not in names:
            raise InputError("--bounds", f'"{name.strip()}" is not varied', f"choose from {', '.join(names)}")
        try:
            lowest, highest = float(low), float(high)
        except ValueError:
            raise InputError("--bounds", f'"{part}" has no two numbers', 'write "strength=0.8:1.2"') from None
        key = cast("Name", name.strip())
        least, most = _SENSIBLE[key]
        if not least <= lowest < highest <= most:
            fault = f'"{part}" is not a range between {least:g} and {most:g}'
            raise InputError("--bounds", fault, 'write the lower number first, as in "strength=0.8:1.2"')
        bounds[key] = (min(max(BOUNDS[key][0], lowest), highest), lowest, highest)
    return bounds


# What a bound may be at all.
_SENSIBLE: dict[Name, tuple[float, float]] = {
    "stiffness": (1e-3, 1e3),
    "strength": (1e-3, 1e3),
    "spread": (0.0, 0.95),
    "hardening": (0.0, 0.95),
    "reserve": (0.0, 10.0),
    "hinge_length": (1e-3, 1e3),
    "damping": (0.0, 10.0),
}
