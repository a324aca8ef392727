"""A scene's push in time: a node driven along its way, stop after stop."""

from __future__ import annotations

import itertools

from capacity import InputError
from scene import Scene
from sim.load_driver import LoadDriver
from sim.members import Assembly
from sim.settling import settle

#: Time from one stop to the next [s]: slow against the vibrations of ordinary members.
WAY_TIME = 4.0
_EASE = 0.4


class PrescribedPush:
    """Drives the pushed node of ``scene`` through ``assembly``, which is brought to rest first.

    Attributes
    ----------
    duration : float
        Until the last stop is reached [s].
    displacement, load : float
        How far the node has come [m], and the force along the push [N] or load factor [-].
    finished : bool
        Whether the last stop is reached, the load gone again after it, or a joint broken.

    Raises
    ------
    InputError
        When the push says a load only.
    SolverError
        When the scene does not come to rest under its own weight.
    """

    def __init__(self, scene: Scene, assembly: Assembly) -> None:
        push = scene.push
        if push.way() == 0.0:
            raise InputError("push.control", "a simulation drives the displacement", 'write distance = "75 mm"')
        settle(scene, assembly, 1e-9 * push.way())
        self._driver = LoadDriver(assembly, push.node, scene.push_direction(), push.way())
        self._assembly = assembly
        self._stops: tuple[float, ...] = (0.0, *push.stops(), *((0.0,) if push.unload else ()))
        self.duration = WAY_TIME * (len(self._stops) - 1)
        self._turned_at = self.duration - WAY_TIME if push.unload else self.duration
        self.displacement = self.load = 0.0
        self.finished = False

    def aim(self, time: float, dt: float) -> None:
        """Before a step that ends at ``time`` [s]."""
        self._driver.aim(self._wanted(time), dt)

    def read(self, time: float, dt: float) -> None:
        """After that step."""
        self._driver.read(dt)
        unloaded = time > self._turned_at and self._driver.factor * self.load <= 0.0
        self.displacement, self.load = self._driver.displacement, self._driver.factor
        # A joint that breaks leaves another structure than the one that is driven.
        self.finished = time >= self.duration or unloaded or not self._assembly.structure.active.all()

    def _wanted(self, time: float) -> float:
        """Where the node shall be at ``time`` [m]: evenly from stop to stop, but for a start without a jerk."""
        way = time**2 / (2.0 * _EASE) if time < _EASE else time - 0.5 * _EASE
        way *= self.duration / (self.duration - 0.5 * _EASE)
        for i, (a, b) in enumerate(itertools.pairwise(self._stops)):
            if way <= (i + 1) * WAY_TIME:
                return a + (b - a) * (way / WAY_TIME - i)
        return self._stops[-1]
