"""Step random structures (`tests/random_cases.py`): which of them create energy, do not converge, or bear too much.

    python benchmarks/random_structures.py FIRST COUNT [--jobs 2]

Prints a line for each seed in which something is not as it is held to be in `tests/test_sim_random_structures.py`, and
a summary.
"""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from random_cases import RandomCase
from watched_cases import Watched, watch

from sim import IMPLICIT_EULER


def look_at(seed: int) -> tuple[int, str, bool, Watched, float]:
    """What became of a seed, and how long it took [s]."""
    started, case = time.perf_counter(), RandomCase(seed)
    found = watch(case)
    return seed, str(case), case.scheme == IMPLICIT_EULER, found, time.perf_counter() - started


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--jobs", type=int, default=1)
    wanted = parser.parse_args()
    seeds = range(wanted.first, wanted.first + wanted.count)
    rows = []
    with ProcessPoolExecutor(wanted.jobs) as pool:
        for seed, case, default, found, seconds in pool.map(look_at, seeds):
            rows.append((default, found))
            faults = found.faults(default)
            if faults:
                print(f"{seed}: {case}, {seconds:.0f} s: {'; '.join(faults)}", flush=True)
    for default, name in ((True, "implicit Euler"), (False, "second order")):
        of_scheme = [found for own, found in rows if own == default]
        if of_scheme:
            print(f"\n{len(of_scheme)} by {name}")
            for what, count, worst in Watched.summary(of_scheme, default):
                print(f"  {what}: {count}, worst {worst:.1e}")


if __name__ == "__main__":
    main()
