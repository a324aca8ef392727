"""Yield criteria: what share of the yield stress a metal bears in pure shear."""

import math

from capacity.errors import InputError

#: Shear yield stress over tensile yield stress: Tresca σ1 - σ3 = fy gives 1/2, von Mises 3τ² = fy² gives 1/√3.
SHEAR_RATIO = {"tresca": 0.5, "von-mises": 1.0 / math.sqrt(3.0)}


def criterion_name(text: str, place: str = "criterion") -> str:
    """The key of `SHEAR_RATIO` that ``text`` means; case, spaces and underscores do not matter.

    Raises
    ------
    InputError
        When there is no such criterion.
    """
    name = text.strip().lower().replace("_", "-").replace(" ", "-")
    if name not in SHEAR_RATIO:
        raise InputError(place, f'"{text}" is no known yield criterion', f"write {' or '.join(SHEAR_RATIO)}")
    return name


def shear_ratio(criterion: str) -> float:
    """τ_y / f_y [-] of ``criterion``, ``"tresca"`` or ``"von-mises"``.

    Raises
    ------
    InputError
        For any other name.
    """
    return SHEAR_RATIO[criterion_name(criterion)]
