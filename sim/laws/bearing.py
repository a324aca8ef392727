"""A support that only pushes: N = k u while u < 0, and nothing while the body has lifted off. It dissipates nothing.

Parameters in memory: k. It has no state; one word is kept because every joint has some.
"""

from dataclasses import dataclass

import numpy as np

from sim.compiling import law_function
from sim.memory import floats


@law_function
def respond(parameters, state, deformation, out):  # type: ignore[no-untyped-def]  # noqa: ARG001
    k, u, r = floats(parameters, 1)[0], floats(deformation, 3)[0], floats(out, 9)
    for i in range(9):
        r[i] = 0.0
    if u < 0.0:
        r[0], r[3] = k * u, k


@law_function
def commit(parameters, state, deformation, out):  # type: ignore[no-untyped-def]  # noqa: ARG001
    k, u, r = floats(parameters, 1)[0], floats(deformation, 3)[0], floats(out, 5)
    for i in range(5):
        r[i] = 0.0
    r[0] = 0.5 * k * min(u, 0.0) ** 2


@dataclass(frozen=True)
class Bearing:
    """A support that only pushes, with a stiffness k [N/m]: N = k u while u < 0, and nothing else."""

    stiffness: float

    name = "bearing"
    yields_by = ("lifted off", "", "")
    respond_address = respond
    commit_address = commit

    def capacities(self) -> tuple[float, float, float]:
        """No force bounds it."""
        return np.inf, np.inf, np.inf

    def parameters(self) -> np.ndarray:
        """Parameters as they lie in memory."""
        return np.array([self.stiffness])

    def state(self) -> np.ndarray:
        """State of a new joint as it lies in memory."""
        return np.zeros(1)

    def elastic_tangent(self) -> tuple[float, float, float, float, float, float]:
        """Upper triangle of ∂s/∂q while it pushes, row by row."""
        return self.stiffness, 0.0, 0.0, 0.0, 0.0, 0.0
