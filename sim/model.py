"""How a scene is turned into rigid bodies, and how these are stepped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from capacity import InputError
from sim.joint import IMPLICIT_EULER


@dataclass(frozen=True)
class MemberModel:
    """Where the joints of one member go, and by what law they give way; attributes as those of `Model`."""

    rule: str
    joints: int
    law: str
    fibres: int = 8
    hinge_length: float | None = None


@dataclass(frozen=True)
class Model:
    """Where the joints of the members go, by what law they give way, and how they are stepped.

    Attributes
    ----------
    rule : str
        A name in `sim.rules.RULES`: where the joints of a member go.
    joints : int
        Points of the rule in each member; the one at a free end needs no joint.
    law : str
        A name in `sim.laws.LAWS`.
    fibres : int
        Fibres a section, for the fibre law; at least 4.
    dt : float
        Step [s].
    iterations : int
        Iterations of Chipmunk's solver in a step.
    damping : float
        Viscous damping of every joint as a share of its stiffness [s]: a vibration at ω has the damping ratio
        ω · damping / 2.
    scheme : (float, float)
        β and δ of the time integration.
    hinge_length : float, optional
        Length of the hinges of the rule ``"radau"`` [m]; by default the depth of each member's section.
    shear_yields : bool
        Whether joints bear no more shear than Q_max; where not, the law ``"interaction"`` still knows of it.
    refine_at : float, optional
        Members start coarse, with `coarse_joints` Gauss–Lobatto points, and are cut as the model says once
        |N| / N_max + |M| / M_yield or |Q| / Q_max passes this in one of their joints [-]. By default they do not start
        coarse.
    coarse_joints : int
        Where a member starts coarse. With 3 and more, the elastic answer is exact under loads at nodes and under even
        loads; with 4, its first natural frequency is right to a thousandth.
    members : mapping
        By name, the members that have a model of their own.

    Raises
    ------
    InputError
        When the step, the iterations or the damping are out of range.
    """

    rule: str
    joints: int
    law: str
    fibres: int = 8
    dt: float = 1.0 / 60.0
    iterations: int = 2
    damping: float = 0.0
    scheme: tuple[float, float] = IMPLICIT_EULER
    hinge_length: float | None = None
    shear_yields: bool = True
    refine_at: float | None = None
    coarse_joints: int = 4
    members: Mapping[str, MemberModel] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        if not 0.0 < self.dt < math.inf:
            raise InputError("dt", f"{self.dt!r} s is no step", "give one above 0, such as 1 / 60")
        if self.iterations < 1:
            raise InputError("iterations", f"{self.iterations!r} are too few", "give 1 or more")
        if not 0.0 <= self.damping < math.inf:
            raise InputError(
                "damping", f"{self.damping!r} s is no damping", "give 0 or more, 2 ζ / ω for a ratio ζ at ω"
            )

    def of(self, member: str) -> MemberModel:
        """The model of one member."""
        own = MemberModel(self.rule, self.joints, self.law, self.fibres, self.hinge_length)
        return self.members.get(member, own)
