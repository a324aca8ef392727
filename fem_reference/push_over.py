"""One entry for every push: beams or a plane stress continuum, as the scene asks or as its shape demands."""

from __future__ import annotations

from collections.abc import Callable

from fem_reference.dynamics import TOLERANCE as MOTION_TOLERANCE
from fem_reference.plane import PlanePush, plane_push
from fem_reference.plane.push import TOLERANCE as PLANE_TOLERANCE
from fem_reference.pushover import Pushover, pushover
from fem_reference.validity import wants_plane_stress
from scene import Scene

#: Either answer; what both have is the same.
PushAnswer = Pushover | PlanePush

#: Estimated error that is aimed at for beams and frames when nothing else is said.
BEAM_TOLERANCE = 5e-4


def push_over(
    scene: Scene, tolerance: float | None = None, watch: Callable[[float], None] = lambda share: None
) -> PushAnswer:
    """Follow the push of ``scene`` by beams or as a plane stress continuum; ``method`` of the answer says by which.

    Parameters
    ----------
    scene : Scene
        Its ``reference`` chooses; ``"auto"`` takes plane stress for a mesh, and for what `wants_plane_stress` names.
    tolerance : float, optional
        Largest error of the load, as a share of the largest load [-]; `default_tolerance` when left out.
    watch : callable
        Told the finished share of the current model's path.

    Raises
    ------
    InputError
        When the scene has no push, or asks for plane stress that cannot follow it.
    NotConverged
        When the dead loads find no equilibrium.
    """
    wanted = default_tolerance(scene) if tolerance is None else tolerance
    return plane_push(scene, wanted, watch) if wants_plane_stress(scene) else pushover(scene, wanted, watch)


def default_tolerance(scene: Scene) -> float:
    """Largest estimated error that is aimed at in ``scene`` when nothing else is said [-]."""
    if scene.motion is not None:
        return MOTION_TOLERANCE
    return PLANE_TOLERANCE if wants_plane_stress(scene) else BEAM_TOLERANCE
