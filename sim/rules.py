"""Where the joints of a member go, and how much of its length each stands for.

A member cut into rigid pieces by joints at points x_i with stiffness EI / (w_i L) is the force-based beam element with
the quadrature rule (x_i, w_i): static bending moments are exact, and the rule integrates the curvatures.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre


@dataclass(frozen=True)
class Rule:
    """Joints of a member of unit length.

    Attributes
    ----------
    name : str
    points : (n,) float
        Positions, from 0 to 1.
    weights : (n,) float
        Share of the member's length, adding up to 1.
    """

    name: str
    points: np.ndarray
    weights: np.ndarray


def lobatto(joints: int) -> Rule:
    """Gauss–Lobatto points, both ends among them; exact for polynomials of degree 2n - 3.

    Abramowitz & Stegun, 25.4.32. Raises ValueError for fewer than 2 joints.
    """
    if joints < 2:
        raise ValueError(f"{joints} joints: a Gauss–Lobatto rule has at least 2")
    polynomial = np.zeros(joints)
    polynomial[-1] = 1.0
    inner = np.sort(legendre.legroots(legendre.legder(polynomial)))
    x = np.concatenate([[-1.0], inner, [1.0]])
    weights = 1.0 / (joints * (joints - 1) * legendre.legval(x, polynomial) ** 2)
    return Rule("lobatto", 0.5 * (x + 1.0), weights)


def equal(joints: int) -> Rule:
    """Pieces of equal length, joints between them and at both ends (the trapezoidal rule).

    Raises ValueError for fewer than 2 joints.
    """
    if joints < 2:
        raise ValueError(f"{joints} joints: equal pieces need at least 2")
    weights = np.full(joints, 1.0 / (joints - 1))
    weights[[0, -1]] *= 0.5
    return Rule("equal", np.linspace(0.0, 1.0, joints), weights)


RULES = {"lobatto": lobatto, "equal": equal}
