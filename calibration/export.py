"""A calibration as data: one JSON object, the joint table, and the raw curves."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import pymunk

from calibration.member_plans import MemberPlan
from calibration.motion_tuning import MotionCalibration
from calibration.trials import Trial
from calibration.tuning import Calibration
from calibration.versions import versions
from fem_reference import Pushover
from scene import Scene
from sim import DuctileJoint, Model, assemble


def settings(model: Model) -> dict[str, Any]:
    """A model's settings; fibres only where the law has any."""
    values = asdict(model)
    values["points"] = values.pop("joints")
    if model.law != "fibre":
        del values["fibres"]
    return values


def subject(result: Calibration | MotionCalibration) -> dict[str, Any]:
    """What was calibrated, and what its members bear."""
    return {
        "scene": result.name,
        "title": result.scene.title,
        "capacity": {name: capacity.values() for name, capacity in result.capacity.items()},
    }


def outcome(result: Calibration | MotionCalibration) -> dict[str, Any]:
    """Which models broke down, and what came of it."""
    return {
        "failures": [{**settings(failure.model), "reason": failure.reason} for failure in result.failures],
        "target_error": result.target_error,
        "target_met": result.target_met,
        "limit": result.limit,
        "remarks": list(result.remarks),
        "versions": versions(),
    }


def members_object(plans: Mapping[str, MemberPlan], model: Model) -> dict[str, Any]:
    """What was decided for each member, and why."""
    return {
        name: {
            **{key: _plain(getattr(plan, key)) for key in ("kind", "utilisation", "energy_share")},
            "why": plan.reason(model.of(name)),
            "model": asdict(model.of(name)),
        }
        for name, plan in plans.items()
    }


def calibration_object(result: Calibration) -> dict[str, Any]:
    """The calibration as one object for JSON; SI units."""
    best, reference = result.best, result.reference
    return {
        **subject(result),
        "reference": {
            "method": reference.method,
            "displacement": reference.displacement.tolist(),
            "load": reference.load.tolist(),
            "error_estimate": reference.error_estimate,
            "elements": reference.elements,
            "fibres": reference.fibres if isinstance(reference, Pushover) else None,
            "seconds": reference.seconds,
        },
        "model": {
            **settings(best.model),
            "bodies": best.push.bodies,
            "joints": best.push.joints,
            "displacement": best.push.displacement.tolist(),
            "load": best.push.load.tolist(),
            "newton_steps": best.push.newton_steps,
            "unconverged": best.push.unconverged,
            "dissipated": best.push.dissipated,
            "seconds": best.push.seconds,
        },
        "members": members_object(result.plans, best.model),
        "errors": {**asdict(best.errors), "frequency": result.findings.frequency_error},
        "fit": None if result.fit is None else {**asdict(result.fit), "model": settings(result.fit.model)},
        "hinges": [
            {"where": pair.where, "load": pair.reference, "model_load": pair.model} for pair in result.findings.hinges
        ],
        "hinges_in_order": result.findings.hinges_in_order,
        "speed": {
            "seconds_per_simulated_second": best.push.seconds_per_simulated_second,
            "microseconds_per_joint_step": best.push.microseconds_per_joint_step,
        },
        "pareto": [_tried(trial) for trial in result.trials],
        **outcome(result),
    }


def _tried(trial: Trial) -> dict[str, Any]:
    return {
        **settings(trial.model),
        "bodies": trial.push.bodies,
        "joints": trial.push.joints,
        **asdict(trial.errors),
        "cost": trial.cost,
        "seconds": trial.push.seconds,
        "seconds_per_simulated_second": trial.push.seconds_per_simulated_second,
        "microseconds_per_joint_step": trial.push.microseconds_per_joint_step,
    }


def joint_table(scene: Scene, model: Model, name: str = "") -> dict[str, Any]:
    """Everything needed to build the bodies and joints of ``scene`` elsewhere; SI units.

    Bodies have mass, moment of inertia, position, and angle; joints say which bodies they hold (``"ground"`` for the
    world), where, in which direction, and by what law. An unlimited capacity is null.
    """
    assembly = assemble(scene, model, shapes=False)
    names = dict.fromkeys(assembly.grounds, "ground")
    counts: dict[str, int] = {}
    for piece in assembly.pieces:
        counts[piece.member] = counts.get(piece.member, 0) + 1
        names[piece.body] = f"{piece.member}.{counts[piece.member]}"
    for body in assembly.space.bodies:
        names.setdefault(body, f"node.{len(names)}")
    spans = {piece.body: (piece.start, piece.end) for piece in assembly.pieces}
    return {
        "format": "ductile-joints/1",
        "units": "SI: m, kg, s, N, rad",
        "scene": name or scene.title,
        "gravity": float(scene.gravity),
        "model": settings(model),
        "bodies": [_body(body, label, spans.get(body)) for body, label in names.items() if label != "ground"],
        "joints": [
            {**_joint(joint, names), **_place(assembly.places[i] if i < len(assembly.places) else None)}
            for i, joint in enumerate(assembly.joints)
        ],
        "versions": versions(),
    }


def _body(body: pymunk.Body, label: str, span: tuple[float, float] | None) -> dict[str, Any]:
    return {
        "name": label,
        "mass": body.mass,
        "moment": body.moment,
        "position": list(body.position),
        "angle": body.angle,
        "along_member": None if span is None else list(span),
    }


def _joint(joint: DuctileJoint, names: dict[pymunk.Body, str]) -> dict[str, Any]:
    tangent = joint.law.elastic_tangent()
    law = _plain(asdict(joint.law))  # type: ignore[call-overload]
    return {
        "a": names[joint.a],
        "b": names[joint.b],
        "at": list(joint.at),
        "anchor_a": list(_anchor_a(joint, names)),
        "anchor_b": list(joint.b.world_to_local(joint.at)),
        "direction": joint.direction,
        "turn": joint.turn,
        "elastic_stiffness": {"axial": tangent[0], "shear": tangent[3], "rotation": tangent[5]},
        "law": {"name": joint.law.name, **law},
    }


def _anchor_a(joint: DuctileJoint, names: dict[pymunk.Body, str]) -> pymunk.Vec2d:
    """In coordinates of the first body; of the ground, the world's, where a support that settles has gone."""
    if names[joint.a] == "ground":
        return joint.at + joint.a.position
    return joint.a.world_to_local(joint.at)


def _place(place: Any) -> dict[str, Any]:
    return {} if place is None else asdict(place)


def _plain(value: Any) -> Any:
    """As JSON has it: lists for arrays, null for what is endless."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def curve_csv(displacement: np.ndarray, load: np.ndarray) -> str:
    """A load–displacement curve as CSV text."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["displacement_m", "load_N"])
    writer.writerows(zip(displacement.tolist(), load.tolist(), strict=True))
    return text.getvalue()
