"""What a joint is made of, checked when it is made."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from capacity import InputError
from sim.laws import Law


def check_bodies(a: pymunk.Body, b: pymunk.Body) -> None:
    """Refuse bodies that no joint can be between.

    Raises InputError.
    """
    if a is b:
        raise InputError("a, b", "a joint needs two bodies", "give it another one, or space.static_body")
    if pymunk.Body.DYNAMIC not in (a.body_type, b.body_type):
        raise InputError("a, b", "a joint needs a dynamic body", "give one of the two a mass and a moment of inertia")


def check_law(law: Law) -> None:
    """Refuse what is no law, and one whose stiffness or capacity is none.

    Raises InputError.
    """
    missing = [name for name in ("elastic_tangent", "capacities", "parameters", "state") if not hasattr(law, name)]
    if missing:
        cure = 'write one such as section_law("fibre", section, material, length)'
        raise InputError("law", f"{law!r} is no law: it has no {missing[0]}", cure)
    tangent, capacities = law.elastic_tangent(), law.capacities()
    if len(tangent) != 6 or not all(map(math.isfinite, tangent)):
        raise InputError("law", f"its stiffness is not finite: {tuple(tangent)}", "look at its parameters")
    if min(tangent[0], tangent[3], tangent[5]) < 0.0:
        raise InputError("law", f"its stiffness is negative: {tuple(tangent)}", "look at its parameters")
    if len(capacities) != 3 or not all(value >= 0.0 for value in capacities):
        cure = "give N_max, Q_max and M_max from 0 on, or math.inf"
        raise InputError("law", f"its capacities are {tuple(capacities)}", cure)


def check_numbers(damping: tuple[float, float, float], scheme: tuple[float, float], geometry: np.ndarray) -> None:
    """Refuse numbers that nothing can be reckoned with.

    Raises InputError.
    """
    if np.shape(damping) != (3,) or not all(0.0 <= value < math.inf for value in damping):
        cure = "write three numbers from 0 on, along, across and in rotation [N s/m, N s/m, N m s/rad]"
        raise InputError("damping", f"{damping!r} will not do", cure)
    if np.shape(scheme) != (2,) or not all(0.0 <= value < math.inf for value in scheme) or not any(scheme):
        cure = "write IMPLICIT_EULER, AVERAGE_ACCELERATION, or (0.25, 0.02) for a little damping"
        raise InputError("scheme", f"{scheme!r} is no time integration", cure)
    if not np.isfinite(geometry).all():
        raise InputError(
            "at, direction", "the joint's place is not finite", "look at these and at where the bodies are"
        )
