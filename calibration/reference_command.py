"""What ``ductile reference`` answers: an object for JSON, tables, a plot, fields."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

from calibration import motion_answer
from calibration.csv_text import csv_text
from calibration.result_cache import content_key, keep, recall
from capacity import InputError
from fem_reference import (
    MemberErrors,
    PlanePush,
    Pushover,
    field_files,
    motion,
    push_field_files,
    push_over,
    remarks,
)
from scene import Scene

_ROWS = 11


def answer(scene: Scene, tolerance: float, use_cache: bool, watch: Callable[[float], None]) -> dict[str, Any]:
    """The reference's answer to ``scene`` as one object, kept on disk or fresh; SI.

    Its "fields" are texts of files by name.
    """
    if scene.pushed is None and scene.motion is None:
        raise InputError("push", "the reference follows pushes and motions", "add [push] or [motion]")
    key = content_key(scene, tolerance)
    kept = recall(key) if use_cache else None
    if kept is not None:
        return {**kept, "cached": True}
    if scene.motion is not None:
        found = motion_answer.as_object(motion(scene, tolerance, watch=watch), scene)
    else:
        found = as_object(push_over(scene, tolerance, watch), scene)
    if use_cache:
        keep(key, found)
    return {**found, "cached": False}


def as_object(result: Pushover | PlanePush, scene: Scene) -> dict[str, Any]:
    """A result as what JSON can say; SI."""
    return {
        "displacement": result.displacement.tolist(),
        "load": result.load.tolist(),
        "hinges": [
            {
                "node": hinge.node,
                "member": hinge.member,
                "position": hinge.position,
                "load": hinge.load,
                "displacement": hinge.displacement,
                "error_estimate": hinge.error_estimate,
                "displacement_error": hinge.displacement_error,
            }
            for hinge in result.hinges
        ],
        "error_estimate": result.error_estimate,
        "method": result.method,
        "seconds": result.seconds,
        "outcome": result.outcome,
        "remarks": list(remarks(scene)),
        "elements": result.elements,
        "fibres": 0 if isinstance(result, PlanePush) else result.fibres,
        "imbalance": result.imbalance,
        "residual": result.residual,
        "residual_error": result.residual_error,
        "energy": {
            "external": result.energy.external.tolist(),
            "elastic": result.energy.elastic.tolist(),
            "plastic": result.energy.plastic.tolist(),
            "error_estimate": result.energy.error_estimate,
        },
        "fields": field_files(result.fields)
        if isinstance(result, PlanePush)
        else push_field_files(scene, result.members, result.displacement),
        "members": _members(result),
    }


def _members(result: Pushover | PlanePush) -> dict[str, Any]:
    if isinstance(result, PlanePush):
        return {
            name: {
                "point": axis.point.tolist(),
                "shape": axis.shape.tolist(),
                "error_estimate": {"shape": axis.error_estimate},
            }
            for name, axis in result.axes.items()
        }
    return {
        name: {
            "end_forces": member.end_forces[-1].tolist(),
            "point": member.point.tolist(),
            "shape": member.shape.tolist(),
            "station": member.station.tolist(),
            "axial_force": member.axial_force.tolist(),
            "moment": member.moment.tolist(),
            "curvature": member.curvature.tolist(),
            "plastic_strain": member.plastic_strain.tolist(),
            "error_estimate": _listed(result.member_errors[name]),
        }
        for name, member in result.members.items()
    }


def _listed(errors: MemberErrors) -> dict[str, Any]:
    return {name: np.asarray(value).tolist() for name, value in vars(errors).items()}


def files(found: dict[str, Any], title: str) -> dict[str, str]:
    """Text files of an answer by name."""
    if "time" in found:
        return motion_answer.files(found, title)
    energy = found["energy"]
    curve = [found["displacement"], found["load"], energy["external"], energy["elastic"], energy["plastic"]]
    head = ["displacement_m", "load", "external_J", "elastic_J", "plastic_J"]
    hinges = [list(hinge.values()) for hinge in found["hinges"]]
    hinge_head = ["node", "member", "position_m", "load", "displacement_m", "error_estimate", "displacement_error_m"]
    sections: list[list[Any]] = []
    keys = ("axial_force", "moment", "curvature", "plastic_strain")
    for name, member in found["members"].items():
        if "station" in member:
            columns = [member["station"], *(member[key] for key in keys)]
            columns += [member["error_estimate"][key] for key in keys]
            sections += [[name, *row] for row in zip(*columns, strict=True)]
    section_head = ["member", "station_m", "N_N", "M_Nm", "curvature_1_per_m", "plastic_strain"]
    section_head += [f"{name}_error" for name in section_head[2:]]
    texts = {
        "reference.csv": csv_text(head, zip(*curve, strict=True)),
        "hinges.csv": csv_text(hinge_head, hinges),
        "reference.svg": _svg(found, title),
    }
    if sections:
        texts["sections.csv"] = csv_text(section_head, sections)
    return {**texts, **found["fields"]}


def print_answer(found: dict[str, Any], console: Console) -> None:
    """Curve, hinges, energies and error estimates as tables."""
    if "time" in found:
        motion_answer.print_answer(found, console)
        return
    console.print(found["method"])
    share = 100.0 * found["error_estimate"]
    largest = max(map(abs, found["load"]))
    curve = Table(
        title=f"Load, ± {found['error_estimate'] * largest:.2g} ({share:.2g} % of the largest)", title_justify="left"
    )
    for head in ("displacement, mm", "load"):
        curve.add_column(head, justify="right")
    last = len(found["load"]) - 1
    for row in range(_ROWS):
        k = round(row * last / (_ROWS - 1))
        curve.add_row(f"{1e3 * found['displacement'][k]:.4g}", f"{found['load'][k]:.6g}")
    console.print(curve)
    hinges = Table(title="Hinges, in order", title_justify="left")
    for head in ("where", "load", "± % of largest", "displacement, mm"):
        hinges.add_column(head, justify="left" if head == "where" else "right")
    for hinge in found["hinges"]:
        where = hinge["node"] or f"{hinge['member']} at {hinge['position']:.4g} m"
        error = f"{100.0 * hinge['error_estimate']:.2g}"
        hinges.add_row(where, f"{hinge['load']:.6g}", error, f"{1e3 * hinge['displacement']:.4g}")
    console.print(hinges)
    energy = found["energy"]
    console.print(
        f"Work of the loads {energy['external'][-1]:.5g} J: elastic {energy['elastic'][-1]:.5g} J, plastic "
        f"{energy['plastic'][-1]:.5g} J, each ± {100.0 * energy['error_estimate']:.2g} % of the largest work"
    )
    console.print(f"Out of balance: {found['imbalance']:.1e} of all loads. End: {found['outcome']}.")
    for remark in found["remarks"]:
        console.print(f"Mind: {remark}.")


def _svg(found: dict[str, Any], title: str) -> str:
    """Curve with its hinges."""
    with matplotlib.rc_context({"svg.hashsalt": "ductile-joints", "svg.fonttype": "none"}):
        figure = Figure(figsize=(7.2, 4.6), layout="constrained")
        axes = figure.subplots()
        axes.plot([1e3 * d for d in found["displacement"]], found["load"], color="#1f6fb2", lw=2.0)
        for i, hinge in enumerate(found["hinges"], 1):
            place = (1e3 * hinge["displacement"], hinge["load"])
            axes.plot(*place, "o", color="#d1495b", label=f"{i}  {hinge['node'] or hinge['member']}")
            # Hinges that form together would hide each other's numbers.
            axes.annotate(f"{i}", place, (-12 + 10 * (i % 2), 6 + 6 * (i % 3)), textcoords="offset points")
        axes.set_xlabel("displacement of the pushed node [mm]")
        axes.set_ylabel("load")
        axes.set_title(title)
        axes.grid(color="#e4e8ec")
        if found["hinges"]:
            axes.legend(title="hinges, in order", loc="lower right", frameon=False, handlelength=0.0)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()
