"""The shape that the finite-element reference comes to at the end of a push, to lay over a replay."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from calibration.reference_command import answer
from calibration.replay_payload import ReferenceShape
from scene import Scene

# Of the load [-]; a shape to look at needs no more, and is soon there.
_TOLERANCE = 0.01


def reference_shape(scene: Scene, watch: Callable[[float], None] = lambda share: None) -> ReferenceShape:
    """Where the reference has the members of ``scene`` at the end of its push, found again if it was kept on disk.

    Parameters
    ----------
    scene : Scene
        With a push.
    watch : callable
        Told the finished share.

    Raises
    ------
    InputError
        When the scene has no push, or the reference does not follow it.
    NotConverged
        When the reference finds no equilibrium.
    """
    found = answer(scene, _TOLERANCE, use_cache=True, watch=watch)
    lines = []
    for name, member in found["members"].items():
        x, y = scene.nodes[scene.members[name].start].at
        c, s, _ = scene.axis(name)
        along = np.array(member["point"])[:, None]
        lines.append(np.array([x, y]) + along * np.array([c, s]) + np.array(member["shape"]))
    return ReferenceShape(tuple(lines), label="finite-element reference, end of the push")
