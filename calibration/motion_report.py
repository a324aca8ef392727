"""What the report of a calibration by a motion says, as tables, figures and data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from calibration.export import members_object, outcome, settings, subject
from calibration.figures import FAINT, MODEL, REFERENCE, STYLE, WIDTH, Cloud, error_against_cost, legend_above
from calibration.motion_tuning import REFERENCE_MARGIN, MotionCalibration, MotionTrial
from calibration.sheets import Picture, Report, Sheet, percent
from calibration.tables import capacity_sheet, in_words, joint_sheet, member_sheet, stepping
from capacity.units import engineering
from fem_reference import HISTORY_SHARE

#: Of the laws that motions are tried with.
_COLOURS = {"elastic-plastic": FAINT, "interaction": REFERENCE, "fibre": MODEL}


def motion_report(result: MotionCalibration) -> Report:
    """All of it: the verdict, tables and figures."""
    reference, best = result.reference, result.best
    off = max(abs(best.errors.peak), abs(best.errors.residual))
    words = f"{best.course.bodies} rigid bodies with {best.course.joints} joints "
    words += f"({in_words(best.model, result.scene.members)}) come to the reference's peak of "
    words += f"{engineering(abs(reference.peak), 'm')} and its rest within {percent(off)} of the peak; "
    words += f"{percent(result.target_error)} was asked. A simulated second takes "
    words += f"{engineering(best.course.seconds_per_simulated_second, 's')} ({stepping(best.model)}): "
    words += f"{1.0 / best.course.seconds_per_simulated_second:.0f} times faster than real time."
    caption = (
        f"Reference: {reference.method}; {reference.elements} elements a member, {reference.fibres} fibres a section, "
        f"{reference.steps} steps. Its peak and rest are known within {percent(result.uncertainty, 2)} of the peak."
    )
    frontier = "Error of peak and rest against computing time of every model tried; the chosen one is ringed."
    return Report(
        kind="Calibration",
        title=result.scene.title,
        scene=result.name,
        met=result.target_met,
        verdict=("Target met" if result.target_met else "Target missed", words),
        limit=result.limit,
        remarks=result.remarks,
        sheets=(
            capacity_sheet(result.scene, result.capacity),
            member_sheet(result.plans, best.model),
            _errors(result),
            *([_hinges(result)] if reference.hinges else []),
            joint_sheet(result.scene, best.model),
            _trials(result),
        ),
        pictures=(
            Picture("Motion", _history(result), caption),
            Picture("", _frontier(result), frontier),
        ),
    )


def _errors(result: MotionCalibration) -> Sheet:
    errors = result.best.errors
    signed = {
        "peak": errors.peak,
        "displacement at rest, of the peak": errors.residual,
        "time of the peak, of the duration": errors.peak_time,
        "plastic work": errors.plastic_work,
        "first natural frequency": result.findings.frequency_error,
    }
    rows = [
        ("the reference, by its own estimate", percent(result.uncertainty)),
        *((name, f"{100.0 * value:+.3f} %") for name, value in signed.items() if value is not None),
        ("at any time, of the peak", percent(errors.history)),
    ]
    if result.findings.hinges_in_order is not None:
        rows.append(("hinges where and as the reference has them", "yes" if result.findings.hinges_in_order else "no"))
    model = result.best.model
    note = (
        f"Of node {result.reference.node}. Model: {in_words(model, result.scene.members)}; {stepping(model)}, average "
        f"acceleration with a numerical damping of {model.scheme[1]:g}. The target holds for the peak and the "
        f"displacement at rest, and {1.0 / HISTORY_SHARE:.0f} times it at any time. The reference must be known "
        f"{REFERENCE_MARGIN:.0f} times better."
    )
    return Sheet("Errors", note, ("<kind", "error"), tuple(rows))


def _hinges(result: MotionCalibration) -> Sheet:
    rows = []
    for hinge, pair in zip(result.reference.hinges, result.findings.hinges, strict=True):
        late = "–" if pair.model is None else f"{1e3 * (pair.model - pair.reference):+.3g}"
        known = "not in coarser models" if hinge.time_error is None else f"{1e3 * hinge.time_error:.2g}"
        model = "none" if pair.model is None else f"{1e3 * pair.model:.4g}"
        rows.append((pair.where, f"{1e3 * pair.reference:.4g}", known, model, late))
    note = (
        "Times at which plastic hinges form, in the reference's order, with its own error; a joint counts as "
        "one at 98.5 % of its plastic moment. Behind a blow a hinge travels along its member, and is named where it "
        "begins: a joint stands for a length, and comes to it later or not at all."
    )
    return Sheet("Hinges", note, ("<where", "reference [ms]", "± [ms]", "model [ms]", "difference [ms]"), tuple(rows))


def _trials(result: MotionCalibration) -> Sheet:
    rows = [
        (
            in_words(trial.model, result.scene.members),
            f"{1 / trial.model.dt:.0f}",
            str(trial.course.bodies),
            f"{100.0 * trial.errors.peak:+.3g} %",
            f"{100.0 * trial.errors.residual:+.3g} %",
            percent(trial.errors.history),
            f"{1e3 * trial.course.seconds_per_simulated_second:.3g}",
        )
        for trial in result.trials
    ]
    note = (
        "All models tried, from cheap to dear, with milliseconds for a simulated second. Times are this machine's and "
        "vary from run to run; errors do not."
    )
    if result.failures:
        note += f" {len(result.failures)} more could not be stepped, the first: {result.failures[0].reason}."
    heads = ("<model", "1/dt", "bodies", "peak", "rest", "at any time", "ms/s")
    return Sheet("Speed against error", note, heads, tuple(rows), result.trials.index(result.best))


def _history(result: MotionCalibration) -> Figure:
    """Both displacements over time."""
    reference, course = result.reference, result.best.course
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 3.8), layout="constrained")
        axes = figure.subplots()
        axes.plot(reference.time, 1e3 * reference.displacement, color=REFERENCE, lw=2.5, label="reference (FEM)")
        label = f"{course.bodies} rigid bodies, {course.joints} joints"
        axes.plot(course.time, 1e3 * course.displacement, color=MODEL, lw=1.4, ls=(0, (4, 2)), label=label)
        axes.set_xlabel("time [s]")
        axes.set_ylabel(f"displacement of {reference.node} [mm]")
        legend_above(figure, axes)
    return figure


def _frontier(result: MotionCalibration) -> Figure:
    """Error of every model tried against what a simulated second of it costs."""
    points = {law: [_point(trial) for trial in result.trials if trial.model.law == law] for law in _COLOURS}
    clouds = [Cloud(law, "o", _COLOURS[law], found) for law, found in points.items() if found]
    return error_against_cost(clouds, _point(result.best), result.target_error, "error of peak and rest [% of peak]")


def _point(trial: MotionTrial) -> tuple[float, float]:
    return trial.course.seconds_per_simulated_second, trial.error


def motion_object(result: MotionCalibration) -> dict[str, Any]:
    """The calibration as one object for JSON; SI units."""
    reference, best = result.reference, result.best
    return {
        **subject(result),
        "reference": {
            "method": reference.method,
            "node": reference.node,
            "time": reference.time.tolist(),
            "displacement": reference.displacement.tolist(),
            "peak": reference.peak,
            "residual": {name: list(moved) for name, moved in reference.residual.items()},
            "error_estimate": result.uncertainty,
            "elements": reference.elements,
            "fibres": reference.fibres,
            "seconds": reference.seconds,
        },
        "model": {
            **settings(best.model),
            "bodies": best.course.bodies,
            "joints": best.course.joints,
            "displacement": best.course.displacement.tolist(),
            "newton_steps": best.course.newton_steps,
            "unconverged": best.course.unconverged,
            "dissipated": best.course.dissipated,
            "seconds": best.course.seconds,
        },
        "members": members_object(result.plans, best.model),
        "errors": {**asdict(best.errors), "frequency": result.findings.frequency_error},
        "hinges": [
            {"where": pair.where, "time": pair.reference, "model_time": pair.model} for pair in result.findings.hinges
        ],
        "hinges_in_order": result.findings.hinges_in_order,
        "speed": {"seconds_per_simulated_second": best.course.seconds_per_simulated_second},
        "pareto": [
            {
                **settings(trial.model),
                "bodies": trial.course.bodies,
                "joints": trial.course.joints,
                **asdict(trial.errors),
                "cost": trial.cost,
                "seconds_per_simulated_second": trial.course.seconds_per_simulated_second,
            }
            for trial in result.trials
        ],
        **outcome(result),
    }
