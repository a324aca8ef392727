"""Elastic–plastic materials, by grade or by values."""

import difflib
import re
import tomllib
from functools import cache
from importlib import resources
from typing import Any

from capacity.errors import InputError
from capacity.stress_strain import StressStrain
from capacity.units import positive, to_si


class Material:
    """A uniaxial elastic–plastic material; never changed once made.

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
    ultimate_strain : float
        Strain at which it breaks [-]; infinity when it does not.
    curve : StressStrain, optional
        The stress–strain law where it is not bilinear; E and fy are then those of its first piece.
    """

    def __init__(
        self,
        name: str,
        youngs_modulus: float,
        yield_stress: float,
        density: float,
        poissons_ratio: float = 0.3,
        tangent_modulus: float = 0.0,
        ultimate_strain: float = float("inf"),
        curve: StressStrain | None = None,
    ) -> None:
        self.name = name
        self.youngs_modulus = youngs_modulus
        self.yield_stress = yield_stress
        self.density = density
        self.poissons_ratio = poissons_ratio
        self.tangent_modulus = tangent_modulus
        self.ultimate_strain = ultimate_strain
        self.curve = curve

    def __repr__(self) -> str:
        return f"Material({self.name!r})"

    @property
    def shear_modulus(self) -> float:
        """G = E / 2(1 + ν) [Pa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

    @property
    def stress_strain(self) -> StressStrain:
        """Stress–strain law: the table it was given, or elastic up to fy and then E_t."""
        if self.curve is not None:
            return self.curve
        return StressStrain.bilinear(self.youngs_modulus, self.yield_stress, self.tangent_modulus, self.ultimate_strain)


# Key in a material text: field, quantity.
_VALUES = {
    "fy": ("yield_stress", "stress"),
    "E": ("youngs_modulus", "stress"),
    "rho": ("density", "density"),
    "nu": ("poissons_ratio", "number"),
    "Et": ("tangent_modulus", "stress"),
    "eu": ("ultimate_strain", "number"),
}

_EXAMPLE = '"fy=235 MPa, E=210 GPa, rho=7850 kg/m^3"'
_CURVE_EXAMPLE = '"curve=0.0011:231 0.02:250 0.15:360 MPa"'

# Reinforced concrete of the Demolisher scene: only the steel bears load, both weigh.
_SCENE_STEEL = {"youngs_modulus": 200e9, "yield_stress": 200e6, "density": 7800.0, "ultimate_strain": 0.2}
_SCENE_CONCRETE_DENSITY = 2000.0


def parse_material(text: str, place: str = "material", thickness: float | None = None) -> Material:
    """The material that ``text`` names.

    Parameters
    ----------
    text : str
        A grade (``"S235"``), values (``"fy=235 MPa, E=210 GPa, rho=7850 kg/m^3"``, also ``nu``, ``Et``, ``eu`` for the
        ultimate strain, and ``curve=0.0011:231 0.02:250 0.15:360 MPa`` for a table; E, rho and nu are those of
        structural steel when left out), a grade with values (``"S355, Et=2.1 GPa, t=30 mm"``, ``t`` being the
        thickness), or ``"concrete with 5 % steel"``.
    place : str
        Where the text stands, for messages.
    thickness : float, optional
        Greatest thickness of the product, on which a grade's yield stress depends [m]; the thinnest by default.

    Raises
    ------
    InputError
        For an unknown grade or key, a grade that is not made so thick, or a value that is not possible.
    """
    concrete = re.fullmatch(r"\s*concrete\s+with\s+(.+?)\s+(?:of\s+)?steel\s*", text, re.IGNORECASE)
    if concrete:
        return _concrete(text.strip(), to_si(concrete[1], "number", place), place)
    head, *items = [item.strip() for item in text.split(",")]
    grades = _grades()
    grade = head.upper()
    if "=" in head:
        items.insert(0, head)
        grade = ""
    elif grade not in grades:
        near = difflib.get_close_matches(grade, grades, n=3, cutoff=0.5)
        known = ", ".join(near or grades)
        raise InputError(place, f'"{head}" is no known grade', f"write one of {known}, or values such as {_EXAMPLE}")
    fields: dict[str, Any] = dict(grades[grade or "S235"])
    steps = fields.pop("yield_stress")
    if not grade:
        del fields["ultimate_strain"]
    for item in items:
        key, equals, value = (word.strip() for word in item.partition("="))
        if equals and key == "t" and grade:
            thickness = positive(value, "length", f"{place} > t")
        elif equals and key == "curve":
            _add_curve(fields, value, f"{place} > curve")
        elif equals and key in _VALUES:
            name, quantity = _VALUES[key]
            fields[name] = to_si(value, quantity, f"{place} > {key}")
        else:
            raise InputError(place, f'"{item}" is none of {", ".join(_VALUES)}, curve = value', f"write {_EXAMPLE}")
    if grade and "yield_stress" not in fields:
        fields["yield_stress"] = _yield_stress(grade, steps, thickness, place)
    if "yield_stress" not in fields:
        raise InputError(place, f'"{text}" gives no yield stress', f"write {_EXAMPLE}")
    return checked(Material(name=grade if grade and not items else text.strip(), **fields), place)


def _yield_stress(grade: str, steps: list[list[float]], thickness: float | None, place: str) -> float:
    if thickness is None:
        return steps[0][1]
    for greatest, value in steps:
        if thickness <= greatest * (1.0 + 1e-9):
            return value
    limit = steps[-1][0]
    fault = f"{grade} of {thickness * 1e3:g} mm is beyond the {limit * 1e3:g} mm that its standard covers"
    raise InputError(place, fault, "give the yield stress, as in fy=200 MPa")


def _add_curve(fields: dict[str, Any], value: str, place: str) -> None:
    points, _, unit = value.rpartition(" ")
    scale = to_si(f"1 {unit}", "stress", place)
    try:
        pairs = [(float(strain), float(stress) * scale) for strain, stress in (p.split(":") for p in points.split())]
        curve = StressStrain.table(pairs)
    except ValueError as error:
        raise InputError(place, f'"{value}" is no stress–strain table ({error})', f"write {_CURVE_EXAMPLE}") from error
    fields["curve"] = curve
    fields["youngs_modulus"] = float(curve.slopes[0])
    fields["yield_stress"] = float(curve.slopes[0] * curve.breaks[0])
    fields["ultimate_strain"] = curve.ultimate_strain


def _concrete(name: str, share: float, place: str) -> Material:
    if not 0.0 < share <= 1.0:
        raise InputError(place, f"a share of {share:g} of steel cannot be", 'write "concrete with 5 % steel"')
    steel = _SCENE_STEEL
    return Material(
        name,
        youngs_modulus=share * steel["youngs_modulus"],
        yield_stress=share * steel["yield_stress"],
        density=share * steel["density"] + (1.0 - share) * _SCENE_CONCRETE_DENSITY,
        ultimate_strain=steel["ultimate_strain"],
    )


def checked(material: Material, place: str) -> Material:
    """``material`` itself, when its values are possible.

    Raises
    ------
    InputError
        When E, fy, ρ or the ultimate strain is not positive, ν is outside (-1, 0.5), or E_t is outside [0, E).
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
    first_yield = material.yield_stress / material.youngs_modulus
    if not material.ultimate_strain >= first_yield:
        fault = f"{material.ultimate_strain:g} is less than the strain at first yield, {first_yield:.3g}"
        raise InputError(f"{place} > eu", fault, "steel has eu=15 % or more")
    return material


@cache
def _grades() -> dict[str, dict[str, Any]]:
    return tomllib.loads(resources.files("capacity").joinpath("data/grades.toml").read_text(encoding="utf-8"))
