"""Calibrate every reference case of a push, as scene files: which targets are met, by which model, in what time.

    python benchmarks/open_cases.py [--target-error 0.01] [NAME ...]

NAME is a pattern such as "C2-portal-*"; all cases by default. Ends with 1 when a target is missed.
"""

import argparse
import fnmatch
import json
import sys
import time
from pathlib import Path

TESTS = Path(__file__).parent.parent / "tests"
sys.path.insert(0, str(TESTS))

from open_scenes import open_scenes  # noqa: E402  (beside the tests, which use them, too)

from calibration import calibrate  # noqa: E402
from calibration.tables import in_words  # noqa: E402
from scene import parse_scene  # noqa: E402


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=["*"])
    parser.add_argument("--target-error", type=float, default=0.01)
    asked = parser.parse_args()
    cases = json.loads((TESTS / "data" / "reference_cases.json").read_text(encoding="utf-8"))["cases"]
    missed = 0
    print("| case | met | path error | reference ± | model | bodies | tried | reference s | whole s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, text in open_scenes({case["id"]: case for case in cases}).items():
        if not any(fnmatch.fnmatch(name, pattern) for pattern in asked.names):
            continue
        started = time.perf_counter()
        result = calibrate(parse_scene(text, name), asked.target_error, name)
        whole = time.perf_counter() - started
        missed += not result.target_met
        best = result.best
        cells = (
            name,
            "yes" if result.target_met else f"**no**: {result.limit}",
            f"{100.0 * best.errors.path_max:.3f} %",
            f"{100.0 * result.reference.error_estimate:.3f} %",
            f"{in_words(best.model, result.scene.members)}, 1/dt {1.0 / best.model.dt:.0f}",
            f"{best.push.bodies}",
            f"{len(result.trials)}",
            f"{result.reference.seconds:.1f}",
            f"{whole:.1f}",
        )
        print(f"| {' | '.join(cells)} |", flush=True)
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
