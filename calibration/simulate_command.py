"""What ``ductile simulate`` answers: the run of a scene, as an object for JSON, a table, and joints over time."""

from __future__ import annotations

import csv
import io
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from calibration.live_window import live
from capacity.units import engineering
from sim.joint_arrays import JointArrays
from sim.measures import UNITS
from sim.recorded import Recording
from sim.world import World

_COLUMNS = (
    ("N_N", "Q_N", "M_Nm"),
    ("extension_m", "slip_m", "rotation_rad"),
)


class JointTable:
    """All joints of a world over time, as CSV.

    Parameters
    ----------
    world : World
    every : float
        Simulated time between two rows of a joint [s]; no less than a step.
    """

    def __init__(self, world: World, every: float) -> None:
        self._world, self._every = world, every
        self._text = io.StringIO()
        self._writer = csv.writer(self._text, lineterminator="\n")
        self._next = 0.0
        forces, deformations = _COLUMNS
        self._writer.writerow(["time_s", "joint", *forces, *deformations, "capacity_used", "dissipated_J", "broken"])

    def note(self) -> None:
        """Write the joints as they are, when it is time."""
        if self._world.time < self._next - 1e-9:
            return
        self._next += self._every
        joints = self._world.all_joints
        read = JointArrays(joints)
        columns = [read.force, read.deformation, read.capacity_used[:, None], read.dissipated[:, None]]
        for joint, numbers in zip(joints, np.hstack(columns).tolist(), strict=True):
            label = self._world.labels[joint]
            cells = [f"{number:.9g}" for number in numbers]
            self._writer.writerow([f"{self._world.time:.9g}", label, *cells, int(joint.broken)])

    def text(self) -> str:
        """The whole table."""
        return self._text.getvalue()


def run(world: World, after_step: Callable[[], None], watch: Callable[[str, float], None]) -> float:
    """Step ``world`` to its end; the seconds that the steps took.

    ``after_step`` is called after each; ``watch`` is told the real-time factor and the finished share.
    """
    spent = 0.0
    steps = 0
    while not world.finished:
        started = time.perf_counter()
        world.step()
        spent += time.perf_counter() - started
        after_step()
        steps += 1
        if steps % 16 == 0:
            watch(f"{world.time:.2f} s simulated, {world.time / spent:.3g} × real time", world.time / world.duration)
    return spent


def run_in_window(world: World, after_step: Callable[[], None]) -> float:
    """Step ``world`` in a window until that is closed; the seconds that the steps took."""
    spent = 0.0

    def step() -> None:
        nonlocal spent
        started = time.perf_counter()
        world.step()
        spent += time.perf_counter() - started
        after_step()

    live(world.space, step, world.dt, lambda: world.finished, world.scene.title)
    return spent


def energy_table(recording: Recording) -> str:
    """The energy ledger over time, as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time_s", *(f"{name}_J" for name in recording.energy)])
    for row in zip(recording.time, *recording.energy.values(), strict=True):
        writer.writerow([f"{number:.9g}" for number in row])
    return text.getvalue()


def as_object(world: World, name: str, seconds: float, recording: Recording) -> dict[str, Any]:
    """The answer as one object; SI. A figure that there is none of is null."""
    joints = world.all_joints
    read = JointArrays(joints)
    used = read.capacity_used.tolist()
    structures = {joint.structure for joint in joints if joint.structure is not None}
    most = max(range(len(joints)), key=used.__getitem__, default=None)
    answer: dict[str, Any] = {
        "scene": name,
        "title": world.scene.title,
        "dt": world.dt,
        "iterations": world.space.iterations,
        "steps": world.steps,
        "simulated_seconds": world.time,
        "seconds": seconds,
        "real_time_factor": world.time / seconds if seconds > 0.0 else None,
        "measures": {name: _finite(value) for name, value in world.results().items()},
        "units": {name: UNITS[measure.quantity] for name, measure in world.scene.measures.items()},
        "joints": {
            "count": len(joints),
            "yielded": int(read.plastic_deformation.any(axis=1).sum()),
            "broken": [{"joint": label, "time": moment} for moment, label in world.broken],
            "most_used": None if most is None else {"joint": world.labels[joints[most]], "capacity_used": used[most]},
            "plastic_work": float(read.dissipated.sum()),
        },
        "refined": [{"member": name, "time": moment} for moment, name in world.refined],
        "energy": {account: float(values[-1]) for account, values in recording.energy.items()},
        "unconverged": sum(structure.unconverged for structure in structures),
    }
    if world.push is not None:
        answer["push"] = {
            "displacement": world.push.displacement,
            "load": world.push.load,
            "load_is_factor": bool(world.scene.loads_of("proportional")),
        }
    return answer


def _finite(value: float | list[float]) -> float | list[float | None] | None:
    if isinstance(value, list):
        return [number if math.isfinite(number) else None for number in value]
    return value if math.isfinite(value) else None


def key_figures(answer: dict[str, Any]) -> list[tuple[str, str]]:
    """What a person wants to know of an answer, and its value with its unit; the same at any speed."""
    figures = []
    for name, value in answer["measures"].items():
        unit = answer["units"][name]
        values = value if isinstance(value, list) else [value]
        figures.append((name, ", ".join("–" if v is None else _shown(v, unit) for v in values) or "–"))
    if "push" in answer:
        figures.append(("pushed by", engineering(answer["push"]["displacement"], "m")))
        factor = answer["push"]["load_is_factor"]
        figures.append(
            ("load factor" if factor else "load at the end", f"{answer['push']['load']:.5g}{'' if factor else ' N'}")
        )
    joints = answer["joints"]
    broken = ", ".join(f"{entry['joint']} at {entry['time']:.3f} s" for entry in joints["broken"]) or "none"
    figures.append(("joints", f"{joints['count']}, of which {joints['yielded']} yielded; broken: {broken}"))
    if answer["refined"]:
        figures.append(
            ("refined", ", ".join(f"{entry['member']} at {entry['time']:.3f} s" for entry in answer["refined"]))
        )
    most = joints["most_used"]
    if most is not None and most["capacity_used"] > 0.0:
        figures.append(("most used joint", f"{most['joint']}, {most['capacity_used']:.1%} of its plastic capacity"))
    figures.append(("plastic work in joints", engineering(joints["plastic_work"], "J")))
    length = engineering(answer["dt"], "s")
    if answer["steps"] > 1.01 * answer["simulated_seconds"] / answer["dt"]:
        length += " and of parts of it"
    figures.append(("steps", f"{answer['steps']} of {length}, {answer['iterations']} iterations"))
    if answer["unconverged"]:
        figures.append(("steps that did not converge", str(answer["unconverged"])))
    return figures


def print_answer(answer: dict[str, Any], console: Console) -> None:
    """Key figures for a person."""
    console.print(f"[bold]{answer['title']}[/bold]")
    table = Table("", "", box=None, show_header=False)
    for row in key_figures(answer):
        table.add_row(*row)
    if answer["real_time_factor"] is not None:
        table.add_row("speed", f"{answer['real_time_factor']:.3g} × real time")
    console.print(table)


def _shown(value: float, unit: str) -> str:
    if unit in ("", "rad"):
        return f"{value:.4g} {unit}".rstrip()
    return engineering(value, unit)
