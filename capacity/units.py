"""Text with units to SI floats; the only place that knows a unit.

Everything inside the project is an SI float. Text such as ``"235 MPa"`` is read here, once, when a scene or a
command line is read.
"""

import math
import re
from functools import cache
from typing import TYPE_CHECKING

from capacity.errors import InputError

if TYPE_CHECKING:
    import pint

# The units that structural input is written in. A registry of its own starts ten times faster than pint's full list.
_DEFINITIONS = """
micro- = 1e-6 = u-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
meter = [length] = m = metre
second = [time] = s
minute = 60 * second = min
gram = [mass] = g
tonne = 1e6 * gram = t
radian = [] = rad
degree = 0.017453292519943295 * radian = deg
percent = 0.01 = pct
newton = kilogram * meter / second ** 2 = N
pascal = newton / meter ** 2 = Pa
joule = newton * meter = J
hertz = 1 / second = Hz
inch = 0.0254 * meter = in
foot = 0.3048 * meter = ft
"""

#: What a quantity is called in messages, its SI unit, and an example of how to write it.
QUANTITIES = {
    "length": ("m", "120 mm"),
    "area": ("m**2", "50 cm^2"),
    "force": ("N", "12 kN"),
    "force per length": ("N/m", "5 kN/m"),
    "moment": ("N*m", "3 kN m"),
    "stress": ("Pa", "235 MPa"),
    "density": ("kg/m**3", "7850 kg/m^3"),
    "mass": ("kg", "500 kg"),
    "time": ("s", "2 s"),
    "speed": ("m/s", "10 m/s"),
    "acceleration": ("m/s**2", "9.81 m/s^2"),
    "angle": ("rad", "0.1 rad"),
    "angular speed": ("rad/s", "-40 rad/s"),
    "frequency": ("Hz", "2 Hz"),
    "stiffness": ("N/m", "1e6 N/m"),
    "rotational stiffness": ("N*m/rad", "2 MN m/rad"),
    "moment of inertia": ("kg*m**2", "58320 kg m^2"),
    "curvature": ("1/m", "0.02 1/m"),
    "number": ("", "0.01"),
}

#: Numbers other than 0 lie between this [SI] and its inverse: far from where products of a few of them end.
_LARGEST = 1e30


@cache
def _registry() -> "pint.UnitRegistry[float]":
    import pint

    registry: pint.UnitRegistry[float] = pint.UnitRegistry(
        None, preprocessors=[lambda text: text.replace("%", " percent")]
    )
    registry.load_definitions(_DEFINITIONS.strip().splitlines())
    return registry


def to_si(value: str | float | int, quantity: str, place: str) -> float:
    """Read ``value`` as ``quantity`` and return it in SI units.

    Parameters
    ----------
    value : str or float
        Text with a unit (``"235 MPa"``), or a number that is already SI.
    quantity : str
        A key of `QUANTITIES`.
    place : str
        Where the value stands, for the message.

    Raises
    ------
    InputError
        When the text is no number with a unit, the unit does not fit, or the number is not finite or out of all
        proportion.
    """
    unit, example = QUANTITIES[quantity]
    hint = f'write {quantity} such as "{example}"'
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise InputError(place, f"{value!r} is no {quantity}", hint)
    number = _parse(value, unit, quantity, place, hint) if isinstance(value, str) else value
    if not -math.inf < number < math.inf:
        raise InputError(place, f"{value!r} is not a finite {quantity}", hint)
    if number != 0.0 and not 1.0 / _LARGEST <= abs(number) <= _LARGEST:
        raise InputError(place, f"a {quantity} of {value!s:.40} is out of all proportion", hint)
    return float(number)


def _parse(text: str, unit: str, quantity: str, place: str, hint: str) -> float:
    import pint

    # A bare number in text would be read as SI by one user and as mm by another: a unit is asked for.
    if unit and re.fullmatch(r"\s*[-+0-9.eE]+\s*", text):
        raise InputError(place, f'"{text}" has no unit', hint)
    try:
        return float(_registry().Quantity(text).to(unit).magnitude)
    except pint.DimensionalityError as error:
        raise InputError(place, f'"{text}" does not fit: {quantity} is asked for', hint) from error
    except pint.UndefinedUnitError as error:
        raise InputError(place, f'"{text}" has an unknown unit', hint) from error
    except Exception as error:  # pint lets the tokenizer's and Python's own errors through
        raise InputError(place, f'"{text}" cannot be read as a {quantity}', hint) from error


def positive(value: str | float | int, quantity: str, place: str) -> float:
    """As `to_si`, for a quantity that must be greater than zero."""
    number = to_si(value, quantity, place)
    if number <= 0.0:
        example = QUANTITIES[quantity][1]
        raise InputError(place, f"{value!r} must be greater than zero", f'write {quantity} such as "{example}"')
    return number


def length_unit(text: str, place: str) -> float:
    """Metres in one of the length unit ``text``, e.g. 0.001 for ``"mm"``."""
    return to_si(f"1 {text}", "length", place)


def engineering(value: float, unit: str) -> str:
    """A number with an SI prefix and four significant digits, e.g. ``29.38 kN m``."""
    for factor, prefix in ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ")):
        if abs(value) >= factor:
            return f"{value / factor:.4g} {prefix}{unit}"
    return f"{value:.4g} {unit}"
