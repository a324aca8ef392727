"""What a joint is made of, checked when it is made."""

from __future__ import annotations

import math

import numpy as np
import pymunk

from capacity import InputError
from sim.laws import Law
from sim.laws.checks import is_number
from sim.limits import Limits


def check_bodies(a: pymunk.Body, b: pymunk.Body) -> None:
    """Refuse bodies that no joint can be between.

    Raises InputError.
    """
    for name, body in (("a", a), ("b", b)):
        if not isinstance(body, pymunk.Body):
            raise InputError(name, f"{body!r} is no pymunk.Body", "give a body, or space.static_body for the ground")
    if a is b:
        raise InputError("a, b", "a joint needs two bodies", "give it another one, or space.static_body")
    if pymunk.Body.DYNAMIC not in (a.body_type, b.body_type):
        raise InputError("a, b", "a joint needs a dynamic body", "give one of the two a mass and a moment of inertia")


def check_place(at: tuple[float, float]) -> tuple[float, float]:
    """Where a joint is made, as two floats [m].

    Raises InputError.
    """
    try:
        x, y = map(float, at)
    except (TypeError, ValueError):
        raise InputError("at", f"{at!r} is no point", "write x and y in the world [m], such as (0.0, 5.0)") from None
    return x, y


def check_options(turn: float, length: float, limits: Limits, on_break: object) -> None:
    """Refuse what is out of range, or of another kind.

    Raises InputError.
    """
    if not (is_number(turn) and 0.0 <= turn <= 1.0):
        raise InputError("turn", f"{turn!r} is no share of b's rotation", "write a number from 0 to 1, or leave it out")
    if not (is_number(length) and 0.0 <= length < math.inf):
        raise InputError("length", f"{length!r} is no length", "write how much of a member the joint stands for [m]")
    if not isinstance(limits, Limits):
        raise InputError("limits", f"{limits!r} is no Limits", "write one such as Limits(rotation=0.1)")
    if on_break is not None and not callable(on_break):
        raise InputError("on_break", f"{on_break!r} cannot be called", "give a function of the joint, or leave it out")


def check_law(law: Law) -> None:
    """Refuse what is no law, and one whose stiffness or capacity is none.

    Raises InputError.
    """
    if isinstance(law, type):
        raise InputError("law", f"{law.__name__} is a kind of law", f"make one: {law.__name__}(...)")
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
    cure = "write IMPLICIT_EULER, AVERAGE_ACCELERATION, or (0.25, 0.02) for a little damping"
    if np.shape(scheme) != (2,) or not all(0.0 <= value < math.inf for value in scheme):
        raise InputError("scheme", f"{scheme!r} is no time integration", cure)
    if 4.0 * scheme[0] + 2.0 * scheme[1] < 1.0:
        # In q'' = -ω² q its characteristic polynomial has a root below -1 for large hω.
        raise InputError("scheme", f"{scheme!r} is not stable at any step, 4 β + 2 δ being less than 1", cure)
    if not np.isfinite(geometry).all():
        raise InputError(
            "at, direction", "the joint's place is not finite", "look at these and at where the bodies are"
        )
