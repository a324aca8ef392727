"""Calibrate every reference case of a push, as scene files: which targets are met, by which model, in what time.

    python benchmarks/open_cases.py [--target-error 0.01] [NAME ...]

NAME is a pattern such as "C2-portal-*"; all cases by default. Ends with 1 when a target is missed.
"""

import json
import sys
import time
from pathlib import Path

TESTS = Path(__file__).parent.parent / "tests"
sys.path.insert(0, str(TESTS))

from calibrated_scenes import print_calibrations  # noqa: E402
from open_scenes import open_scenes  # noqa: E402  (beside the tests, which use them, too)

from calibration import Calibration, calibrate  # noqa: E402
from calibration.tables import in_words  # noqa: E402


def figures(result: Calibration, seconds: float) -> tuple[str, ...]:
    best = result.best
    return (
        f"{100.0 * best.errors.path_max:.3f} %",
        f"{100.0 * result.reference.error_estimate:.3f} %",
        f"{in_words(best.model, result.scene.members)}, 1/dt {1.0 / best.model.dt:.0f}",
        f"{best.push.bodies}",
        f"{len(result.trials)}",
        f"{result.reference.seconds:.1f}",
        f"{seconds:.1f}",
    )


HEADING = ("case", "met", "path error", "reference ±", "model", "bodies", "tried", "reference s", "whole s")

if __name__ == "__main__":
    cases = json.loads((TESTS / "data" / "reference_cases.json").read_text(encoding="utf-8"))["cases"]
    scenes = open_scenes({case["id"]: case for case in cases}).items()
    sys.exit(print_calibrations(__doc__, HEADING, scenes, calibrate, figures, time.perf_counter))
