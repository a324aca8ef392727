"""Elastic–plastic materials, by grade or by values."""

import difflib
import tomllib
from functools import cache
from importlib import resources

from capacity.errors import InputError
from capacity.units import positive, to_si


class Material:
    """A uniaxial elastic–plastic material with bilinear kinematic hardening; never changed once made.

    Parameters
    ----------
    name : str
        Grade, or the values it was given by.
    youngs_modulus : float
        E [Pa].
    yield_stress : float
        fy [Pa].
    density : float
        ρ [kg/m³].
    poissons_ratio : float
        ν [-].
    tangent_modulus : float
        Slope of the stress–strain curve beyond yield, E_t [Pa]; 0 is perfectly plastic.
    """

    def __init__(
        self,
        name: str,
        youngs_modulus: float,
        yield_stress: float,
        density: float,
        poissons_ratio: float = 0.3,
        tangent_modulus: float = 0.0,
    ) -> None:
        self.name = name
        self.youngs_modulus = youngs_modulus
        self.yield_stress = yield_stress
        self.density = density
        self.poissons_ratio = poissons_ratio
        self.tangent_modulus = tangent_modulus

    def __repr__(self) -> str:
        return f"Material({self.name!r})"

    @property
    def shear_modulus(self) -> float:
        """G = E / 2(1 + ν) [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))


# Key in a material text: field, quantity.
_VALUES = {
    "fy": ("yield_stress", "stress"),
    "E": ("youngs_modulus", "stress"),
    "rho": ("density", "density"),
    "nu": ("poissons_ratio", "number"),
    "Et": ("tangent_modulus", "stress"),
}

_EXAMPLE = '"fy=235 MPa, E=210 GPa, rho=7850 kg/m^3"'


def parse_material(text: str, place: str = "material") -> Material:
    """The material that ``text`` names.

    Parameters
    ----------
    text : str
        A grade (``"S235"``), or values (``"fy=235 MPa, E=210 GPa, rho=7850 kg/m^3"``, also ``nu`` and ``Et``; E, rho
        and nu are those of structural steel when left out).
    place : str
        Where the text stands, for messages.

    Raises
    ------
    InputError
        For an unknown grade or key, or a value that is not possible.
    """
    grades = _grades()
    grade = text.strip().upper()
    if grade in grades:
        return Material(name=grade, **grades[grade])
    if "=" not in text:
        near = difflib.get_close_matches(grade, grades, n=3, cutoff=0.5)
        known = ", ".join(near or grades)
        raise InputError(place, f'"{text}" is no known grade', f"write one of {known}, or values such as {_EXAMPLE}")
    fields = dict(grades["S235"])
    del fields["yield_stress"]
    for item in text.split(","):
        key, equals, value = item.partition("=")
        key = key.strip()
        if not equals or key not in _VALUES:
            raise InputError(place, f'"{item.strip()}" is none of {", ".join(_VALUES)} = value', f"write {_EXAMPLE}")
        name, quantity = _VALUES[key]
        fields[name] = to_si(value.strip(), quantity, f"{place} > {key}")
    if "yield_stress" not in fields:
        raise InputError(place, f'"{text}" gives no yield stress', f"write {_EXAMPLE}")
    return checked(Material(name=text.strip(), **fields), place)


def checked(material: Material, place: str) -> Material:
    """``material`` itself, when its values are possible.

    Raises
    ------
    InputError
        When E, fy or ρ is not positive, ν is outside (-1, 0.5), or E_t is outside [0, E).
    """
    positive(material.yield_stress, "stress", f"{place} > fy")
    positive(material.youngs_modulus, "stress", f"{place} > E")
    positive(material.density, "density", f"{place} > rho")
    if not -1.0 < material.poissons_ratio < 0.5:
        raise InputError(f"{place} > nu", f"{material.poissons_ratio:g} is not between -1 and 0.5", "steel has nu=0.3")
    if not 0.0 <= material.tangent_modulus < material.youngs_modulus:
        raise InputError(
            f"{place} > Et", f"{material.tangent_modulus:g} Pa is not between 0 and E", "0.01 to 0.02 of E is ordinary"
        )
    return material


@cache
def _grades() -> dict[str, dict[str, float]]:
    return tomllib.loads(resources.files("capacity").joinpath("data/grades.toml").read_text(encoding="utf-8"))
