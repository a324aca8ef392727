"""What can be fitted: factors and values that take the place of what a scene and a model say.

They multiply or replace what the scene says of all its members:

    stiffness     of E (and so of EA, GA_s, EI)
    strength      of the yield stress
    spread        s: half of every fibre yields at (1 - s) fy, the other half at (1 + s) fy
    hardening     E_t / E beyond yield, in place of the material's
    reserve       r: fibres begin to yield at (1 - r) fy and harden up to fy; beyond, the slope is the material's own
    hinge_length  of the rule "radau", as a multiple of the section's depth
    damping       viscous damping as a share of stiffness [s], as of `sim.Model`

A fibre with all of the first five is elements in parallel (Besseling): two halves that yield apart, and one of
stiffness E_t that yields last. That is what a deep beam asks for: it yields early where clamp and shear concentrate
stresses; then it goes on to harden, for a clamp holds the section's width (2 / √3 fy in plane stress) and shear moves
the hinge away from the root; and then it bears no more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import msgspec
import numpy as np

from capacity import InputError, Material, StressStrain
from scene import Scene
from sim import Model

Name = Literal["stiffness", "strength", "spread", "hardening", "reserve", "hinge_length", "damping"]
#: Start and bounds of each parameter.
BOUNDS: dict[Name, tuple[float, float, float]] = {
    "stiffness": (1.0, 0.5, 1.5),
    "strength": (1.0, 0.5, 2.0),
    "spread": (0.1, 0.0, 0.6),
    "hardening": (0.01, 0.0, 0.2),
    "reserve": (0.1, 0.0, 0.5),
    "hinge_length": (1.0, 0.25, 4.0),
    "damping": (1e-3, 0.0, 0.02),
}
#: What a deep beam asks for.
DEEP_BEAM: tuple[Name, ...] = ("stiffness", "strength", "spread", "hardening", "reserve")


def check_parameters(names: Sequence[Name], model: Model) -> None:
    """Raise InputError for a parameter that ``model`` does not have, or that says nothing without another."""
    if "hinge_length" in names and model.rule != "radau":
        raise InputError("hinge_length", f'the rule "{model.rule}" has none', 'take the rule "radau"')
    if "reserve" in names and "hardening" not in names:
        raise InputError("reserve", "it is where fitted hardening ends", 'vary "hardening", too')


def fitted(scene: Scene, model: Model, parameters: Mapping[Name, float]) -> tuple[Scene, Model]:
    """``scene`` and ``model`` with ``parameters`` in place."""
    members = {
        name: msgspec.structs.replace(member, material=_fitted_material(member.material, parameters))
        for name, member in scene.members.items()
    }
    if "damping" in parameters:
        model = replace(model, damping=parameters["damping"])
    if "hinge_length" in parameters:
        depth = max(float(member.section.depth) for member in scene.members.values())
        model = replace(model, hinge_length=parameters["hinge_length"] * depth)
    return msgspec.structs.replace(scene, members=members), model


def _fitted_material(material: Material, parameters: Mapping[Name, float]) -> Material:
    E = material.youngs_modulus * parameters.get("stiffness", 1.0)
    fy = material.yield_stress * parameters.get("strength", 1.0)
    own = E * material.tangent_modulus / material.youngs_modulus
    hardening = E * parameters["hardening"] if "hardening" in parameters else own
    spread, reserve = parameters.get("spread", 0.0), parameters.get("reserve", 0.0)
    curve = material.curve
    if spread > 0.0 or reserve > 0.0:
        slopes = (hardening, min(own, hardening) if "reserve" in parameters else hardening)
        curve = _backbone(E, fy, spread, reserve, slopes, material.ultimate_strain)
        hardening = slopes[1]
    elif curve is not None:
        scale = E / material.youngs_modulus
        curve = StressStrain(curve.breaks * (fy / material.yield_stress / scale), curve.slopes * scale)
    name = f"{material.name} fitted"
    return Material(name, E, fy, material.density, material.poissons_ratio, hardening, material.ultimate_strain, curve)


def _backbone(
    E: float, fy: float, spread: float, reserve: float, slopes: tuple[float, float], ultimate_strain: float
) -> StressStrain:
    """Stress and strain of a fibre that yields bit by bit and hardens up to ``fy``; stresses and moduli in Pa.

    It hardens with the first of ``slopes`` and goes on with the second.
    """
    hardening, last = slopes
    first = (1.0 - reserve) * fy / E
    # By strain at yield, the moduli of the elements in parallel.
    elements = [((1.0 - spread) * first, 0.5 * (E - hardening)), ((1.0 + spread) * first, 0.5 * (E - hardening))]
    if hardening > last:
        # Until the line that the halves have come to, (1 - E_t / E) (1 - r) fy + E_t ε, is at fy.
        elements.append((max(first + reserve * fy / hardening, elements[1][0]), hardening - last))
    breaks, which = np.unique([strain for strain, _ in elements], return_inverse=True)
    drops = np.bincount(which, weights=[modulus for _, modulus in elements])
    return StressStrain(breaks, E - np.append(0.0, np.cumsum(drops)), ultimate_strain)
