"""A table of calibrations, for the benchmarks that calibrate many scenes."""

from __future__ import annotations

import argparse
import fnmatch
from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from calibration import Calibration, MotionCalibration
from scene import Scene, parse_scene

Result = TypeVar("Result", Calibration, MotionCalibration)


def print_calibrations(
    description: str | None,
    heading: Sequence[str],
    scenes: Iterable[tuple[str, str]],
    calibrated: Callable[[Scene, float, str], Result],
    figures: Callable[[Result, float], Sequence[str]],
    clock: Callable[[], float],
) -> int:
    """Calibrate the scenes, by name and text, that the command line asks for; returns 1 when a target is missed.

    Each is a row of its name, whether the target was met, and its ``figures``, which are told the seconds by ``clock``.
    """
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=["*"])
    parser.add_argument("--target-error", type=float, default=0.01)
    asked = parser.parse_args()
    missed = 0
    print(f"| {' | '.join(heading)} |")
    print("|---" * len(heading) + "|")
    for name, text in scenes:
        if not any(fnmatch.fnmatch(name, pattern) for pattern in asked.names):
            continue
        started = clock()
        result = calibrated(parse_scene(text, name), asked.target_error, name)
        spent = clock() - started
        missed += not result.target_met
        met = "yes" if result.target_met else f"**no**: {result.limit}"
        print(f"| {' | '.join((name, met, *figures(result, spent)))} |", flush=True)
    return int(missed > 0)
