"""Calibrate sixteen motions: which targets are met, by which model, in what time.

    python benchmarks/motions.py [--target-error 0.01] [NAME ...]

NAME is a pattern such as "struck-*"; all of them by default. Ends with 1 when a target is missed.
"""

import sys
import time
from collections.abc import Iterator, Mapping, Sequence

from calibrated_scenes import print_calibrations

from calibration import MotionCalibration, calibrate_motion
from calibration.tables import in_words

STRIP, BEAM, COLUMN = "rectangle 50x100 mm", "IPE 300", "HEB 200"
DOWN, RIGHT = "[0, -1]", "[1, 0]"


def scene(
    section: str,
    nodes: Mapping[str, tuple[float, float, str]],
    members: Sequence[str],
    motion: str,
    *,
    at: Mapping[str, str] | None = None,
    loads: Sequence[str] = (),
    gravity: float = 9.81,
) -> str:
    """A scene of S235; members are named by their two nodes, and ``at`` says what moves at a node."""
    lines = ['title = "motion"', f"gravity = {gravity}"]
    for name, (x, y, support) in nodes.items():
        lines += [f"[nodes.{name}]", f"at = [{x}, {y}]", f'support = "{support}"', (at or {}).get(name, "")]
    for member in members:
        lines += [f"[members.{member}]", f'from = "{member[0]}"', f'to = "{member[1]}"']
        lines += [f'section = "{section}"', 'material = "S235"']
    for load in loads:
        lines += ["[[loads]]", 'kind = "step"', load]
    return "\n".join([*lines, "[motion]", motion])


def struck(mass: float, x: float, y: float) -> str:
    """A body that strikes a node with a velocity."""
    return f"mass = {mass}\nvelocity = [{x}, {y}]"


def motion(duration: float, watch: str, direction: str, fall: float = 0.0) -> str:
    """For how long, what is watched, and from what speed of a fall."""
    return f'duration = {duration}\nwatch = "{watch}"\ndirection = {direction}\nvelocity = [0, {-fall}]'


def cantilevers() -> Iterator[tuple[str, str]]:
    """Struck, let go, and loaded at once."""
    long = {"A": (0.0, 0.0, "clamped"), "B": (2.0, 0.0, "free")}
    short = {"A": (0.0, 0.0, "clamped"), "B": (1.5, 0.0, "free")}
    halves = {"A": (0.0, 0.0, "clamped"), "M": (1.0, 0.0, "free"), "B": (2.0, 0.0, "free")}
    for name, mass, speed, duration in (
        ("struck-tip-equal-mass", 78.5, 10.0, 0.25),
        ("struck-tip-five-masses", 392.0, 4.0, 0.4),
        ("struck-tip-fifth-of-mass", 16.0, 15.0, 0.2),
    ):
        going = {"B": struck(mass, 0.0, -speed)}
        yield name, scene(STRIP, long, ["AB"], motion(duration, "B", DOWN), at=going, gravity=0.0)
    going = {"M": struck(150.0, 0.0, -6.0)}
    yield "struck-cantilever-middle", scene(STRIP, halves, ["AM", "MB"], motion(0.2, "M", DOWN), at=going, gravity=0.0)
    going = {"B": struck(40.0, 0.0, -0.4)}
    yield "free-vibration", scene(STRIP, short, ["AB"], motion(0.2, "B", DOWN), at=going, gravity=0.0)
    going, load = {"B": "mass = 500"}, 'node = "B"\nforce = [0, -5e3]'
    elastic = scene(STRIP, short, ["AB"], motion(0.3, "B", DOWN), at=going, loads=[load], gravity=0.0)
    yield "sudden-heavy-tip", elastic
    load = 'node = "B"\nforce = [0, -12e3]'
    yield "sudden-own-mass", scene(STRIP, long, ["AB"], motion(0.2, "B", DOWN), loads=[load])


def beams() -> Iterator[tuple[str, str]]:
    """Struck off their middle, falling, and loaded evenly at once."""
    fixed = {"A": (0.0, 0.0, "clamped"), "C": (2.0, 0.0, "free"), "B": (6.0, 0.0, "clamped")}
    going = {"C": struck(800.0, 0.0, -5.0)}
    yield "struck-fixed-beam-third", scene(BEAM, fixed, ["AC", "CB"], motion(0.25, "C", DOWN), at=going)
    simple = {"A": (0.0, 0.0, "pinned"), "C": (1.5, 0.0, "free"), "B": (5.0, 0.0, "roller-x")}
    going = {"C": struck(300.0, 0.0, -0.3)}
    yield "struck-beam-elastic", scene(COLUMN, simple, ["AC", "CB"], motion(0.3, "C", DOWN), at=going)
    ends = {"A": (0.0, 0.0, "pinned"), "M": (2.0, 0.0, "free"), "B": (4.0, 0.0, "roller-x")}
    yield "falling-beam", scene("IPE 100", ends, ["AM", "MB"], motion(0.3, "M", DOWN, 7.67))
    over = {"A": (0.0, 0.0, "pinned"), "B": (3.0, 0.0, "roller-x"), "C": (4.5, 0.0, "free")}
    yield "falling-overhang", scene("IPE 100", over, ["AB", "BC"], motion(0.3, "C", DOWN, 4.43))
    fixed = {"A": (0.0, 0.0, "clamped"), "C": (4.0, 0.0, "free"), "B": (8.0, 0.0, "clamped")}
    loads = [f'member = "{name}"\nper_length = [0, -26e3]' for name in ("AC", "CB")]
    yield "sudden-even-load", scene(BEAM, fixed, ["AC", "CB"], motion(0.5, "C", DOWN), loads=loads)


def portals() -> Iterator[tuple[str, str]]:
    """Pushed sideways at once, struck on the beam, struck on a column."""
    nodes = {
        "A": (0.0, 0.0, "clamped"),
        "B": (0.0, 4.0, "free"),
        "C": (3.0, 4.0, "free"),
        "D": (6.0, 4.0, "free"),
        "E": (6.0, 0.0, "clamped"),
    }
    members = ["AB", "BC", "CD", "ED"]
    for name, force in (("sudden-portal-elastic", 30e3), ("sudden-portal-yields", 95e3)):
        load = f'node = "B"\nforce = [{force}, 0]'
        yield name, scene(BEAM, nodes, members, motion(1.0, "B", RIGHT), at={"B": "mass = 2000"}, loads=[load])
    going = {"C": struck(1500.0, 0.0, -4.0)}
    yield "struck-portal-beam", scene(BEAM, nodes, members, motion(0.6, "C", DOWN), at=going)
    cut = {**nodes, "C": (0.0, 1.5, "free")}
    going = {"C": struck(1000.0, 6.0, 0.0)}
    yield "struck-portal-column", scene(COLUMN, cut, ["AC", "CB", "BD", "ED"], motion(0.3, "C", RIGHT), at=going)


def figures(result: MotionCalibration, seconds: float) -> tuple[str, ...]:
    best = result.best
    return (
        f"{100.0 * best.errors.peak:+.2f} %, {100.0 * best.errors.residual:+.2f} %",
        f"{100.0 * result.uncertainty:.2f} %",
        in_words(best.model, result.scene.members),
        f"{1.0 / best.model.dt:.0f}",
        f"{len(result.trials)}",
        f"{seconds:.1f} s",
    )


HEADING = ("motion", "met", "peak, rest", "reference ±", "model", "steps a second", "tried", "processor time")

if __name__ == "__main__":
    motions = (*cantilevers(), *beams(), *portals())
    sys.exit(print_calibrations(__doc__, HEADING, motions, calibrate_motion, figures, time.process_time))
