"""A scene's joints that are given directly, as ductile joints."""

from __future__ import annotations

import math
from collections.abc import Mapping

import pymunk

from capacity.behaviour import reduced, stiffness_and_damping
from scene import GROUND, Joint, Scene
from sim.joint import DuctileJoint
from sim.laws import ElasticPlastic
from sim.limits import Limits


def add_joints(
    scene: Scene, space: pymunk.Space, bodies: Mapping[str, pymunk.Body], scheme: tuple[float, float]
) -> dict[str, DuctileJoint]:
    """The joints of ``scene`` between its loose ``bodies``, by name; joined bodies do not collide."""
    joints = {}
    for name, joint in scene.joints.items():
        a, b = (space.static_body if body == GROUND else bodies[body] for body in joint.between)
        joints[name] = _ductile(joint, a, b, scheme)
        space.add(joints[name])
    return joints


def _ductile(joint: Joint, a: pymunk.Body, b: pymunk.Body, scheme: tuple[float, float]) -> DuctileJoint:
    n_max, q_max, m_max = _endless(joint.N_max), _endless(joint.Q_max), _endless(joint.M_max)
    damping = 0.0
    if joint.stiffness is not None:
        along, across, turning = map(float, joint.stiffness)
    else:
        along, across = n_max / joint.elastic_elongation, q_max / joint.elastic_slip
        turning = m_max / joint.elastic_rotation
    if joint.frequency is not None:
        inertia = reduced(_inertia(a), _inertia(b))
        turning, damping = stiffness_and_damping(joint.frequency, joint.damping_ratio, inertia)
        if joint.M_max is None:
            m_max = turning * joint.elastic_rotation
    return DuctileJoint(
        a,
        b,
        joint.at,
        ElasticPlastic((along, across, turning), (n_max, q_max, m_max)),
        direction=_direction(joint, a, b),
        damping=(0.0, 0.0, damping),
        limits=Limits(
            elongation=_endless(joint.break_elongation),
            slip=_endless(joint.break_slip),
            rotation=_endless(joint.break_rotation),
            compression_counts=joint.compression_counts,
        ),
        scheme=scheme,
    )


def _inertia(body: pymunk.Body) -> float:
    return body.moment if body.body_type == pymunk.Body.DYNAMIC else math.inf


def _endless(value: float | None) -> float:
    return math.inf if value is None else float(value)


def _direction(joint: Joint, a: pymunk.Body, b: pymunk.Body) -> float:
    """Angle of the joint's x axis: as given, or from a's centre of mass to b's; the ground is where the joint is."""
    if joint.direction is not None:
        return math.atan2(joint.direction[1], joint.direction[0])
    ends = [
        body.local_to_world(body.center_of_gravity)
        if body.body_type == pymunk.Body.DYNAMIC
        else pymunk.Vec2d(*joint.at)
        for body in (a, b)
    ]
    return (ends[1] - ends[0]).angle
