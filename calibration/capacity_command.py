"""What ``ductile capacity`` answers: values of a section, of what it bears together, and of a wanted behaviour."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console

import capacity as package
from calibration.capacity_table import print_capacity, print_family, print_wanted
from capacity import InputError, Material, Section, catalogue
from capacity.units import positive, to_si

Value = TypeVar("Value")
Options = Mapping[str, str | None]


def list_catalogue(family: str, as_json: bool, console: Console) -> None:
    """The sections of one family with their dimensions, area and mass."""
    rows = []
    for entry in catalogue.family(family, "--list"):
        section = entry.section()
        rows.append(
            {"name": entry.name, **entry.dimensions, "area": section.area, "plastic_modulus": section.plastic_modulus}
        )
    if as_json:
        print(json.dumps(rows))
    else:
        print_family(family.upper(), rows, console)


def answer(section_text: str | None, options: Options, plot: Path | None, as_json: bool, console: Console) -> None:
    """Print what was asked about a section, a behaviour or both."""
    thickness = options["thickness"]
    thick = None if thickness is None else positive(thickness, "length", "--thickness")
    material = package.parse_material(options["material"] or "", "--material", thick)
    criterion = package.criterion_name(options["criterion"] or "", "--criterion")
    wanted = wanted_capacities(options, material, criterion)
    values: dict[str, Any] = {}
    if section_text is not None:
        section = package.parse_section(section_text, "section")
        if options["turned"] is not None:
            section = section.rotated(to_si(options["turned"], "angle", "--turned"))
        values = {**section_values(section), **capacity_values(section, material, criterion)}
        values |= together(section, material, criterion, options) | broken_at(section, material, options)
        values |= curvatures(section, material, options)
        if plot is not None:
            from calibration.capacity_plot import plot_interaction

            values["plot"] = str(plot_interaction(section, material, criterion, values, plot))
    elif not wanted:
        raise InputError("section", "there is none", 'write one such as "IPE 300", or ductile capacity --list IPE')
    if wanted:
        values["wanted"] = wanted
    if as_json:
        print(json.dumps(values))
        return
    if section_text is not None:
        print_capacity(values, console)
    if wanted:
        print_wanted(wanted, console)


def section_values(section: Section) -> dict[str, Any]:
    """Geometry of a section, SI; x and y of centroids in the axes it was drawn in."""
    across = section.rotated(0.5 * math.pi)
    i_x, i_y, i_xy = section.second_moments
    i_11, i_22, angle = section.principal_moments
    upright = section.rotated(-angle)
    upper, lower = section.elastic_moduli
    right, left = across.elastic_moduli
    x, y = section.centroid
    return {
        "section": section.name,
        "area": section.area,
        "centroid": [x, y],
        "depth": section.depth,
        "width": across.depth,
        "second_moment_of_area": section.second_moment_of_area,
        "second_moment_x": i_x,
        "second_moment_y": i_y,
        "product_moment_xy": i_xy,
        "second_moment_11": i_11,
        "second_moment_22": i_22,
        "principal_angle": angle,
        "elastic_modulus": section.elastic_modulus,
        "elastic_modulus_upper": upper,
        "elastic_modulus_lower": lower,
        "elastic_modulus_y": across.elastic_modulus,
        "elastic_modulus_right": right,
        "elastic_modulus_left": left,
        "plastic_modulus": section.plastic_modulus,
        "plastic_modulus_y": across.plastic_modulus,
        "plastic_modulus_11": upright.plastic_modulus,
        "plastic_modulus_22": upright.rotated(0.5 * math.pi).plastic_modulus,
        "plastic_centroid": [x + across.plastic_centroid, y + section.plastic_centroid],
        "shear_area": section.shear_area,
        "shear_area_x": across.shear_area,
        "wall_area": section.wall_area,
        "wall_area_x": across.wall_area,
    }


def capacity_values(section: Section, material: Material, criterion: str) -> dict[str, Any]:
    """Capacities one by one, and the rule behind each."""
    result = package.capacity(section, material, criterion)
    own = [part.material or material for part in section.parts]
    mass = sum(m.density * float(part.outline.moments()[0]) for m, part in zip(own, section.parts, strict=True))
    solid = all(part.walls is None for part in section.parts)
    ratio = f"{package.shear_ratio(criterion):.4g} fy ({criterion})"
    return {
        **result.values(),
        "T_max": package.torsion_capacity(section, material, criterion),
        "curvature_at_yield": result.M_yield / result.EI,
        "material": material.name,
        "criterion": criterion,
        "youngs_modulus": material.youngs_modulus,
        "yield_stress": material.yield_stress,
        "tangent_modulus": material.tangent_modulus,
        "density": material.density,
        "mass_per_length": mass,
        "rules": {
            "N_max": "integral (1): fy over the whole area",
            "Q_max": f"integral (2): {ratio} over "
            + ("the whole area, solid" if solid else "the walls along the load"),
            "Q_full_area": f"integral (2): {ratio} over the whole area",
            "M_max": "integral (3): fy |y - y_pc| over the whole area",
            "M_yield": "fy at the face farther from the centroid",
            "T_max": f"sand heap: {ratio} over the whole area",
        },
    }


def together(section: Section, material: Material, criterion: str, options: Options) -> dict[str, Any]:
    """What the section bears of N, Q and M at once, when any of them is given."""
    given = {"N": "axial-force", "Q": "shear-force", "M": "moment"}
    if all(options[name] is None for name in given.values()):
        return {}
    kinds = {"N": "force", "Q": "force", "M": "moment"}
    N, Q, M = (to_si(options[name] or 0.0, kinds[symbol], f"--{name}") for symbol, name in given.items())
    surface = package.Interaction(section, material, criterion)
    least, greatest = surface.moments_at(N, Q)
    facets = surface.facets()
    values: dict[str, Any] = {
        "N": N,
        "Q": Q,
        "M_N": greatest,
        "M_N_over_M_max": greatest / surface.M_max,
        "moments_borne": [least, greatest],
        "facets": len(facets.fixed),
        "facets_error": facets.error,
    }
    if options["moment"] is not None or M != 0.0:
        factor = surface.load_factor(N, Q, M)
        values |= {"M": M, "load_factor": factor, "inside": factor >= 1.0}
    return values


def broken_at(section: Section, material: Material, options: Options) -> dict[str, Any]:
    """Rotation and elongation at break, when every material has an ultimate strain."""
    length = options["hinge-length"]
    materials = [part.material or material for part in section.parts]
    if length is None and any(math.isinf(m.stress_strain.ultimate_strain) for m in materials):
        return {}
    hinge = None if length is None else positive(length, "length", "--hinge-length")
    N = to_si(options["axial-force"] or 0.0, "force", "--axial-force")
    return {"at_break": asdict(package.rotation_capacity(section, material, hinge, N))}


def curvatures(section: Section, material: Material, options: Options) -> dict[str, Any]:
    """Moments at the curvatures asked for: exact while they grow, by fibres once one unloads."""
    text = options["curvature"]
    if text is None:
        return {}
    kappa = [to_si(item, "curvature", "--curvature") for item in text.split(",")]
    N = to_si(options["axial-force"] or 0.0, "force", "--axial-force")
    sizes = [0.0, *(abs(k) for k in kappa)]
    loads = all(a <= b for a, b in itertools.pairwise(sizes)) and len({k > 0.0 for k in kappa if k}) < 2
    found = (package.moment_curvature if loads else package.moment_history)(section, material, kappa, N)
    return {
        "curve": {
            "curvature": found.curvature.tolist(),
            "moment": found.moment.tolist(),
            "centre_strain": found.centre_strain.tolist(),
            "broken": found.broken.tolist(),
            "rule": "exact integration on first loading" if loads else "fibres that remember their slips",
        }
    }


def wanted_capacities(options: Options, material: Material, criterion: str) -> dict[str, Any]:
    """Capacities that a wanted behaviour asks for, each with its rule, and the rule that decides."""
    from capacity import behaviour

    asked: dict[str, list[behaviour.Demand]] = {"M_max": [], "force": [], "Q_max": []}
    answer: dict[str, Any] = {}
    if options["largest-rotation"] is not None:
        rotation = positive(options["largest-rotation"], "angle", "--largest-rotation")
        stiffness = _stiffness(options, "rotational stiffness", "moment of inertia", answer)
        asked["M_max"].append(behaviour.from_elastic_rotation(stiffness, rotation))
    if options["largest-deflection"] is not None:
        deflection = positive(options["largest-deflection"], "length", "--largest-deflection")
        stiffness = _stiffness(options, "stiffness", "mass", answer)
        asked["force"].append(behaviour.from_elastic_deflection(stiffness, deflection))
    if options["own-weight-share"] is not None:
        own = positive(_needed(options, "own-weight-moment", "own-weight-share"), "moment", "--own-weight-moment")
        share = to_si(options["own-weight-share"], "number", "--own-weight-share")
        asked["M_max"].append(_told("--own-weight-share", lambda: behaviour.from_own_weight_share(own, share)))
    if options["plastic-share"] is not None:
        own = positive(_needed(options, "own-weight-moment", "plastic-share"), "moment", "--own-weight-moment")
        reserve = positive(_needed(options, "plastic-rotation", "plastic-share"), "angle", "--plastic-rotation")
        share = to_si(options["plastic-share"], "number", "--plastic-share")
        stiffness = _stiffness(options, "rotational stiffness", "moment of inertia", answer)
        damping = (
            to_si(options["damping-ratio"] or 0.0, "number", "--damping-ratio") if options["damping-ratio"] else 0.0
        )
        asked["M_max"].append(
            _told("--plastic-share", lambda: behaviour.from_plastic_share(own, stiffness, reserve, share, damping))
        )
    if options["heaviest-vehicle"] is not None:
        bridge, gravity = _bridge(options)
        entries = (
            catalogue.entries().values()
            if options["family"] is None
            else catalogue.family(options["family"], "--family")
        )
        choice = behaviour.lightest_for_bridge(bridge, material, entries, criterion, gravity)
        asked["M_max"].append(choice.demand_M)
        asked["Q_max"].append(choice.demand_Q)
        answer["lightest"] = {
            "section": choice.section.name,
            "M_max": choice.M_max,
            "Q_max": choice.Q_max,
            "mass_per_length": material.density * choice.section.area,
            "rule": f"the lightest of the catalogue with both; decided by {choice.decided}",
        }
    for quantity, demands in asked.items():
        if demands:
            most = max(demands, key=lambda demand: demand.value)
            answer[quantity] = {**asdict(most), "all": [asdict(demand) for demand in demands]}
    return answer


def _stiffness(options: Options, quantity: str, inertia: str, answer: dict[str, Any]) -> float:
    """Stiffness as given, or from the frequency and the inertia of the bodies joined."""
    from capacity.behaviour import reduced, stiffness_and_damping

    if options["stiffness"] is not None:
        return positive(options["stiffness"], quantity, "--stiffness")
    if options["frequency"] is None:
        raise InputError("--stiffness", "neither it nor --frequency is given", 'write one such as --frequency "1 Hz"')
    frequency = positive(options["frequency"], "frequency", "--frequency")
    first = positive(_needed(options, "inertia", "frequency"), inertia, "--inertia")
    other = options["other-inertia"]
    second = math.inf if other is None else positive(other, inertia, "--other-inertia")
    damping = to_si(options["damping-ratio"] or 0.0, "number", "--damping-ratio")
    k, c = _told("--damping-ratio", lambda: stiffness_and_damping(frequency, damping, reduced(first, second)))
    answer |= {"stiffness": k, "damping": c}
    return k


def _bridge(options: Options) -> tuple[Any, float]:
    from capacity.behaviour import Bridge

    gravity = positive(options["gravity"] or "", "acceleration", "--gravity")
    mass = positive(options["heaviest-vehicle"] or "", "mass", "--heaviest-vehicle")
    span = positive(_needed(options, "span", "heaviest-vehicle"), "length", "--span")
    at = [to_si(options[name] or 0.5 * span, "length", f"--{name}") for name in ("vehicle-at", "joint-at")]
    return Bridge(span, mass * gravity, at[0], at[1]), gravity


def _needed(options: Options, name: str, because: str) -> str:
    value = options[name]
    if value is None:
        raise InputError(f"--{name}", f"it is missing, and --{because} needs it", f"write --{name} VALUE")
    return value


def _told(option: str, ask: Callable[[], Value]) -> Value:
    try:
        return ask()
    except InputError as error:
        raise error.at(option) from error
