"""What ``ductile reference`` answers to a scene with a motion: an object for JSON, tables, files."""

from __future__ import annotations

import io
from typing import Any

import matplotlib
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

from calibration.csv_text import csv_text
from fem_reference import MotionResult, motion_field_files, remarks
from scene import Scene

_ROWS = 11
_HINGE = ("node", "member", "position", "time", "time_error", "position_error")
_ENERGIES = ("kinetic", "elastic", "plastic", "external")


def as_object(result: MotionResult, scene: Scene) -> dict[str, Any]:
    """A motion as what JSON can say; SI. It has no load."""
    return {
        "time": result.time.tolist(),
        "displacement": result.displacement.tolist(),
        "load": [],
        "hinges": [{name: getattr(hinge, name) for name in _HINGE} for hinge in result.hinges],
        "error_estimate": result.error_estimate,
        "method": result.method,
        "seconds": result.seconds,
        "remarks": list(remarks(scene)),
        "node": result.node,
        "peak": result.peak,
        "peak_time": result.peak_time,
        "peak_error": result.peak_error,
        "displacements": {name: path.tolist() for name, path in result.displacements.items()},
        "residual": {name: list(moved) for name, moved in result.residual.items()},
        "residual_error": result.residual_error,
        "energy": {
            **{name: getattr(result, name).tolist() for name in _ENERGIES},
            "error_estimate": result.energy_error,
        },
        "fields": motion_field_files(scene, result.members, result.member_time),
        "elements": result.elements,
        "fibres": result.fibres,
        "steps": result.steps,
    }


def files(found: dict[str, Any], title: str) -> dict[str, str]:
    """Text files of an answer by name."""
    nodes = found["displacements"]
    head = ["time_s", "displacement_m", *(f"{name}_J" for name in _ENERGIES)]
    head += [f"{name}_{axis}_m" for name in nodes for axis in "xy"]
    columns = [found["time"], found["displacement"], *(found["energy"][name] for name in _ENERGIES)]
    rows = zip(*columns, *([row[i] for row in path] for path in nodes.values() for i in (0, 1)), strict=True)
    residual = [[name, *moved, found["residual_error"]] for name, moved in found["residual"].items()]
    hinge_head = ["node", "member", "position_m", "time_s", "time_error_s", "position_error_m"]
    return {
        "reference.csv": csv_text(head, rows),
        "hinges.csv": csv_text(hinge_head, [list(hinge.values()) for hinge in found["hinges"]]),
        "residual.csv": csv_text(["node", "x_m", "y_m", "error_m"], residual),
        "reference.svg": _svg(found, title),
        **found["fields"],
    }


def print_answer(found: dict[str, Any], console: Console) -> None:
    """Peak, motion, energies, hinges and residual displacements, each with its error."""
    console.print(found["method"])
    console.print(
        f"Peak of {found['node']}: {1e3 * found['peak']:.5g} mm ± {1e3 * found['peak_error']:.2g} mm "
        f"at {1e3 * found['peak_time']:.4g} ms"
    )
    share = f"{100.0 * found['error_estimate']:.2g} % of the peak at any time"
    moved = Table(title=f"Displacement of {found['node']}, ± {share}", title_justify="left")
    energy = found["energy"]
    for name in ("time, ms", "displacement, mm", *(f"{name}, J" for name in _ENERGIES)):
        moved.add_column(name, justify="right")
    last = len(found["time"]) - 1
    for row in range(_ROWS):
        k = round(row * last / (_ROWS - 1))
        values = (1e3 * found["time"][k], 1e3 * found["displacement"][k], *(energy[name][k] for name in _ENERGIES))
        moved.add_row(*(f"{value:.4g}" for value in values))
    console.print(moved)
    console.print(f"Energies ± {100.0 * energy['error_estimate']:.2g} % of the largest")
    hinges = Table(title="Hinges, in order", title_justify="left")
    for name in ("where", "time, ms", "±"):
        hinges.add_column(name, justify="left" if name == "where" else "right")
    for hinge in found["hinges"]:
        where = hinge["node"] or f"{hinge['member']} at {hinge['position']:.4g} m"
        error = "not in the coarser models" if hinge["time_error"] is None else f"{1e3 * hinge['time_error']:.2g}"
        hinges.add_row(where, f"{1e3 * hinge['time']:.4g}", error)
    console.print(hinges)
    rest = Table(title=f"At rest, ± {1e3 * found['residual_error']:.2g} mm", title_justify="left")
    for name in ("node", "x, mm", "y, mm"):
        rest.add_column(name, justify="left" if name == "node" else "right")
    for name, (x, y) in found["residual"].items():
        rest.add_row(name, f"{1e3 * x:.4g}", f"{1e3 * y:.4g}")
    console.print(rest)
    for remark in found["remarks"]:
        console.print(f"Mind: {remark}.")


def _svg(found: dict[str, Any], title: str) -> str:
    """The watched displacement over time, and where the energy is."""
    with matplotlib.rc_context({"svg.hashsalt": "ductile-joints", "svg.fonttype": "none"}):
        figure = Figure(figsize=(7.2, 6.4), layout="constrained")
        above, below = figure.subplots(2, sharex=True)
        time = [1e3 * t for t in found["time"]]
        above.plot(time, [1e3 * d for d in found["displacement"]], color="#1f6fb2", lw=2.0)
        above.set_ylabel(f"displacement of {found['node']} [mm]")
        above.set_title(title)
        for name, colour in zip(_ENERGIES, ("#1f6fb2", "#2a9d8f", "#d1495b", "#8d99ae"), strict=True):
            below.plot(time, found["energy"][name], color=colour, lw=1.6, label=name)
        below.set_ylabel("energy [J]")
        below.set_xlabel("time [ms]")
        below.legend(frameon=False)
        for axes in (above, below):
            axes.grid(color="#e4e8ec")
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()
