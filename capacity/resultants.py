"""Plastic capacities and elastic stiffnesses of a section of a material.

The integrals (1)–(3) of Nikula, Mikkola and Björk, *Breakable elastic-plastic constraint for rigid body simulation*:

    N_max = ∫ fy dA,   Q_max = ∫ τy dA,   M_max = ∫ fy |y - y_pc| dA,

with τy = fy / 2 (Tresca) or fy / √3 (von Mises).
"""

from dataclasses import dataclass

from capacity.materials import Material
from capacity.sections import Section
from capacity.yield_criteria import shear_ratio


@dataclass(frozen=True)
class Capacity:
    """What a section of a material carries, and how stiff it is; SI units.

    Attributes
    ----------
    N_max : float
        Axial force at full yield [N].
    Q_max : float
        Shear force at yield of the walls along the load [N]; equals `Q_full_area` for solid sections.
    M_max : float
        Plastic moment M_p [N m].
    M_yield : float
        Moment at first yield [N m].
    Q_full_area : float
        Shear force by integral (2), with the whole area [N].
    EA, GA_s, EI : float
        Axial [N], shear [N] and bending [N m²] stiffness.
    shape_factor : float
        M_max / M_yield [-].
    """

    N_max: float
    Q_max: float
    M_max: float
    M_yield: float
    Q_full_area: float
    EA: float
    GA_s: float
    EI: float
    shape_factor: float


def capacity(section: Section, material: Material, criterion: str = "von-mises") -> Capacity:
    """Capacities and stiffnesses of ``section`` made of ``material``.

    Parameters
    ----------
    section : Section
    material : Material
    criterion : str
        ``"tresca"`` or ``"von-mises"``.

    Raises
    ------
    InputError
        For an unknown criterion.
    """
    fy = material.yield_stress
    tau = shear_ratio(criterion) * fy
    return Capacity(
        N_max=fy * section.area,
        Q_max=tau * section.wall_area,
        M_max=fy * section.plastic_modulus,
        M_yield=fy * section.elastic_modulus,
        Q_full_area=tau * section.area,
        EA=material.youngs_modulus * section.area,
        GA_s=material.shear_modulus * section.shear_area,
        EI=material.youngs_modulus * section.second_moment_of_area,
        shape_factor=section.shape_factor,
    )
