"""What a structure's joints bear, as arrays over the joints, and how its solver fared."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.energy import Energy
from sim.kernels import layout as at

if TYPE_CHECKING:
    from sim.joint import DuctileJoint
    from sim.tables import Tables


class Readings:
    """The part of a `Structure` that only reads its memory; all arrays are copies."""

    joints: tuple[DuctileJoint, ...]
    tables: Tables
    _control: np.ndarray
    _settings: np.ndarray
    _result: np.ndarray

    @property
    def step(self) -> float:
        """The last step [s]; 0 before the first."""
        return float(self._settings[at.STEP])

    @property
    def deformation(self) -> np.ndarray:
        """Extension, slip and rotation of each joint at the end of the last step, (n, 3) [m, m, rad]."""
        return self._result[:, 0:3].copy()

    @property
    def force(self) -> np.ndarray:
        """N, Q and M that each joint bore in the last step, (n, 3) [N, N, N m]; signs as in `scene`."""
        return self._result[:, at.RESULT_FORCE : at.RESULT_FORCE + 3].copy()

    @property
    def utilisation(self) -> np.ndarray:
        """|N| / N_max, |Q| / Q_max and |M| / M_max of each joint in the last step, (n, 3); 0 without a limit."""
        capacities = np.array([joint.law.capacities() for joint in self.joints])
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.abs(self.force) / capacities
        return np.where((capacities > 0.0) & self.active[:, None], share, 0.0)

    @property
    def plastic_deformation(self) -> np.ndarray:
        """Plastic elongation, shortening, slip and rotation, each summed without sign, (n, 4) [m, m, m, rad]."""
        return self._result[:, at.RESULT_PLASTIC : at.RESULT_PLASTIC + 4].copy()

    @property
    def elastic_deformation(self) -> np.ndarray:
        """Deformation that the force explains without viscous damping, (n, 3) [m, m, rad]; 0 in a broken joint."""
        upper, damping = self.tables[at.STIFFNESS], self.tables[at.DAMPING]
        rates = np.array([joint.rate() for joint in self.joints]) if damping.any() else np.zeros((len(upper), 3))
        # Where a joint has no stiffness it has no force either.
        stiffness = upper[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
        elastic: np.ndarray = np.linalg.pinv(stiffness, hermitian=True) @ (self.force - damping * rates)[:, :, None]
        return np.where(self.active[:, None], elastic[:, :, 0], 0.0)

    @property
    def yielding(self) -> np.ndarray:
        """Whether the axial, shear and rotational part of each joint gave way in the last step, (n, 3) bool."""
        reach = self._settings[at.TANGENT_REACH]
        viscous = self.tables[at.DAMPING] / reach if reach > 0.0 else 0.0
        tangent = self.tables[at.RESPONSE][:, [at.TANGENT, at.TANGENT + 3, at.TANGENT + 5]] - viscous
        elastic = self.tables[at.STIFFNESS][:, [0, 3, 5]]
        yields: np.ndarray = (tangent < (1.0 - 1e-9) * elastic) & self.active[:, None] & (reach > 0.0)
        return yields

    @property
    def elastic_energy(self) -> np.ndarray:
        """Elastic energy in each joint, (n,) [J]."""
        return self._result[:, at.RESULT_ELASTIC].copy()

    @property
    def dissipated(self) -> np.ndarray:
        """Plastic work done in each joint so far, (n,) [J]; with what was stored in it when it broke."""
        return self._result[:, at.RESULT_DISSIPATED].copy()

    @property
    def viscous_work(self) -> np.ndarray:
        """Work done against viscous damping in each joint so far, (n,) [J]."""
        return self._result[:, at.RESULT_VISCOUS].copy()

    @property
    def capacity_used(self) -> np.ndarray:
        """Share of each joint's plastic capacity used, (n,), 1 when broken."""
        return self._result[:, at.RESULT_USED].copy()

    @property
    def active(self) -> np.ndarray:
        """Whether each joint still holds, (n,) bool; not when it is broken or was taken out of the space."""
        return self.tables[at.ACTIVE].astype(bool)

    @property
    def broken(self) -> np.ndarray:
        """Whether each joint has broken, (n,) bool."""
        broken: np.ndarray = (self._result[:, at.RESULT_USED] >= 1.0) & (self.tables[at.ACTIVE] == 0)
        return broken

    @property
    def energy(self) -> Energy:
        """Ledger of the structure since it was built [J]."""
        return Energy(*self.tables[at.LEDGER][: at.LEDGER_TO_COME].tolist())

    @property
    def residual(self) -> float:
        """Residual impulses of the last solve, as velocities, as a share of the bodies' own [-]."""
        return float(self._settings[at.LAST_RESIDUAL])

    @property
    def newton_steps(self) -> int:
        """Newton steps taken so far."""
        return int(self._control[at.NEWTON_STEPS])

    @property
    def unconverged(self) -> int:
        """How many solves so far ended above the tolerance."""
        return int(self._control[at.UNCONVERGED])
