"""What can be read from a joint at any time, signed and in SI units."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pymunk

if TYPE_CHECKING:
    from sim.structure import Structure


class JointReadings(pymunk.Constraint):
    """The readings of a joint; `sim.readings` has those of all joints of a structure, as arrays."""

    _structure: Structure | None
    _index: int

    @property
    def force(self) -> tuple[float, float, float]:
        """N [N], Q [N] and M [N m] that the joint bore in the last step, 0 once broken; signs as in `scene`."""
        return (0.0, 0.0, 0.0) if self.broken else self._row("force")

    @property
    def impulse(self) -> float:
        """Size of the impulse of N and Q in the last step [N s]; 0 before the first."""
        return 0.0 if self._structure is None else float(super().impulse)

    @property
    def utilisation(self) -> tuple[float, float, float]:
        """|N| / N_max, |Q| / Q_max and |M| / M_max in the last step."""
        return self._row("utilisation")

    @property
    def deformation(self) -> tuple[float, float, float]:
        """Extension [m], slip [m] and rotation [rad] at the end of the last step."""
        return self._row("deformation")

    @property
    def plastic_deformation(self) -> tuple[float, float, float, float]:
        """Plastic elongation, shortening, slip [m] and rotation [rad], each summed without sign; until it broke."""
        return (
            (0.0,) * 4 if self._structure is None else tuple(self._structure.plastic_deformation[self._index].tolist())
        )

    @property
    def elastic_deformation(self) -> tuple[float, float, float]:
        """Extension [m], slip [m] and rotation [rad] that the force explains; the rest of `deformation` stays."""
        return self._row("elastic_deformation")

    @property
    def active_limit(self) -> str:
        """What gave way in the last step: ``""``, ``"M"``, ``"N+Q"``, ``"N-Q-M"``, ``"fibres"``, ``"broken"``."""
        from sim.joint_arrays import JointArrays

        return JointArrays([self]).active_limit[0]

    @property
    def capacity_used(self) -> float:
        """Share of the plastic capacity used, the largest over elongation, slip and rotation; 1 when broken."""
        return 0.0 if self._structure is None else float(self._structure.capacity_used[self._index])

    @property
    def dissipated(self) -> float:
        """Plastic work done in the joint so far [J]; once broken, with what was stored in it then."""
        return 0.0 if self._structure is None else float(self._structure.dissipated[self._index])

    @property
    def broken(self) -> bool:
        """Whether the joint has broken."""
        return self._structure is not None and bool(self._structure.broken[self._index])

    def _row(self, name: str) -> tuple[float, float, float]:
        if self._structure is None:
            return 0.0, 0.0, 0.0
        x, y, z = getattr(self._structure, name)[self._index].tolist()
        return x, y, z
