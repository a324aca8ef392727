"""How a scene's own table says that it is simulated: its joints, their laws, their limits, the time integration."""

from __future__ import annotations

import math

from scene import Member, Scene, Simulation
from sim.joint import AVERAGE_ACCELERATION, IMPLICIT_EULER
from sim.limits import Limits
from sim.model import MemberModel, Model

#: Law of a member's joints when nothing is said: of what has a curve or hardens, and of all others.
_SPREADING, _PLAIN = "fibre", "elastic-plastic"
#: Joints of a member by rule, and fibres, when nothing is said.
_JOINTS, _FIBRES = {"lobatto": 5, "graded": 9, "equal": 5, "radau": 6}, 8
#: The same where a push or a motion is followed along its curve: most within 1 % of the largest load, or 5 % of a peak.
_JOINTS_OF_CURVE, _FIBRES_OF_CURVE = _JOINTS | {"lobatto": 9}, 16
#: Fewest joints of a graded rule.
_FEWEST_GRADED = 6


def model_of(scene: Scene) -> Model:
    """Where the joints of ``scene``'s members go, by what law they give way, and how they are stepped."""
    run = scene.simulation or Simulation()
    every = _member_model(scene, run.joints, hardens=False)
    members = {
        name: _member_model(scene, member.joints or run.joints, hardens=hardens(member))
        for name, member in scene.members.items()
    }
    return Model(
        every.rule,
        every.joints,
        every.law,
        fibres=every.fibres,
        damping=run.joint_damping,
        scheme=scheme_of(scene),
        hinge_length=run.hinge_length,
        members=members,
        refine_at=run.refine_at,
        coarse_joints=run.coarse_joints,
    )


def _member_model(scene: Scene, joints: int | None, *, hardens: bool) -> MemberModel:
    """The model of a member of so many joints, with what the scene does not say filled in."""
    run, pushed = scene.simulation or Simulation(), scene.pushed is not None
    curve = pushed or scene.motion is not None
    graded = pushed and (joints is None or joints >= _FEWEST_GRADED)
    rule = run.rule or ("graded" if graded else "lobatto")
    law = run.law or (_SPREADING if curve or hardens else _PLAIN)
    fibres = run.fibres or (_FIBRES_OF_CURVE if curve else _FIBRES)
    return MemberModel(rule, joints or (_JOINTS_OF_CURVE if curve else _JOINTS)[rule], law, fibres, run.hinge_length)


def hardens(member: Member) -> bool:
    """Whether a member bears more the further it yields."""
    return member.material.tangent_modulus > 0.0 or member.material.curve is not None


def left_out(scene: Scene) -> tuple[str, ...]:
    """What of ``scene`` its chosen law does not follow; empty when there is nothing."""
    run = scene.simulation or Simulation()
    if run.law in (None, _SPREADING):
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
