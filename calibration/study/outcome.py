"""What came of a study: the frontier of speed against error, and the maps of hard cases, as data."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from calibration.study.measure import REPEATS
from calibration.study.points import HardPoint, ModelPoint, Point
from calibration.versions import versions
from fem_reference import PushAnswer

#: Share of an error by which another must be smaller to be worth its time.
NOTICEABLE = 0.02


@dataclass(frozen=True)
class Outcome:
    """A finished study.

    Attributes
    ----------
    name, title : str
        Of the scene.
    reference : Pushover or PlanePush
    models : tuple of (ModelPoint, dict)
        With what `calibration.study.measure` found, those that could be stepped.
    hard : tuple of (HardPoint, dict)
    failures : tuple of (Point, str)
        What could not be stepped, and why.
    """

    name: str
    title: str
    reference: PushAnswer
    models: tuple[tuple[ModelPoint, dict[str, Any]], ...]
    hard: tuple[tuple[HardPoint, dict[str, Any]], ...]
    failures: tuple[tuple[Point, str], ...]

    @property
    def frontier(self) -> list[tuple[ModelPoint, dict[str, Any]]]:
        """Models that no faster one is as close as, from fast to slow; closer by less than `NOTICEABLE` is as close."""
        best: list[tuple[ModelPoint, dict[str, Any]]] = []
        for point, found in sorted(self.models, key=lambda one: (speed(one[1]), one[1]["path_max"])):
            if not best or found["path_max"] < (1.0 - NOTICEABLE) * best[-1][1]["path_max"]:
                best.append((point, found))
        return best


def speed(found: Mapping[str, Any]) -> float:
    """Processor time for a simulated second [s]."""
    return float(found["seconds_per_simulated_second"])


def outcome(
    name: str, title: str, reference: PushAnswer, points: Sequence[Point], results: Sequence[dict[str, Any]]
) -> Outcome:
    """Sort what was found by what it is about."""
    models: list[tuple[ModelPoint, dict[str, Any]]] = []
    hard: list[tuple[HardPoint, dict[str, Any]]] = []
    failures: list[tuple[Point, str]] = []
    for point, found in zip(points, results, strict=True):
        if "failure" in found:
            failures.append((point, found["failure"]))
        elif isinstance(point, ModelPoint):
            models.append((point, found))
        else:
            hard.append((point, found))
    return Outcome(name, title, reference, tuple(models), tuple(hard), tuple(failures))


def plain(study: Outcome) -> dict[str, Any]:
    """The study as one object for JSON; SI units."""
    return {
        "scene": study.name,
        "title": study.title,
        "reference": {
            "method": study.reference.method,
            "displacement": study.reference.displacement.tolist(),
            "load": study.reference.load.tolist(),
            "error_estimate": study.reference.error_estimate,
        },
        "repeats": REPEATS,
        "points": [{**point.plain(), **found} for point, found in study.models],
        "frontier": [point.name for point, _ in study.frontier],
        "hard_cases": [{**point.plain(), **found} for point, found in study.hard],
        "failures": [{**point.plain(), "reason": reason} for point, reason in study.failures],
        "versions": versions(),
    }


def points_csv(study: Outcome) -> str:
    """All models that could be stepped, as CSV."""
    rows = [{**point.plain(), **found} for point, found in study.models]
    text = io.StringIO()
    columns = list(dict.fromkeys(column for row in rows for column in row))
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
