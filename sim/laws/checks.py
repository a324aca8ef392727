"""The numbers that laws are made of, checked where they are given."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from capacity import InputError


def is_number(value: object) -> bool:
    """Whether something is a real number, infinite ones and what is no number among them."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def check_three(place: str, values: ArrayLike, units: str) -> None:
    """Refuse what is not three numbers from 0 on; infinite ones will do.

    Raises InputError.
    """
    cure = f"write three numbers from 0 on, along, across and in rotation [{units}]"
    if np.shape(values) != (3,) or not all(map(is_number, values)):  # type: ignore[arg-type]
        raise InputError(place, f"{values!r} is not three numbers", cure)
    if not np.all(np.greater_equal(values, 0.0)):
        raise InputError(place, f"of {values!r} one is negative or no number", cure)


def check_length(length: float) -> None:
    """Refuse a length that no joint can stand for.

    Raises InputError.
    """
    if not (is_number(length) and length > 0.0):
        fault = f"{length:g} m" if is_number(length) else repr(length)
        raise InputError("length", f"{fault} is not greater than zero", "say how much of the member the joint is")
