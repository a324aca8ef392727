"""Loads that follow a programme in time."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import msgspec
import numpy as np

from scene import Scene
from sim.body_loads import BodyLoad, body_loads
from sim.members import Assembly
from sim.pieces import Span

# A load that changes within less is one that acts at once [s].
_AT_ONCE = 0.1


def is_sudden(scene: Scene) -> bool:
    """Whether something sets ``scene``'s members going at once: a motion, or a load that comes or goes in no time."""
    histories = (load.history for load in scene.loads_of("history"))
    jumps = any(t1 - t0 < _AT_ONCE and f0 != f1 for own in histories for (t0, f0), (t1, f1) in itertools.pairwise(own))
    return scene.motion is not None or bool(scene.loads_of("step")) or jumps


class LoadProgramme:
    """All loads of ``scene`` on its ``assembly``, but for those that a push multiplies.

    Dead loads grow with gravity, sudden ones act from the start, and others follow their history.
    """

    def __init__(self, scene: Scene, assembly: Assembly) -> None:
        self._scene, self._assembly = scene, assembly
        self._spans: tuple[Span, ...] = ()
        self._histories: list[tuple[Sequence[float], Sequence[float], tuple[BodyLoad, ...]]] = []

    def act(self, time: float, dead_share: float) -> None:
        """Let the loads of ``time`` [s] act in the next step, with a share of the dead ones."""
        assembly = self._assembly
        for load in assembly.dead_loads:
            load.act(dead_share)
        for load in assembly.sudden_loads:
            load.act()
        if self._spans is not assembly.spans:
            self._spans, self._histories = assembly.spans, self._followed()
        for times, factors, loads in self._histories:
            factor = float(np.interp(time, times, factors))
            for load in loads:
                load.act(factor)

    def _followed(self) -> list[tuple[Sequence[float], Sequence[float], tuple[BodyLoad, ...]]]:
        """Times and factors of each history, and what it multiplies."""
        scene, assembly = self._scene, self._assembly
        followed: list[tuple[Sequence[float], Sequence[float], tuple[BodyLoad, ...]]] = []
        for load in scene.loads_of("history"):
            alone = msgspec.structs.replace(scene, loads=(load,))
            times, factors = zip(*load.history, strict=True)
            followed.append((times, factors, body_loads(alone, "history", assembly.spans, assembly.nodes)))
        return followed
