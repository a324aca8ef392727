"""What each member needs: decided from what the reference says that it bears."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fem_reference import MemberResult, MotionResult, PushAnswer, Pushover
from scene import Scene
from sim import MemberModel

Kind = Literal["rigid", "elastic", "elastic-plastic"]

#: A member whose share of all elastic energy is below this share of the target may bend at its ends alone: that
#: mistakes its own flexibility by half at most.
RIGID_SHARE = 0.2
#: Joints of a rigid piece, at its ends, and of an elastic member: with three Gauss–Lobatto points every moment up to a
#: parabola, that of an even load, is integrated exactly.
RIGID_JOINTS, ELASTIC_JOINTS = 2, 3


@dataclass(frozen=True)
class MemberPlan:
    """What one member needs, and why.

    Attributes
    ----------
    kind : str
        ``"rigid"``, ``"elastic"`` or ``"elastic-plastic"``.
    utilisation : float
        Largest |N| / N_max + |M| / M_yield along the path, 1 at first yield; an upper bound where the member bears a
        load along its length [-].
    energy_share : float
        Its share of the elastic energy of all members, where that is largest along the path; in a motion its largest
        elastic energy over the largest of all together [-].
    moves : bool
        Whether that was a motion: then waves run through it, and how many joints it takes is found by trial.
    """

    kind: Kind
    utilisation: float
    energy_share: float
    moves: bool = False

    @property
    def fixed(self) -> MemberModel | None:
        """The model that does for it; None where that is to be found by trial."""
        if self.kind == "rigid":
            return MemberModel("lobatto", RIGID_JOINTS, "elastic-plastic")
        if self.kind == "elastic" and not self.moves:
            return MemberModel("lobatto", ELASTIC_JOINTS, "elastic-plastic")
        return None

    def reason(self, model: MemberModel) -> str:
        """Why the member has ``model``, in words."""
        most = f"{100.0 * self.utilisation:.0f} % of first yield"
        if self.kind == "rigid":
            share = f"{100.0 * self.energy_share:.2g} % of the elastic energy"
            return f"never above {most} and {share}: one rigid piece, {model.joints} joints at its ends"
        if self.kind == "elastic":
            return f"never above {most}: {model.joints} elastic joints"
        if math.isnan(self.utilisation):
            how = "the reference is a continuum, which knows no members"
        else:
            how = f"up to {self.utilisation:.2f} times the forces of first yield"
        if model.law == "fibre":
            return f"{how}: {model.joints} joints of {model.fibres} fibres, which yield bit by bit"
        return f"{how}: {model.joints} {model.law} joints"


def member_plans(scene: Scene, reference: PushAnswer, target_error: float) -> dict[str, MemberPlan]:
    """What each member of ``scene`` needs for a path error of ``target_error``."""
    if not isinstance(reference, Pushover):
        return {name: MemberPlan("elastic-plastic", math.nan, math.nan) for name in scene.members}
    energy = {name: _elastic_energy(scene, name, reference.members[name]) for name in scene.members}
    total = np.maximum(sum(energy.values()), np.finfo(float).tiny)
    return _decided(
        {
            name: (_utilisation(scene, name, reference), float((energy[name] / total)[1:].max(initial=0.0)))
            for name in scene.members
        },
        target_error,
    )


def motion_plans(reference: MotionResult, target_error: float) -> dict[str, MemberPlan]:
    """What each member needs for errors of ``target_error`` of the peak."""
    shares = reference.energy_share
    borne = {name: (share, shares[name]) for name, share in reference.utilisation.items()}
    return _decided(borne, target_error, moves=True)


def _decided(
    borne: Mapping[str, tuple[float, float]], target_error: float, *, moves: bool = False
) -> dict[str, MemberPlan]:
    """Plans from utilisations and shares of the elastic energy."""
    plans = {}
    for name, (utilisation, share) in borne.items():
        kind: Kind = "elastic-plastic"
        if utilisation < 1.0:
            kind = "rigid" if share < RIGID_SHARE * target_error else "elastic"
        plans[name] = MemberPlan(kind, utilisation, share, moves)
    if all(plan.kind == "rigid" for plan in plans.values()):
        return {name: replace(plan, kind="elastic") for name, plan in plans.items()}
    return plans


def _elastic_energy(scene: Scene, name: str, member: MemberResult) -> np.ndarray:
    """∫ M² / 2 EI dx + ∫ N² / 2 EA dx along the path for moments that are straight between the ends, (k,) [J]."""
    c, length = scene.capacity(name), scene.axis(name)[2]
    (a, b), force = member.end_forces[:, :, 2].T, member.end_forces[:, 0, 0]
    bending: np.ndarray = (a * a + a * b + b * b) * length / (6.0 * c.EI) + force**2 * length / (2.0 * c.EA)
    return bending


def _utilisation(scene: Scene, name: str, reference: Pushover) -> float:
    """Largest |N| / N_max + |M| / M_yield along the path."""
    c, length = scene.capacity(name), scene.axis(name)[2]
    member = reference.members[name]
    spread = _load_across(scene, name, "dead") + np.abs(reference.load) * _load_across(scene, name, "proportional")
    N = np.abs(member.end_forces[:, :, 0]).max(axis=1)
    M = np.abs(member.end_forces[:, :, 2]).max(axis=1) + spread * length**2 / 8.0
    return float((N / c.N_max + M / c.M_yield).max())


def _load_across(scene: Scene, name: str, kind: Literal["dead", "proportional"]) -> float:
    """Size of the load per length on a member [N/m]."""
    on_it = [load.per_length for load in scene.loads_of(kind) if load.member == name]
    x, y = (sum(float(load[axis]) for load in on_it) for axis in (0, 1))
    if kind == "dead":
        y -= scene.weight_per_length(name)
    return math.hypot(x, y)
