"""Where the energy that structures were given has gone."""

from __future__ import annotations

from dataclasses import dataclass, fields

import pymunk


@dataclass(frozen=True)
class Energy:
    """The ledger of a structure [J]: ``external`` is the sum of all the others, to rounding.

    It goes on where joints come and go: what was lost until then is shared by the structures that take over, as their
    bodies are.

    How each is reckoned, and why, heads `sim.kernels.energy`; all belong to the middle of the bodies' next move, where
    their velocities belong. Ledgers of several structures add up with ``+``.

    Attributes
    ----------
    external : float
        Work done on the structure since it was built: by gravity and other forces, impulses, loads, bodies that are
        moved, other bodies at contacts; with the kinetic and elastic energy it had when it was built. What comes to it
        later brings its own, and what leaves it takes its own along.
    kinetic : float
        Of its bodies, at present: Σ ½ m v² + ½ I ω².
    elastic : float
        Stored in its joints at present.
    plastic : float
        Dissipated by its joints, with what was stored in them when they broke; of the last move's, half.
    contact : float
        Lost to friction and impact at its contacts, less what taking out overlap gave back.
    viscous : float
        Dissipated by its joints' damping.
    numerical : float
        Dissipated by the time integration.
    stock : float
        Of a whole space (`sim.SystemLedger`): what Chipmunk's own constraints took from loose bodies; springs store it
        and give it back, motors give.
    """

    external: float = 0.0
    kinetic: float = 0.0
    elastic: float = 0.0
    plastic: float = 0.0
    contact: float = 0.0
    viscous: float = 0.0
    numerical: float = 0.0
    stock: float = 0.0

    def __add__(self, other: Energy) -> Energy:
        return Energy(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))

    @property
    def gap(self) -> float:
        """What the ledger fails to close by [J]."""
        spent = self.kinetic + self.elastic + self.plastic + self.contact + self.viscous + self.numerical + self.stock
        return self.external - spent


def energy(space: pymunk.Space) -> Energy:
    """Ledger of all structures in ``space``; loose bodies have none, and take their share along when they come off."""
    from sim.joint import DuctileJoint

    joints = (joint for joint in space.constraints if isinstance(joint, DuctileJoint))
    structures = {joint.structure: None for joint in joints if joint.structure is not None}
    return sum((structure.energy for structure in structures), Energy())
