"""How a scene's own table says that it is simulated: its joints, their laws, their limits, the time integration."""

from __future__ import annotations

import math

from scene import Member, Scene, Simulation
from sim.joint import AVERAGE_ACCELERATION, IMPLICIT_EULER
from sim.limits import Limits
from sim.model import MemberModel, Model

#: Law of a member's joints when nothing is said, without hardening and with it.
_PLAIN, _HARDENING = "elastic-plastic", "fibre"


def model_of(scene: Scene) -> Model:
    """Where the joints of ``scene``'s members go, by what law they give way, and how they are stepped."""
    run = scene.simulation or Simulation()
    members = {}
    for name, member in scene.members.items():
        law = run.law or (_HARDENING if hardens(member) else _PLAIN)
        members[name] = MemberModel(run.rule, member.joints or run.joints, law, run.fibres, run.hinge_length)
    return Model(
        run.rule,
        run.joints,
        run.law or _PLAIN,
        fibres=run.fibres,
        damping=run.joint_damping,
        scheme=scheme_of(scene),
        hinge_length=run.hinge_length,
        members=members,
        refine_at=run.refine_at,
        coarse_joints=run.coarse_joints,
    )


def hardens(member: Member) -> bool:
    """Whether a member bears more the further it yields."""
    return member.material.tangent_modulus > 0.0 or member.material.curve is not None


def left_out(scene: Scene) -> tuple[str, ...]:
    """What of ``scene`` its chosen law does not follow; empty when there is nothing."""
    run = scene.simulation or Simulation()
    if run.law in (None, _HARDENING):
        return ()
    names = [name for name, member in scene.members.items() if hardens(member)]
    if not names:
        return ()
    which = f"members.{names[0]}" + (f" and {len(names) - 1} more" if names[1:] else "")
    return (f'{which}: the law "{run.law}" leaves hardening out; simulation.law = "fibre" follows it',)


def scheme_of(scene: Scene) -> tuple[float, float]:
    """β and δ of the time integration."""
    run = scene.simulation or Simulation()
    by_default = "average-acceleration" if scene.pushed is None else "implicit-euler"
    if (run.integration or by_default) == "implicit-euler":
        return IMPLICIT_EULER
    return AVERAGE_ACCELERATION[0], run.numerical_damping


def limits_of(member: Member) -> Limits:
    """When a member's joints break."""
    values = (member.break_elongation, member.break_slip, member.break_rotation)
    elongation, slip, rotation = (math.inf if value is None else float(value) for value in values)
    return Limits(elongation, slip, rotation)
