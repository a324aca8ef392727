"""The N–M curve of a section, as a figure."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from capacity import InputError, Interaction, Material, Section


def plot_interaction(
    section: Section, material: Material, criterion: str, values: Mapping[str, Any], path: Path
) -> Path:
    """Draw the exact curve, the curve beside the shear force and the point asked about; returns ``path``.

    Raises
    ------
    InputError
        When the file cannot be written there.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    surface = Interaction(section, material, criterion)
    shear = float(values.get("Q", 0.0))
    figure = Figure(figsize=(6.0, 4.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    for Q, label in {0.0: "exact, Q = 0", shear: f"exact, Q = {shear / 1e3:.4g} kN"}.items():
        N, M = surface.curve(361, Q)
        axes.plot(M / 1e3, N / 1e3, label=label)
    if "N" in values:
        axes.plot(values.get("M", 0.0) / 1e3, values["N"] / 1e3, "o", color="black", label="(N, M) asked about")
    axes.set(xlabel="M [kN m]", ylabel="N [kN], tension positive", title=f"{section.name}, {material.name}")
    axes.axhline(0.0, color="0.8", linewidth=0.8, zorder=0)
    axes.axvline(0.0, color="0.8", linewidth=0.8, zorder=0)
    axes.legend()
    try:
        figure.savefig(path)
    except (OSError, ValueError) as error:
        raise InputError("--plot", f'"{path}" cannot be written ({error})', "write a path such as curve.svg") from error
    return path
