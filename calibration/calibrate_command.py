"""What ``ductile calibrate`` answers: a report, an object for JSON, and files."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from calibration.csv_text import csv_text
from calibration.export import calibration_object, curve_csv, joint_table
from calibration.motion_report import motion_object, motion_report
from calibration.motion_tuning import calibrate_motion
from calibration.page import report_page
from calibration.report import report_markdown
from calibration.sheets import Report
from calibration.tables import report
from calibration.tuning import calibrate
from capacity import InputError
from scene import Scene

Watch = Callable[[str, float], None]


@dataclass(frozen=True)
class Answer:
    """A report, the same as data, and the text files beside them by name."""

    report: Report
    whole: dict[str, Any]
    beside: Mapping[str, str]

    def files(self) -> dict[str, str]:
        """All files by name."""
        return {
            "report.html": report_page(self.report),
            "report.md": report_markdown(self.report),
            "calibration.json": json.dumps(self.whole, indent=1),
            **self.beside,
        }


def answer(scene: Scene, target_error: float, name: str, watch: Watch) -> Answer:
    """Calibrate ``scene`` by its push, or else by its motion.

    Raises
    ------
    InputError
        When it has neither.
    """
    if scene.pushed is None and scene.motion is None:
        raise InputError("push", "calibration follows pushes and motions", "add [push] or [motion]")
    return (_of_motion if scene.pushed is None else _of_push)(scene, target_error, name, watch)


def _of_push(scene: Scene, target_error: float, name: str, watch: Watch) -> Answer:
    result = calibrate(scene, target_error, name, watch)
    push = result.best.push
    beside = {
        "joints.json": json.dumps(joint_table(result.fitted_scene, result.best.model, name), indent=1),
        "reference.csv": curve_csv(result.reference.displacement, result.reference.load),
        "model.csv": curve_csv(push.displacement, push.load),
    }
    return Answer(report(result), calibration_object(result), beside)


def _of_motion(scene: Scene, target_error: float, name: str, watch: Watch) -> Answer:
    result = calibrate_motion(scene, target_error, name, watch)
    reference, course = result.reference, result.best.course
    beside = {
        "joints.json": json.dumps(joint_table(scene, result.best.model, name), indent=1),
        "reference.csv": _history_csv(reference.time, reference.displacement),
        "model.csv": _history_csv(course.time, course.displacement),
    }
    return Answer(motion_report(result), motion_object(result), beside)


def _history_csv(time: np.ndarray, displacement: np.ndarray) -> str:
    return csv_text(["time_s", "displacement_m"], zip(time.tolist(), displacement.tolist(), strict=True))
