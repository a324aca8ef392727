"""Motions of a model that leave out what its reference leaves out.

As in `comparable_push`: where displacements are small, a structure ε times as strong, under ε times its loads and set
going with ε times its velocities, moves ε times as far in the same time, and what geometry adds falls with ε. Under P–Δ
and with large displacements the model moves as it is. Beams of the reference do not yield in shear, so the joints that
move beside them do not either.
"""

from __future__ import annotations

from dataclasses import replace

from calibration.comparable_push import SHARE, shrunk
from scene import Scene
from sim import Course, Model, follow


def follow_model(scene: Scene, model: Model) -> Course:
    """Follow ``scene`` with ``model`` as the reference of that scene follows it."""
    model = replace(model, shear_yields=False)
    if scene.kinematics != "small":
        return follow(scene, model)
    course = follow(shrunk(scene, SHARE), model)
    return replace(
        course,
        displacement=course.displacement / SHARE,
        peak=course.peak / SHARE,
        residual={name: (x / SHARE, y / SHARE) for name, (x, y) in course.residual.items()},
        force=course.force / SHARE,
        dissipated=course.dissipated / SHARE**2,
    )
