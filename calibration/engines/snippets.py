"""The files of engines that are handed a template each: Box2D, Bullet, Rapier, Godot, Unity, Unreal; and plain JSON."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace
from typing import Any

from calibration.engines.handover import Handover, JointTerms
from calibration.engines.text import number, render


def box2d(handover: Handover, notes: str) -> str:
    """C for Box2D 3.2: a revolute joint, and a motor joint's angular spring with its largest torque."""
    return _filled("box2d.c.j2", handover, notes, "FLT_MAX", "f")


def bullet(handover: Handover, notes: str) -> str:
    """C++ for Bullet: ``btGeneric6DofSpring2Constraint`` with a motor that stands still until M_max."""
    return _filled("bullet.cpp.j2", handover, notes, "BT_LARGE_FLOAT")


def rapier(handover: Handover, notes: str) -> str:
    """Rust for rapier2d: a revolute joint with a force-based position motor and its largest torque."""
    return _filled("rapier.rs.j2", handover, notes, "Real::INFINITY")


def godot(handover: Handover, notes: str) -> str:
    """GDScript for Godot 4: ``Generic6DOFJoint3D`` with a motor that stands still until M_max."""
    return _filled("godot.gd.j2", handover, notes, "INF", ticks=round(1.0 / handover.model.dt))


def unity(handover: Handover, notes: str) -> str:
    """C# for Unity: ``ConfigurableJoint`` with an angular drive and its largest torque, in SI units."""
    on_b = [joint if joint.b >= 0 else _reversed(joint) for joint in handover.joints]
    return _filled("unity.cs.j2", handover, notes, "Mathf.Infinity", "f", joints_on_b=on_b)


def unreal(handover: Handover, notes: str) -> str:
    """C++ for Unreal 5: ``UPhysicsConstraintComponent`` with an angular drive, in cm, kg, s and degrees."""
    return _filled("unreal.cpp.j2", handover, notes, "MAX_flt", "f")


def plain_json(handover: Handover, notes: str) -> str:
    """Everything in SI units, with frequencies, damping and limits beside stiffness and capacity; null: no limit."""
    joints = [
        {
            **asdict(joint),
            "frequency": joint.frequency,
            "damping": joint.damping,
            "yield_rotation": joint.yield_rotation,
            "slide": joint.slide,
        }
        for joint in handover.joints
    ]
    whole = {
        "format": "ductile-joints/handover/1",
        "notes": notes.splitlines(),
        "units": "SI: m, kg, s, N, rad, Hz",
        **asdict(handover),
        "joints": joints,
    }
    return json.dumps(_finite(whole), indent=1) + "\n"


def _filled(template: str, handover: Handover, notes: str, infinite: str, suffix: str = "", **more: Any) -> str:
    return render(
        template,
        infinite,
        suffix,
        notes=notes,
        dt=number(handover.model.dt),
        iterations=handover.model.iterations,
        gravity=handover.gravity,
        bodies=handover.bodies,
        joints=handover.joints,
        **more,
    )


def _reversed(joint: JointTerms) -> JointTerms:
    """The same joint from b to a."""
    return replace(
        joint,
        a=joint.b,
        b=joint.a,
        anchor_a=joint.anchor_b,
        anchor_b=joint.anchor_a,
        direction=joint.direction + math.pi,
        rest_angle=-joint.rest_angle,
    )


def _finite(value: Any) -> Any:
    """``value`` with null for what is infinite, which JSON does not know."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and math.isinf(value) else value
