"""Natural frequencies of bodies held by ductile joints, while nothing yields."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pymunk

from sim.joint import DuctileJoint


def natural_modes(joints: Sequence[DuctileJoint]) -> tuple[np.ndarray, dict[pymunk.Body, np.ndarray]]:
    """Frequencies [Hz], ascending, and each dynamic body's share x, y, angle in every mode, (3, n).

    About where the bodies are now, without what forces in the joints add to the stiffness. A step should be a
    twentieth of the period of the highest one that matters. Modes are scaled to a kinetic energy of ω²/2.
    """
    bodies = list(dict.fromkeys(body for joint in joints for body in (joint.a, joint.b)))
    moving = [body for body in bodies if body.body_type == pymunk.Body.DYNAMIC]
    first = {body: 3 * i for i, body in enumerate(moving)}
    stiffness = np.zeros((3 * len(moving), 3 * len(moving)))
    for joint in joints:
        k = np.zeros((3, 3))
        k[np.triu_indices(3)] = joint.law.elastic_tangent()
        gradient = np.zeros((3, 3 * len(moving)))
        for body, sign in ((joint.a, -1.0), (joint.b, 1.0)):
            if body in first:
                gradient[:, first[body] : first[body] + 3] = sign * joint.rates_on(body)
        stiffness += gradient.T @ (k + np.triu(k, 1).T) @ gradient
    mass = np.repeat([body.mass for body in moving], 3)
    mass[2::3] = [body.moment for body in moving]
    lightness = 1.0 / np.sqrt(mass)
    squares, scaled = np.linalg.eigh(lightness[:, None] * stiffness * lightness)
    shapes = lightness[:, None] * scaled
    frequencies = np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi)
    return frequencies, {body: shapes[at : at + 3] for body, at in first.items()}
