"""What the state of a joint's law means, where another joint takes it over.

The state of a law is its plastic deformation, but for the fibre law, whose fibres have strains of their own. A new law
for members whose state is something else has its say here.
"""

from __future__ import annotations

import ctypes

import numpy as np

from sim.laws import FibreSection, Law

_RESPOND = ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * 4)


def borne(law: Law, parameters: np.ndarray, state: np.ndarray, deformation: np.ndarray) -> np.ndarray:
    """N, Q and M of a joint with ``deformation`` (3,) by its law, (3,)."""
    q, out = np.array(deformation, dtype=float), np.zeros(9)
    _RESPOND(law.respond_address)(*(array.ctypes.data for array in (parameters, state, q, out)))
    return out[:3]


def residual(law: Law, state: np.ndarray) -> np.ndarray:
    """Deformation at which a joint in ``state`` bears nothing, (3,) [m, m, rad], if it unloads elastically."""
    if not isinstance(law, FibreSection):
        return np.array(state)
    stiff, y, strain = law.youngs_modulus * law.area, law.y, state[1:]
    axial = np.array([[stiff.sum(), -(stiff * y).sum()], [-(stiff * y).sum(), (stiff * y**2).sum()]])
    # Of a hinge, whose fibres all lie at the axis, the curvature is nothing; solving would not do.
    mean, curvature = np.linalg.lstsq(axial, [(stiff * strain).sum(), -(stiff * y * strain).sum()])[0]
    return np.array([law.length * mean, state[0], law.length * curvature])


def locked_in(law: Law, state: np.ndarray) -> float:
    """Elastic energy that is left in a joint in ``state`` when it bears nothing [J]: of fibres against each other."""
    if not isinstance(law, FibreSection):
        return 0.0
    e, et, strain = law.youngs_modulus, law.tangent_modulus, state[1:]
    u, _, turn = residual(law, state)
    stress = e * ((u - law.y * turn) / law.length - strain)
    hardening = e * et / (e - et)
    return float(0.5 * law.length * np.sum(law.area * (stress**2 / e + hardening * strain**2)))


def stretched(law: Law, state: np.ndarray, ratio: float) -> np.ndarray:
    """State of a joint with the same strains that stands for ``ratio`` times the length."""
    if not isinstance(law, FibreSection):
        return ratio * state
    return np.append(ratio * state[0], state[1:])
