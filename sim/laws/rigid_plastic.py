"""Rigid–plastic joint with N, Q and M capped one by one: nothing moves that can be seen until a cap is reached.

It is the elastic–plastic law with a stiffness so high that a joint yields after a hundredth of a millimetre, or a tenth
of a millimetre a metre. Without any compliance the solver's matrix would not exist; with a tenth of this one, pieces of
a few centimetres in steps of 1/60 s are at the end of what double precision resolves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from capacity import Capacity, InputError
from sim.laws.checks import check_length, check_three
from sim.laws.elastic_plastic import Capped

#: Extension, slip and rotation at which a joint yields [m, m, rad].
INVISIBLE = (1e-5, 1e-5, 1e-4)
#: A member that is too weak to be stiff by that is still this much stiffer than it would be elastically.
STIFFER = 10.0


@dataclass(frozen=True)
class RigidPlastic(Capped):
    """Rigid until N, Q or M reaches its own capacity, then plastic; nothing elastic is seen.

    Parameters
    ----------
    capacity : (float, float, float)
        N_max [N], Q_max [N], M_max [N m]; without limit where infinite, 0 where nothing is borne.
    stiffness : (float, float, float), optional
        Axial [N/m], shear [N/m] and rotational [N m/rad] stiffness that stand for none; by default those of a joint
        that yields at `INVISIBLE`, and where there is no limit those of the greatest.

    Raises
    ------
    InputError
        When the capacity is not three numbers from 0 on, or none is finite and positive, for then nothing says what is
        stiff.
    """

    capacity: tuple[float, float, float]
    stiffness: tuple[float, float, float] = (math.nan, math.nan, math.nan)

    name = "rigid-plastic"

    def __post_init__(self) -> None:
        check_three("capacity", self.capacity, "N, N, N m")
        if not any(0.0 < cap < math.inf for cap in self.capacity):
            fault = f"of {self.capacity!r} none is finite and positive, so nothing says what is stiff"
            raise InputError("capacity", fault, "give one that is, or an ElasticPlastic with the stiffness wanted")
        if any(map(math.isnan, self.stiffness)):
            most = max(cap for cap in self.capacity if cap < math.inf)
            stiffness = tuple(min(cap, most) / reach for cap, reach in zip(self.capacity, INVISIBLE, strict=True))
            object.__setattr__(self, "stiffness", stiffness)

    @classmethod
    def of_section(cls, section: Capacity, length: float) -> RigidPlastic:
        """A joint that stands for ``length`` [m] of a member; at least `STIFFER` times as stiff as the member is."""
        check_length(length)
        law = cls((section.N_max, section.Q_max, section.M_max))
        elastic = (section.EA / length, section.GA_s / length, section.EI / length)
        N, Q, M = (max(k, STIFFER * e) for k, e in zip(law.stiffness, elastic, strict=True))
        return cls(law.capacity, (N, Q, M))
