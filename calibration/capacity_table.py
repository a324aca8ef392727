"""The capacities of one section, on the terminal."""

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from capacity.units import engineering

_ROWS = (
    ("N_max", "N"),
    ("Q_max", "N"),
    ("M_max", "N m"),
    ("M_yield", "N m"),
    ("Q_full_area", "N"),
    ("T_max", "N m"),
)
_STIFFNESS = (
    ("EA", "axial stiffness", "N"),
    ("GA_s", "shear stiffness", "N"),
    ("EI", "bending stiffness", "N m²"),
)


def _table(title: str, header: bool = False) -> Table:
    return Table(title=title, title_justify="left", show_header=header)


def print_capacity(values: Mapping[str, Any], console: Console) -> None:
    """A table of the quantities with their unit and the rule behind each."""
    table = _table(f"{values['section']}, {values['material']}, {values['criterion']}")
    for key, unit in _ROWS:
        table.add_row(key, engineering(values[key], unit), values["rules"][key])
    for key, meaning, unit in _STIFFNESS:
        table.add_row(key, engineering(values[key], unit), meaning)
    table.add_row("shape factor", f"{values['shape_factor']:.4g}", "M_max / M_yield")
    table.add_row("mass", f"{values['mass_per_length']:.4g} kg/m", "per length")
    if "M_N" in values:
        beside = f"beside N = {engineering(values['N'], 'N')}, Q = {engineering(values['Q'], 'N')}; N-M curve, exact"
        table.add_row("M_N", engineering(values["M_N"], "N m"), beside)
    if "load_factor" in values:
        verdict = "inside the yield surface" if values["inside"] else "outside the yield surface"
        table.add_row("load factor", f"{values['load_factor']:.4g}", verdict)
    if "at_break" in values:
        at = values["at_break"]
        hinge = f"ultimate strain in a hinge of {at['hinge_length'] * 1e3:.4g} mm"
        table.add_row("plastic rotation", f"{at['plastic_rotation']:.4g} rad", hinge)
        table.add_row("elongation", f"{at['elongation'] * 1e3:.4g} mm", hinge)
    if "curve" in values:
        for kappa, moment in zip(values["curve"]["curvature"], values["curve"]["moment"], strict=True):
            table.add_row(f"M({kappa:g} 1/m)", engineering(moment, "N m"), values["curve"]["rule"])
    console.print(table)


def print_wanted(wanted: Mapping[str, Any], console: Console) -> None:
    """What a behaviour asks for, with the rule that decided."""
    table = _table("wanted")
    for key, unit in (("M_max", "N m"), ("Q_max", "N"), ("force", "N")):
        if key in wanted:
            table.add_row(key, engineering(wanted[key]["value"], unit), wanted[key]["rule"])
    if "lightest" in wanted:
        found = wanted["lightest"]
        table.add_row("section", found["section"], found["rule"])
    console.print(table)


def print_family(family: str, rows: Sequence[Mapping[str, Any]], console: Console) -> None:
    """Dimensions in the unit of the standard (mm, AISC inches), area in cm² and plastic modulus in cm³."""
    shown = [key for key in rows[0] if key not in ("area", "plastic_modulus") and not key.startswith("area_")]
    table = _table(f"{family}, {'in' if family == 'W' else 'mm'}", header=True)
    for key in shown:
        table.add_column(key, justify="left" if key == "name" else "right", no_wrap=True)
    table.add_column("A cm²", justify="right", no_wrap=True)
    table.add_column("W_pl cm³", justify="right", no_wrap=True)
    for row in rows:
        cells = [row[key] if key == "name" else f"{row[key]:g}" if key in row else "" for key in shown]
        table.add_row(*cells, f"{row['area'] * 1e4:.4g}", f"{row['plastic_modulus'] * 1e6:.4g}")
    console.print(table)
