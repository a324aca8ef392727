"""What a section of a material can carry: N_max, Q_max, M_max, stiffness, fibres.

>>> from capacity import capacity, parse_material, parse_section
>>> c = capacity(parse_section("rectangle 50x100 mm"), parse_material("S235"), "tresca")
>>> round(c.M_max)
29375
"""

from capacity.errors import InputError
from capacity.fibres import Fibres
from capacity.materials import Material, parse_material
from capacity.resultants import Capacity, capacity
from capacity.section_text import parse_section
from capacity.sections import Section
from capacity.yield_criteria import criterion_name, shear_ratio

__all__ = [
    "Capacity",
    "Fibres",
    "InputError",
    "Material",
    "Section",
    "capacity",
    "criterion_name",
    "parse_material",
    "parse_section",
    "shear_ratio",
]
