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
    low, high = 0.0, 2.0 * max(m.stress_strain.ultimate_strain for m in materials) / section.depth
    while not moment_curvature(section, material, [high], axial_force).broken[0]:
        high *= 2.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        broken = moment_curvature(section, material, [middle], axial_force).broken[0]
        low, high = (low, middle) if broken else (middle, high)
    at_break = moment_curvature(section, material, [low], axial_force)
    bending = section.weighted(lambda m: m.youngs_modulus, material).moments()
    stiffness = float(bending[5] - bending[2] ** 2 / bending[0])
    strain = min(m.stress_strain.ultimate_strain for m in materials)
    force = sum(
        float(m.stress_strain.stress(np.float64(strain)) * part.outline.moments()[0])
        for m, part in zip(materials, section.parts, strict=True)
    )
    return RotationCapacity(
        plastic_rotation=(low - float(at_break.moment[0]) / stiffness) * length,
        elongation=(strain - force / float(bending[0])) * length,
        ultimate_curvature=low,
        ultimate_moment=float(at_break.moment[0]),
        hinge_length=length,
    )
