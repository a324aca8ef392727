"""Joints to be: what they take over from those that they replace, and where they sit on their bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.elastic_line import Chain
from sim.joint import DuctileJoint
from sim.kernels import layout as at
from sim.laws import Law
from sim.member_joints import MemberJoints
from sim.plastic_state import residual, stretched
from sim.rules import Rule

# Points of two rules that are closer than this share of a member's length are the same.
_SAME = 1e-9
#: The joints at the ends of a member, None where nothing holds it.
Ends = tuple[DuctileJoint | None, DuctileJoint | None]


@dataclass
class Successor:
    """A joint to be: its law and that law's state, a kink (3,), and what it went through, as the kernels keep it."""

    law: Law
    state: np.ndarray
    kink: np.ndarray
    result: np.ndarray

    @classmethod
    def new(cls, maker: MemberJoints, name: str, rule: Rule, i: int) -> Successor:
        law = maker.law(name, rule, i)
        return cls(law, law.state(), np.zeros(3), np.zeros(at.RESULT_WORDS))


def state_of(joint: DuctileJoint) -> np.ndarray:
    """State of a joint's law in its structure."""
    assert joint.structure is not None
    return joint.structure.tables.state(joint.index)


def holds(ends: Ends, i: int, rule: Rule) -> bool:
    """Whether point ``i`` of a member's rule has a joint."""
    return not ((i == 0 and ends[0] is None) or (i == len(rule.points) - 1 and ends[1] is None))


def shares_at(there: Sequence[bool], points: np.ndarray, x: float) -> np.ndarray:
    """Shares of the joints at ``points``, those that are there, in one at ``x``, by the lever rule."""
    own = np.flatnonzero(there)
    shares = np.zeros(len(points))
    nearest = own[np.argmin(np.abs(points[own] - x))]
    before, after = own[points[own] < x], own[points[own] > x]
    if abs(points[nearest] - x) < _SAME or not len(before) or not len(after):
        shares[nearest] = 1.0
        return shares
    i, k = before[-1], after[0]
    shares[k] = (x - points[i]) / (points[k] - points[i])
    shares[i] = 1.0 - shares[k]
    return shares


def hand_on(joint: DuctileJoint, result: np.ndarray, to: Sequence[tuple[Successor | None, float]]) -> None:
    """Give what an old joint has gone through to new ones, in shares."""
    state = state_of(joint)
    rest = residual(joint.law, state)
    sums = [*range(at.RESULT_PLASTIC, at.RESULT_PLASTIC + 4), at.RESULT_DISSIPATED, at.RESULT_VISCOUS, at.RESULT_USED]
    for own, share in to:
        if own is None or share == 0.0:
            continue
        kept = np.zeros(3)
        if share == 1.0 and type(own.law) is type(joint.law) and len(own.state) == len(state):
            # Joints of a member give way along it in proportion to the length that they stand for.
            ratio = joint.law.elastic_tangent()[0] / own.law.elastic_tangent()[0]
            own.state = stretched(own.law, state, ratio)
            kept = residual(own.law, own.state)
        own.kink += share * rest - kept
        own.result[sums] += share * result[sums]


def lay(joint: DuctileJoint, kink: np.ndarray, fine: Chain, i: int, ends: Ends) -> None:
    """Give a new joint the place on its bodies at which it bears what it shall."""
    g = joint.geometry
    g[at.ANCHOR_A : at.ANCHOR_A + 2] = fine.points[i] - fine.middles[i - 1], 0.0
    g[at.REST_A] = g[at.REST_B] = 0.0
    if i < len(fine.middles):
        g[at.ANCHOR_B : at.ANCHOR_B + 2] = fine.points[i] - fine.middles[i], 0.0
    if i == 0 and ends[0] is not None:
        g[at.ANCHOR_A : at.ANCHOR_A + 2] = ends[0].geometry[at.ANCHOR_A : at.ANCHOR_A + 2]
        g[at.REST_A] = ends[0].geometry[at.REST_A]
    if i == len(fine.middles) and ends[1] is not None:
        g[at.ANCHOR_B : at.ANCHOR_B + 2] = ends[1].geometry[at.ANCHOR_B : at.ANCHOR_B + 2]
        g[at.REST_B] = ends[1].geometry[at.REST_B]
    c, s = math.cos(g[at.REST_A]), math.sin(g[at.REST_A])
    g[at.ANCHOR_A] += float(c * kink[0] - s * kink[1])
    g[at.ANCHOR_A + 1] += float(s * kink[0] + c * kink[1])
    g[at.REST_B] -= float(kink[2])
    g[at.AXIS_A : at.AXIS_A + 2] = math.cos(g[at.REST_A]), math.sin(g[at.REST_A])
    g[at.AXIS_B : at.AXIS_B + 2] = math.cos(g[at.REST_B]), math.sin(g[at.REST_B])
