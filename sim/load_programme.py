"""Loads that follow a programme in time."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from scene import Scene
from sim.body_loads import BodyLoad, body_loads
from sim.members import Assembly


class LoadProgramme:
    """All loads of ``scene`` on its ``assembly``, but for those that a push multiplies.

    Dead loads grow with gravity, sudden ones act from the start, and others follow their history.
    """

    def __init__(self, scene: Scene, assembly: Assembly) -> None:
        self._dead: Sequence[BodyLoad] = assembly.dead_loads
        self._sudden: Sequence[BodyLoad] = assembly.sudden_loads
        self._histories = []
        for load in scene.loads_of("history"):
            alone = msgspec.structs.replace(scene, loads=(load,))
            times, factors = zip(*load.history, strict=True)
            self._histories.append((times, factors, body_loads(alone, "history", assembly.spans, assembly.nodes)))

    def act(self, time: float, dead_share: float) -> None:
        """Let the loads of ``time`` [s] act in the next step, with a share of the dead ones."""
        for load in self._dead:
            load.act(dead_share)
        for load in self._sudden:
            load.act()
        for times, factors, loads in self._histories:
            factor = float(np.interp(time, times, factors))
            for load in loads:
                load.act(factor)
