"""The numbers that laws are made of, checked where they are given."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from capacity import InputError


def check_three(place: str, values: ArrayLike, units: str) -> None:
    """Refuse what is not three numbers from 0 on; infinite ones will do.

    Raises InputError.
    """
    cure = f"write three numbers from 0 on, along, across and in rotation [{units}]"
    if np.shape(values) != (3,):
        raise InputError(place, f"{values!r} is not three numbers", cure)
    if not np.all(np.greater_equal(values, 0.0)):
        raise InputError(place, f"of {values!r} one is negative or no number", cure)


def check_length(length: float) -> None:
    """Refuse a length that no joint can stand for.

    Raises InputError.
    """
    if not length > 0.0:
        raise InputError("length", f"{length:g} m is not greater than zero", "say how much of the member the joint is")
