"""The capacities of one section, on the terminal."""

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table

from capacity.units import engineering

_ROWS = (
    ("N_max", "axial force at full yield", "N"),
    ("Q_max", "shear force, walls along the load", "N"),
    ("M_max", "plastic moment", "N m"),
    ("M_yield", "moment at first yield", "N m"),
    ("Q_full_area", "shear force by the whole area", "N"),
    ("EA", "axial stiffness", "N"),
    ("GA_s", "shear stiffness", "N"),
    ("EI", "bending stiffness", "N m²"),
)


def print_capacity(values: Mapping[str, Any], console: Console) -> None:
    """A table of the quantities with their meaning and unit."""
    table = Table(
        title=f"{values['section']}, {values['material']}, {values['criterion']}",
        title_justify="left",
        show_header=False,
    )
    for key, meaning, unit in _ROWS:
        table.add_row(key, engineering(values[key], unit), meaning)
    table.add_row("shape factor", f"{values['shape_factor']:.4g}", "M_max / M_yield")
    table.add_row("mass", f"{values['mass_per_length']:.4g} kg/m", "per length")
    console.print(table)
