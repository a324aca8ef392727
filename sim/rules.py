"""Where the joints of a member go, and how much of its length each stands for.

A member cut into rigid pieces by joints at points x_i with stiffness EI / (w_i L) is the force-based beam element with
the quadrature rule (x_i, w_i): static bending moments are exact, and the rule integrates the curvatures.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import legendre

from capacity import InputError

# k of a graded rule. Nearer to both ends a hinge that spreads as it hardens, or one in the span, is no longer seen
# well, and the long pieces in the middle spoil natural frequencies.
_DRAWN_TO_BOTH, _DRAWN_TO_ONE = 0.25, 0.5
# Degree to which it is exact, if it has points enough, and how many fewer than points that is else. More would make
# frequencies better still, but weigh the ends of short rules as even ones, and miss a hinge in the span by more.
_GRADED_DEGREE, _FEWER = 7, 3


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
    elastic : (n,) bool
        Whether a joint stays elastic whatever it bears.
    """

    name: str
    points: np.ndarray
    weights: np.ndarray
    elastic: np.ndarray


def lobatto(joints: int) -> Rule:
    """Gauss–Lobatto points, both ends among them; exact for polynomials of degree 2n - 3.

    Abramowitz & Stegun, 25.4.32. Raises ValueError for fewer than 2 joints.
    """
    if joints < 2:
        raise ValueError(f"{joints} joints: a Gauss–Lobatto rule has at least 2")
    polynomial = np.zeros(joints)
    polynomial[-1] = 1.0
    # All are real; from NumPy 2.5 on they come as complex numbers all the same.
    inner = np.sort(legendre.legroots(legendre.legder(polynomial)).real)
    x = np.concatenate([[-1.0], inner, [1.0]])
    weights = 1.0 / (joints * (joints - 1) * legendre.legval(x, polynomial) ** 2)
    return Rule("lobatto", 0.5 * (x + 1.0), weights, np.zeros(joints, dtype=bool))


def graded(joints: int, *, start: bool = True, end: bool = True) -> Rule:
    """Gauss–Lobatto points drawn to where moments peak, the ``start`` and the ``end`` of the member, or one of them.

    What yields beside a peak is short: in an I section a tenth of the way to where the moment is zero. Points x go to
    x - k sin(2πx) / 2π, or to x - k sin(πx) / π where only the start is to have more, weights along with them: a share
    k of the sin² transformation of A. Sidi, A new variable transformation for numerical integration, Numerical
    Integration IV, ISNM 112 (1993) 359–373. Weights are then changed by the least share that makes the rule exact to
    degree n - 3, 7 at the most, and with it the elastic answer under loads at the ends and even loads.

    Raises ValueError for fewer than 6 joints.
    """
    if joints < 6:
        raise ValueError(f"{joints} joints: a graded rule has at least 6")
    even = lobatto(joints)
    if not (start or end):
        return replace(even, name="graded")
    drawn, turns = (_DRAWN_TO_BOTH, 2.0) if start and end else (_DRAWN_TO_ONE, 1.0)
    phase = turns * np.pi * (even.points if start else even.points + 1.0)
    points = even.points - drawn * np.sin(phase) / (turns * np.pi)
    points[[0, -1]] = 0.0, 1.0
    weights = even.weights * (1.0 - drawn * np.cos(phase))
    powers = legendre.legvander(2.0 * points - 1.0, min(_GRADED_DEGREE, joints - _FEWER)).T
    missing = np.eye(len(powers))[0] - powers @ weights
    weights *= 1.0 + powers.T @ np.linalg.solve(powers * weights @ powers.T, missing)
    return Rule("graded", points, weights, np.zeros(joints, dtype=bool))


def equal(joints: int) -> Rule:
    """Pieces of equal length, joints between them and at both ends (the trapezoidal rule).

    Raises ValueError for fewer than 2 joints.
    """
    if joints < 2:
        raise ValueError(f"{joints} joints: equal pieces need at least 2")
    weights = np.full(joints, 1.0 / (joints - 1))
    weights[[0, -1]] *= 0.5
    return Rule("equal", np.linspace(0.0, 1.0, joints), weights, np.zeros(joints, dtype=bool))


def radau(joints: int, hinge: float) -> Rule:
    """Hinges of a chosen length at both ends of an elastic member, ``hinge`` as a share of its length.

    Two Gauss–Radau points over four hinge lengths at each end, of which that at the end itself weighs one hinge length
    and may yield, and Gauss points between: M. H. Scott and G. L. Fenves, Plastic hinge integration methods for
    force-based beam–column elements, J. Struct. Eng. 132 (2006) 244–252. With two Gauss points or more, 6 joints or
    more, the elastic answer is exact under loads at the ends. A hinge that hardens turns by its length times the
    plastic curvature.

    Raises ValueError for fewer than 6 joints, or hinges that leave no member between them.
    """
    if joints < 6:
        raise ValueError(f"{joints} joints: hinges with Radau points have at least 6")
    if not 0.0 < hinge < 0.125:
        raise ValueError(f"a hinge of {hinge:g} of its member's length is not between 0 and 1/8 of it")
    x, w = legendre.leggauss(joints - 4)
    between = 1.0 - 8.0 * hinge
    near = np.array([0.0, 8.0 / 3.0 * hinge])
    points = np.concatenate([near, 4.0 * hinge + 0.5 * between * (x + 1.0), 1.0 - near[::-1]])
    weights = np.concatenate([[hinge, 3.0 * hinge], 0.5 * between * w, [3.0 * hinge, hinge]])
    elastic = np.ones(joints, dtype=bool)
    elastic[[0, -1]] = False
    return Rule("radau", points, weights, elastic)


#: Names of the rules.
RULES = ("lobatto", "graded", "equal", "radau")


def member_rule(
    name: str, joints: int, hinge_length: float, member: str, length: float, peaks: tuple[bool, bool]
) -> Rule:
    """The rule called ``name`` for a member of some ``length`` [m].

    ``hinge_length`` [m] matters to ``"radau"``, and whether moments have ``peaks`` at the member's start and end to
    ``"graded"``.

    Raises
    ------
    ValueError
        For an unknown name or too few joints.
    InputError
        When the hinges are too long for the member.
    """
    if name == "radau":
        if 8.0 * hinge_length >= length:
            fault = f"hinges of {hinge_length:g} m are too long for a member of {length:g} m"
            raise InputError(f"members.{member}", fault, f"make them shorter than {length / 8.0:g} m")
        return radau(joints, hinge_length / length)
    if name not in RULES:
        raise ValueError(f'there is no rule "{name}"; the rules are {", ".join(RULES)}')
    if name == "graded":
        return graded(joints, start=peaks[0], end=peaks[1])
    return lobatto(joints) if name == "lobatto" else equal(joints)
