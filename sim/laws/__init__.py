"""Joint laws: force from deformation, one file a law.

A law is two C functions, compiled in its own file and called by the solver through their addresses, and a description
that lays its parameters and state out in memory. A new law needs nothing else.
"""

from typing import Protocol

import numpy as np

from sim.laws.bearing import Bearing
from sim.laws.elastic_plastic import ElasticPlastic
from sim.laws.fibre import FibreSection
from sim.laws.interaction import InteractionPlastic
from sim.laws.of_section import LAWS, section_law
from sim.laws.rigid_plastic import RigidPlastic


class Law(Protocol):
    """What a law has to offer.

    ``respond_address`` is called with the addresses of parameters, state, q = (u, v, θ) and out; it writes the force
    s = (N, Q, M) and the upper triangle of ∂s/∂q, row by row, to out and changes nothing else. ``commit_address`` is
    called the same way once a step's q is final; it updates the state and writes to out the elastic energy [J], the
    work dissipated in this step [J], and the plastic deformation added in it (u, v, θ) [m, m, rad].
    """

    name: str
    #: What gives way when N, Q or M yields: their names, or that of what they share.
    yields_by: tuple[str, str, str]

    @property
    def respond_address(self) -> int:
        """Address of the first function."""

    @property
    def commit_address(self) -> int:
        """Address of the second."""

    def capacities(self) -> tuple[float, float, float]:
        """N_max [N], Q_max [N] and M_max [N m], each when it acts alone."""

    def parameters(self) -> np.ndarray:
        """Parameters as they lie in memory."""

    def state(self) -> np.ndarray:
        """State of a new joint as it lies in memory."""

    def elastic_tangent(self) -> tuple[float, float, float, float, float, float]:
        """Upper triangle of ∂s/∂q while elastic, row by row; no tangent of the law may exceed it."""


__all__ = [
    "LAWS",
    "Bearing",
    "ElasticPlastic",
    "FibreSection",
    "InteractionPlastic",
    "Law",
    "RigidPlastic",
    "section_law",
]
