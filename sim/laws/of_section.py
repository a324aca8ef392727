"""The laws by name, for a joint that stands for a length of a member."""

from __future__ import annotations

from capacity import FacetSurface, Interaction, Material, Section, capacity
from sim.laws.checks import check_length
from sim.laws.elastic_plastic import ElasticPlastic
from sim.laws.fibre import FibreSection
from sim.laws.interaction import InteractionPlastic
from sim.laws.rigid_plastic import RigidPlastic

#: Names of the laws, cheapest first.
LAWS = ("rigid-plastic", "elastic-plastic", "interaction", "fibre")


def section_law(
    name: str,
    section: Section,
    material: Material,
    length: float,
    *,
    criterion: str = "von-mises",
    fibres: int = 16,
    shear_stiffness: float | None = None,
    surface: FacetSurface | None = None,
) -> RigidPlastic | ElasticPlastic | InteractionPlastic | FibreSection:
    """The law called ``name`` for ``length`` [m] of a member.

    Parameters
    ----------
    name : str
        One of `LAWS`.
    section, material : Section, Material
    length : float
        [m]
    criterion : str
        Yield criterion in shear, ``"tresca"`` or ``"von-mises"``.
    fibres : int
        For the law ``"fibre"``, at least 4.
    shear_stiffness : float, optional
        [N/m]; by default G A_s / length.
    surface : FacetSurface, optional
        For the law ``"interaction"``, where several joints share one; by default that of the section, of 64 facets.

    Raises
    ------
    ValueError
        For an unknown name, or fewer than 4 fibres.
    InputError
        For an unknown criterion, a length that is not above 0, or a table of stresses that fibres cannot follow back.
    """
    if name not in LAWS:
        raise ValueError(f'there is no joint law "{name}"; the laws are {", ".join(LAWS)}')
    check_length(length)
    c = capacity(section, material, criterion)
    shear = c.GA_s / length if shear_stiffness is None else shear_stiffness
    stiffness = (c.EA / length, shear, c.EI / length)
    match name:
        case "rigid-plastic":
            return RigidPlastic.of_section(c, length)
        case "elastic-plastic":
            return ElasticPlastic(stiffness, (c.N_max, c.Q_max, c.M_max))
        case "interaction":
            return InteractionPlastic(stiffness, surface or Interaction(section, material, criterion).facets())
        case _:
            return FibreSection.of_section(section, material, length, fibres, criterion, shear)
