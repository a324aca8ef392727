"""Elastic–perfectly plastic joint with N, Q and M capped one by one: the joint of the original paper.

    s_i = k_i (q_i - p_i),  |s_i| ≤ cap_i,  ṗ_i only at the cap.

Parameters in memory: k (3), cap (3). State: p (3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from capacity import Capacity
from sim.compiling import law_function
from sim.laws.checks import check_length, check_three
from sim.memory import floats


@law_function
def respond(parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    k, p, q, r = floats(parameters, 6), floats(state, 3), floats(deformation, 3), floats(out, 9)
    for i in range(3):
        force, cap = k[i] * (q[i] - p[i]), k[3 + i]
        r[i] = min(max(force, -cap), cap)
    r[3] = k[0] if abs(r[0]) < k[3] else 0.0
    r[4], r[5] = 0.0, 0.0
    r[6] = k[1] if abs(r[1]) < k[4] else 0.0
    r[7] = 0.0
    r[8] = k[2] if abs(r[2]) < k[5] else 0.0


@law_function
def commit(parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    k, p, q, r = floats(parameters, 6), floats(state, 3), floats(deformation, 3), floats(out, 5)
    energy, work = 0.0, 0.0
    for i in range(3):
        force = k[i] * (q[i] - p[i])
        held = min(max(force, -k[3 + i]), k[3 + i])
        r[2 + i] = 0.0
        if held != force:
            slip = (force - held) / k[i]
            p[i] += slip
            r[2 + i] = slip
            work += held * slip
        if k[i] > 0.0:
            energy += 0.5 * held * held / k[i]
    r[0], r[1] = energy, work


class Capped:
    """What the laws have in common whose N, Q and M are capped one by one."""

    stiffness: tuple[float, float, float]
    capacity: tuple[float, float, float]

    yields_by = ("N", "Q", "M")
    respond_address = respond
    commit_address = commit

    def capacities(self) -> tuple[float, float, float]:
        """N_max [N], Q_max [N] and M_max [N m]."""
        return self.capacity

    def parameters(self) -> np.ndarray:
        """Parameters as they lie in memory."""
        return np.array([*self.stiffness, *self.capacity])

    def state(self) -> np.ndarray:
        """State of a new joint as it lies in memory."""
        return np.zeros(3)

    def elastic_tangent(self) -> tuple[float, float, float, float, float, float]:
        """Upper triangle of ∂s/∂q while elastic, row by row."""
        k = self.stiffness
        return k[0], 0.0, 0.0, k[1], 0.0, k[2]


@dataclass(frozen=True)
class ElasticPlastic(Capped):
    """Elastic–perfectly plastic, with N, Q and M capped one by one: s_i = k_i (q_i - p_i), |s_i| ≤ cap_i.

    Deformations q_i are extension, slip and rotation; their plastic parts p_i grow at the caps alone. The joint of
    J. Nikula, J. Mikkola, T. Björk, Breakable elastic-plastic constraint for rigid body simulation.

    Parameters
    ----------
    stiffness : (float, float, float)
        Axial [N/m], shear [N/m] and rotational [N m/rad] stiffness; 0 where nothing is borne.
    capacity : (float, float, float)
        N_max [N], Q_max [N], M_max [N m]; `math.inf` for no limit.

    Raises
    ------
    InputError
        When either is not three numbers from 0 on.
    """

    stiffness: tuple[float, float, float]
    capacity: tuple[float, float, float]

    name = "elastic-plastic"

    def __post_init__(self) -> None:
        check_three("stiffness", self.stiffness, "N/m, N/m, N m/rad")
        check_three("capacity", self.capacity, "N, N, N m")

    @classmethod
    def of_section(cls, section: Capacity, length: float) -> ElasticPlastic:
        """A joint that stands for ``length`` [m] of a member and bears what its section bears."""
        check_length(length)
        stiffness = (section.EA / length, section.GA_s / length, section.EI / length)
        return cls(stiffness, (section.N_max, section.Q_max, section.M_max))
