"""The shape that the finite-element reference comes to at the end of a push, to lay over a replay."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from rich.console import Console

from calibration.reference_command import answer
from calibration.replay_payload import ReferenceShape
from capacity import InputError
from fem_reference import NotConverged
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


def shape_for_replay(scene: Scene, messages: Console, watch: Callable[[float], None]) -> ReferenceShape | None:
    """The shape above, where the reference can follow a scene; why it cannot is said to ``messages``."""
    if scene.pushed is None or scene.bodies or scene.joints or scene.vehicles:
        return None
    try:
        return reference_shape(scene, watch)
    except (InputError, NotConverged) as error:
        messages.print(f"The replay is without the reference's shape: {error}", soft_wrap=True, markup=False)
        return None
