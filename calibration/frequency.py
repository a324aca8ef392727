"""Natural frequencies of a structure of rigid bodies and joints, from its masses and elastic stiffnesses.

With u the displacements of the bodies (x, y, rotation each), joints deform by B u and K = Bᵀ D B; K φ = ω² M φ.
"""

from __future__ import annotations

import math

import numpy as np
import pymunk
from scipy.linalg import eigh

from scene import Scene
from sim import DuctileJoint, Model, assemble

#: Below this share of the largest, a stiffness counts as none: the structure is free to move that way.
_FREE = 1e-12


def first_frequency(scene: Scene, model: Model) -> float:
    """Lowest natural frequency of ``model`` at rest [Hz]; 0 where it can move freely."""
    assembly = assemble(scene, model, shapes=False)
    bodies = [body for body in assembly.structure.bodies if body.body_type == pymunk.Body.DYNAMIC]
    index = {body: 3 * i for i, body in enumerate(bodies)}
    mass = np.concatenate([(body.mass, body.mass, body.moment) for body in bodies])
    stiffness = np.zeros((len(mass), len(mass)))
    for joint in assembly.joints:
        deformation = np.zeros((3, len(mass)))
        for body, sign in ((joint.a, -1.0), (joint.b, 1.0)):
            if body in index:
                deformation[:, index[body] : index[body] + 3] = sign * _rates(joint, body)
        a, b, c, d, e, f = joint.law.elastic_tangent()
        stiffness += deformation.T @ np.array([[a, b, c], [b, d, e], [c, e, f]]) @ deformation
    root = np.sqrt(mass)
    values = eigh(stiffness / np.outer(root, root), eigvals_only=True)
    lowest = float(values[0])
    return math.sqrt(lowest) / (2.0 * math.pi) if lowest > _FREE * float(values[-1]) else 0.0


def _rates(joint: DuctileJoint, body: pymunk.Body) -> np.ndarray:
    """Velocity of the joint's point on ``body`` along and across the joint's axis, and its spin, (3, 3)."""
    c, s = math.cos(joint.direction), math.sin(joint.direction)
    arm = pymunk.Vec2d(*joint.at) - body.local_to_world(body.center_of_gravity)
    return np.array([[c, s, -c * arm.y + s * arm.x], [-s, c, s * arm.y + c * arm.x], [0.0, 0.0, 1.0]])
