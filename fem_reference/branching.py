"""Where the path of a frame is no longer the only one.

A symmetric frame under symmetric loads may be followed on its symmetric path for as far as one likes, but from some
displacement on it sways out at the slightest disturbance: what then follows that path is a computation alone.
"""

from __future__ import annotations

from fem_reference.frame_mesh import build_frame, control_vector
from fem_reference.legs import even_legs
from fem_reference.paths import NotConverged, State
from scene import Scene

#: Elements a member, fibres a section, and points on the way.
_ELEMENTS, _FIBRES, _POINTS = 20, 24, 100


def branches_at(scene: Scene) -> float | None:
    """Displacement up to which a push has but one path, which is stable [m]; None where that is so to its end.

    0 where the frame does not even stand under its dead loads alone.

    Looked for where it may be: a frame of small displacements, whose materials do not soften, has one path. Of pushes
    that turn, or are driven by a load or an arc length, nothing is said.

    Raises
    ------
    NotConverged
        When the dead loads find no equilibrium.
    """
    push = scene.push
    if scene.kinematics == "small" or push.control != "displacement" or len(push.stops()) > 1:
        return None
    frame = build_frame(scene, _ELEMENTS, _FIBRES)
    state = State(frame, control_vector(scene, frame.node_dofs, frame.size))
    state.carry_dead_loads()
    if not state.standing:
        return 0.0
    start, before = state.position, 0.0
    try:
        for target in even_legs(push.stops(), _POINTS)[0].tolist():
            state.move_to(start + target)
            if not state.unique:
                return before
            before = target
    except NotConverged:  # the path ends before a second one begins
        return None
    return None
