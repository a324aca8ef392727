"""Plastic capacities and elastic stiffnesses of a section of a material.

The integrals (1)–(3) of Nikula, Mikkola and Björk, *Breakable elastic-plastic constraint for rigid body simulation*:

    N_max = ∫ fy dA,   Q_max = ∫ τy dA,   M_max = ∫ fy |y - y_pc| dA,

with τy = fy / 2 (Tresca) or fy / √3 (von Mises).
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cached_property, partial

from capacity.materials import Material
from capacity.sections import Section, shear_stiffness
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
    EA, EI : float
        Axial [N] and bending [N m²] stiffness.
    shape_factor : float
        M_max / M_yield [-].
    shear_stiffness : callable
        Works out `GA_s` when it is asked for: it takes as long as all the rest.
    """

    N_max: float
    Q_max: float
    M_max: float
    M_yield: float
    Q_full_area: float
    EA: float
    EI: float
    shape_factor: float
    shear_stiffness: Callable[[], float] = field(repr=False, compare=False)

    @cached_property
    def GA_s(self) -> float:
        """Elastic shear stiffness [N]."""
        return self.shear_stiffness()

    def values(self) -> dict[str, float]:
        """Every number by its name."""
        numbers = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "shear_stiffness"}
        return {**numbers, "GA_s": self.GA_s}


def capacity(section: Section, material: Material, criterion: str = "von-mises") -> Capacity:
    """Capacities and stiffnesses of ``section`` made of ``material``.

    Parameters
    ----------
    section : Section
    material : Material
        Of the pieces that name none of their own.
    criterion : str
        ``"tresca"`` or ``"von-mises"``.

    Raises
    ------
    InputError
        For an unknown criterion.
    """
    tau = shear_ratio(criterion)
    if section.has_own_materials:
        return _of_several_materials(section, material, tau)
    fy = material.yield_stress
    return Capacity(
        N_max=fy * section.area,
        Q_max=tau * fy * section.wall_area,
        M_max=fy * section.plastic_modulus,
        M_yield=fy * section.elastic_modulus,
        Q_full_area=tau * fy * section.area,
        EA=material.youngs_modulus * section.area,
        EI=material.youngs_modulus * section.second_moment_of_area,
        shape_factor=section.shape_factor,
        shear_stiffness=partial(_of_one_material, section, material),
    )


def _of_one_material(section: Section, material: Material) -> float:
    return material.shear_modulus * section.shear_area


def _of_several_materials(section: Section, material: Material, tau: float) -> Capacity:
    """The same integrals with each piece's own fy, E and G; moments are those without axial force."""
    plastic = section.weighted(lambda m: m.yield_stress, material)
    force = float(plastic.moments()[0])
    first = plastic.moments(plastic.height_of(0.5 * force))[2]
    M_max = float(2.0 * first - plastic.moments()[2])
    elastic = section.weighted(lambda m: m.youngs_modulus, material)
    area, _, sy, _, _, syy = elastic.moments().tolist()
    centre, EI = sy / area, syy - sy * sy / area
    pieces = [(part, part.material or material) for part in section.parts]
    M_yield = min(
        m.yield_stress * EI / (m.youngs_modulus * abs(y - centre)) for part, m in pieces for y in part.outline.extent()
    )
    shear = section.weighted(lambda m: m.shear_modulus, material)
    return Capacity(
        N_max=force,
        Q_max=sum(tau * m.yield_stress * part.wall_area() for part, m in pieces),
        M_max=M_max,
        M_yield=M_yield,
        Q_full_area=tau * force,
        EA=area,
        EI=EI,
        shape_factor=M_max / M_yield,
        shear_stiffness=partial(shear_stiffness, elastic, shear),
    )
