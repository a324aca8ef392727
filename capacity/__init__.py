"""What a section of a material can carry: N_max, Q_max, M_max, stiffness, interaction, rotation, fibres.

>>> from capacity import capacity, parse_material, parse_section
>>> c = capacity(parse_section("rectangle 50x100 mm"), parse_material("S235"), "tresca")
>>> round(c.M_max)
29375

The reverse, a capacity from a wanted behaviour, is in `capacity.behaviour`; standard sections by name in
`capacity.catalogue`; sections by dimensions in `capacity.shapes`.
"""

from capacity.built_up import Piece, built_up
from capacity.errors import InputError
from capacity.fibres import Fibres
from capacity.interaction import FacetSurface, Interaction
from capacity.materials import Material, parse_material
from capacity.moment_curvature import MomentCurvature, moment_curvature, moment_history
from capacity.resultants import Capacity, capacity
from capacity.rotation_capacity import RotationCapacity, rotation_capacity
from capacity.section_text import parse_section
from capacity.sections import Part, Section
from capacity.stress_strain import StressStrain
from capacity.torsion import torsion_capacity
from capacity.yield_criteria import criterion_name, shear_ratio

__all__ = [
    "Capacity",
    "FacetSurface",
    "Fibres",
    "InputError",
    "Interaction",
    "Material",
    "MomentCurvature",
    "Part",
    "Piece",
    "RotationCapacity",
    "Section",
    "StressStrain",
    "built_up",
    "capacity",
    "criterion_name",
    "moment_curvature",
    "moment_history",
    "parse_material",
    "parse_section",
    "rotation_capacity",
    "shear_ratio",
    "torsion_capacity",
]
