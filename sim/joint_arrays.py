"""Many joints read at once, whatever structures they belong to."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pymunk

from sim.joint import DuctileJoint
from sim.structure import Structure


class JointArrays:
    """What joints bear, deform and have used up, as arrays with a row for each; read anew at every access.

    Parameters
    ----------
    constraints : iterable
        Joints, or all constraints of a space; those that are no ductile joint are left out.

    Attributes
    ----------
    joints : tuple of DuctileJoint
        In the order of the rows. They stay when they break.
    """

    def __init__(self, constraints: Iterable[pymunk.Constraint]) -> None:
        self.joints = tuple(c for c in constraints if isinstance(c, DuctileJoint))

    def _read(self, name: str, *shape: int, kind: type = float) -> np.ndarray:
        """A property of the joints' structures; zeros before the first step."""
        structures = {joint.structure for joint in self.joints}
        if len(structures) == 1 and None not in structures:
            # So it mostly is, and measures look at every step.
            all_rows: np.ndarray = getattr(structures.pop(), name)[[joint.index for joint in self.joints]]
            return all_rows
        values: np.ndarray = np.zeros((len(self.joints), *shape), dtype=kind)
        rows: dict[Structure, list[int]] = {}
        for row, joint in enumerate(self.joints):
            if joint.structure is not None:
                rows.setdefault(joint.structure, []).append(row)
        for structure, own in rows.items():
            values[own] = getattr(structure, name)[[self.joints[row].index for row in own]]
        return values

    @property
    def force(self) -> np.ndarray:
        """N, Q [N] and M [N m] that each bore in the last step, (n, 3), 0 once broken; signs as in `scene`."""
        return np.where(self.broken[:, None], 0.0, self._read("force", 3))

    @property
    def utilisation(self) -> np.ndarray:
        """|N| / N_max, |Q| / Q_max, |M| / M_max in the last step, (n, 3); 0 without a limit."""
        return self._read("utilisation", 3)

    @property
    def deformation(self) -> np.ndarray:
        """Extension, slip [m] and rotation [rad] at the end of the last step, (n, 3)."""
        return self._read("deformation", 3)

    @property
    def elastic_deformation(self) -> np.ndarray:
        """The part of it that the force explains, (n, 3); viscous forces stretch nothing."""
        return self._read("elastic_deformation", 3)

    @property
    def residual_deformation(self) -> np.ndarray:
        """The rest, signed, that would stay without force, (n, 3)."""
        residual: np.ndarray = self.deformation - self.elastic_deformation
        return residual

    @property
    def plastic_deformation(self) -> np.ndarray:
        """Plastic elongation, shortening, slip [m] and rotation [rad], each summed without sign, (n, 4)."""
        return self._read("plastic_deformation", 4)

    @property
    def capacity_used(self) -> np.ndarray:
        """Share of the plastic capacity used, the largest over its limits, (n,); 1 when broken."""
        return self._read("capacity_used")

    @property
    def dissipated(self) -> np.ndarray:
        """Plastic work so far, (n,) [J]."""
        return self._read("dissipated")

    @property
    def broken(self) -> np.ndarray:
        """Whether each has broken, (n,) bool."""
        return self._read("broken", kind=bool)

    @property
    def active_limit(self) -> tuple[str, ...]:
        """What gave way in each in the last step.

        ``""`` where nothing did; ``"N"``, ``"Q"``, ``"M"`` for caps, joined by ``+``; ``"N-Q-M"`` for a surface on
        which they interact; ``"fibres"`` when some yield; ``"broken"``.
        """
        names = []
        for joint, yielding, broken in zip(self.joints, self._read("yielding", 3, kind=bool), self.broken, strict=True):
            limits = dict.fromkeys(name for name, yields in zip(joint.law.yields_by, yielding, strict=True) if yields)
            names.append("broken" if broken else "+".join(limits))
        return tuple(names)
