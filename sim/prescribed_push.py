"""A scene's push in time: a node driven along its way, stop after stop.

It is sped up and slowed down on every one, for what turns or stops at once is jerked; and it waits until it is there.
"""

from __future__ import annotations

from capacity import InputError
from scene import Scene
from sim.load_driver import EASE, LONGEST_WAIT, LoadDriver
from sim.members import Assembly
from sim.settling import settle

#: Time from one stop to the next [s], but for what it then waits: slow against the vibrations of ordinary members.
WAY_TIME = 4.0
# How many times the node's own mean speed the fastest body may have before the push is slowed down, as for a strut that
# gives way at once.
_FAST = 4.0


class PrescribedPush:
    """Drives the pushed node of ``scene`` through ``assembly``, which is brought to rest first.

    Attributes
    ----------
    duration : float
        Until the last stop is reached, but for what it waits at each [s].
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
        self._unloads = push.unload
        self._passed, self._share, self._pace = 0, 0.0, 1.0
        self.duration = WAY_TIME * (len(self._stops) - 1)
        self.displacement = self.load = 0.0
        self.finished = False

    def aim(self, dt: float) -> None:
        """Before a step of ``dt`` [s]."""
        start, stop = self._stops[self._passed : self._passed + 2]
        self._share += self._pace * dt / WAY_TIME
        self._driver.aim(start + (stop - start) * _eased(self._share), dt)

    def read(self, dt: float) -> None:
        """After that step."""
        driver, structure, last = self._driver, self._assembly.structure, self._passed == len(self._stops) - 2
        driver.read(dt)
        unloaded = self._unloads and last and driver.factor * self.load <= 0.0
        self.displacement, self.load = driver.displacement, driver.factor
        start, stop = self._stops[self._passed : self._passed + 2]
        most = _FAST * abs(stop - start) / WAY_TIME
        fastest = max(body.velocity.length for body in structure.bodies)
        self._pace = min(1.0, self._pace * most / fastest) if fastest > 0.0 else 1.0
        there = self._share > 1.0 - 1e-9 and (driver.is_at(stop) or self._share > 1.0 + LONGEST_WAIT)
        # A joint that breaks leaves another structure than the one that is driven.
        self.finished = (there and last) or unloaded or not structure.active.all()
        if there:
            self._passed, self._share = self._passed + 1, 0.0


def _eased(share: float) -> float:
    """How much of a way is done after a share of its time."""
    if share >= 1.0:
        return 1.0
    ends = 2.0 * EASE * (1.0 - EASE)
    if share < EASE:
        return share**2 / ends
    return (share - 0.5 * EASE) / (1.0 - EASE) if share < 1.0 - EASE else 1.0 - (1.0 - share) ** 2 / ends
