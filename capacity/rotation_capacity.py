"""How far a hinge turns and how far it stretches until it breaks.

A hinge of length L_h in which curvature is even breaks when a fibre reaches the ultimate strain. Its plastic rotation
is then (κ_u - M_u / EI) L_h, and a bar that is stretched to ε_u keeps the plastic elongation (ε_u - σ_u / E) L_h.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from capacity.errors import InputError
from capacity.materials import Material
from capacity.moment_curvature import moment_curvature
from capacity.sections import Section

#: How near to its ultimate strain a fibre is that breaks, as a share of it, and most trials: ten mostly do.
_EXACT, _MOST_TRIALS = 1e-14, 100


@dataclass(frozen=True)
class RotationCapacity:
    """What a joint bears in deformation.

    Attributes
    ----------
    plastic_rotation : float
        θ_p at which the outermost fibre breaks [rad].
    elongation : float
        Plastic elongation at which the section breaks in pure tension [m].
    ultimate_curvature, ultimate_moment : float
        κ_u [1/m] and M_u [N m].
    hinge_length : float
        [m]
    """

    plastic_rotation: float
    elongation: float
    ultimate_curvature: float
    ultimate_moment: float
    hinge_length: float


def rotation_capacity(
    section: Section, material: Material, hinge_length: float | None = None, axial_force: float = 0.0
) -> RotationCapacity:
    """Plastic rotation and elongation at which a joint breaks.

    Parameters
    ----------
    section : Section
    material : Material
        With an ultimate strain; of pieces that name none.
    hinge_length : float, optional
        L_h [m]; the depth of the section when not given.
    axial_force : float
        N that acts beside the moment [N].

    Raises
    ------
    InputError
        When the material has no ultimate strain, the hinge no length, or the axial force is not borne.
    """
    materials = [part.material or material for part in section.parts]
    for m in materials:
        if math.isinf(m.stress_strain.ultimate_strain):
            raise InputError("material", f"{m.name} has no ultimate strain", "give one, as in eu=15 %")
    length = section.depth if hinge_length is None else hinge_length
    if not length > 0.0:
        raise InputError("hinge length", f"{length:g} m is not greater than zero", 'write one such as "100 mm"')
    largest = max(m.stress_strain.ultimate_strain for m in materials)
    ultimate = _ultimate_curvature(section, material, axial_force, 2.0 * largest / section.depth)
    at_break = moment_curvature(section, material, [ultimate], axial_force)
    bending = section.weighted(lambda m: m.youngs_modulus, material).moments()
    stiffness = float(bending[5] - bending[2] ** 2 / bending[0])
    strain = min(m.stress_strain.ultimate_strain for m in materials)
    force = sum(
        float(m.stress_strain.stress(np.float64(strain)) * part.outline.moments()[0])
        for m, part in zip(materials, section.parts, strict=True)
    )
    return RotationCapacity(
        plastic_rotation=(ultimate - float(at_break.moment[0]) / stiffness) * length,
        elongation=(strain - force / float(bending[0])) * length,
        ultimate_curvature=ultimate,
        ultimate_moment=float(at_break.moment[0]),
        hinge_length=length,
    )


def _ultimate_curvature(section: Section, material: Material, axial_force: float, high: float) -> float:
    """Curvature at which the first fibre breaks [1/m], by false position; 0 where the axial force alone does it.

    The end of the bracket that stays counts by half (the Illinois method), or it would stay for ever.
    """

    def left(curvature: float) -> float:
        """What is left of the ultimate strain, as a share."""
        return 1.0 - float(moment_curvature(section, material, [curvature], axial_force).largest_strain[0])

    low, at_low, at_high = 0.0, left(0.0), left(high)
    if at_low <= 0.0:
        return 0.0
    while at_high >= 0.0:
        high *= 2.0
        at_high = left(high)
    stayed = 0.0
    for _ in range(_MOST_TRIALS):
        trial = high - at_high * (high - low) / (at_high - at_low)
        found = left(trial)
        if abs(found) <= _EXACT or not low < trial < high:
            return trial
        if found > 0.0:
            low, at_low = trial, found
            at_high, stayed = at_high * (0.5 if stayed > 0.0 else 1.0), 1.0
        else:
            high, at_high = trial, found
            at_low, stayed = at_low * (0.5 if stayed < 0.0 else 1.0), -1.0
    return low
