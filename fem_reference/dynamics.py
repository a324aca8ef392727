"""Motion of a frame in time: falls, impacts and sudden loads, followed by finer and finer models.

An impact is plastic: a body shares its momentum with the mass that is lumped at its node, which vanishes as elements
shrink, and stays on it. A support stops what it holds in an instant; a bearing pushes while it touches.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from capacity import InputError
from fem_reference.hinge_times import HingeTime, with_time_errors
from fem_reference.member_results import MemberResult
from fem_reference.time_history import STATES, TimeHistory, time_history
from scene import Scene
from scene.actions import unit_vector
from scene.watched import extreme

#: Estimated error that is aimed at when nothing else is said.
TOLERANCE = 0.01
#: Share of the largest displacement of any node that is rounding.
_NOTHING = 1e-9
#: Elements a member, fibres a section and steps of the first model.
_COARSEST = (20, 48, 500)
#: Elements or steps are doubled when what they make of the estimate is more than this share of the tolerance, …
_MATTERS = 1.0 / 3.0
#: … or the larger of both alone, as long as members × elements × steps stay below this.
_LARGEST = 320_000
#: What a difference at any time counts for beside one of the peak: it is nearly all a matter of being a little early
#: or late.
HISTORY_SHARE = 0.1

Judged = Literal["history", "peak"]


@dataclass(frozen=True)
class MotionResult:
    """A motion in time; k points.

    Every error estimate is the difference from a model with half the elements, plus that from one with steps twice
    as long: the two may be of opposite sign, and one model that is coarser in both would hide them.

    Attributes
    ----------
    method : str
    node : str
        Whose displacement is watched.
    time : (k,) float
        [s]
    displacement : (k,) float
        Of that node along the watched direction [m].
    displacements : dict[str, (k, 2) float]
        Displacements x, y of every node since the start [m].
    members : dict[str, MemberResult]
        Forces, strains and shapes at the times ``member_time``; the end forces are without the inertia of the last
        element.
    member_time : (j,) float
        [s]
    hinges : tuple of HingeTime
        In the order in which they form.
    utilisation : dict[str, float]
        Largest |N| / N_max + |M| / M_yield anywhere in each member at any time, 1 at first yield [-].
    energy_share : dict[str, float]
        Largest elastic energy of each member over the largest of all of them together [-].
    kinetic, elastic, plastic, external : (k,) float
        Energies of motion and stored, plastic work, and work of the loads since the start [J].
    peak, peak_time : float
        Largest displacement by size [m], and when [s].
    peak_error : float
        Of the peak [m].
    residual : dict[str, (float, float)]
        Displacements x, y of each node once it has come to rest under dead and step loads, from the end of the motion
        on [m]; at that end, where nothing holds the structure.
    residual_error : float
        Largest error of any of them [m], …
    rest_error : float
        … and that of the watched displacement [m].
    energy_error : float
        Largest error of any energy, and what the integration itself has dissipated, over the largest energy [-].
    error_estimate : float
        Largest error of the watched displacement at any time, over the peak [-].
    elements, fibres, steps : int
        Of the finest model.
    seconds : float
        Time that all models took.
    """

    method: str
    node: str
    time: np.ndarray
    displacement: np.ndarray
    displacements: dict[str, np.ndarray]
    members: dict[str, MemberResult]
    member_time: np.ndarray
    hinges: tuple[HingeTime, ...]
    utilisation: dict[str, float]
    energy_share: dict[str, float]
    kinetic: np.ndarray
    elastic: np.ndarray
    plastic: np.ndarray
    external: np.ndarray
    peak: float
    peak_time: float
    peak_error: float
    residual: dict[str, tuple[float, float]]
    residual_error: float
    rest_error: float
    energy_error: float
    error_estimate: float
    elements: int
    fibres: int
    steps: int
    seconds: float


def motion(
    scene: Scene,
    tolerance: float = TOLERANCE,
    dissipation: float = 0.8,
    watch: Callable[[float], None] = lambda share: None,
    of: Judged = "history",
) -> MotionResult:
    """Follow ``scene``'s motion with more elements and steps, whichever it takes, until the estimated error is small.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Largest error of the watched displacement, over its peak [-].
    dissipation : float
        ρ of `stepper`: 1 dissipates nothing; the default takes out what a step cannot resolve.
    watch : callable
        Told the finished share of the current model's time.
    of : str
        What ``tolerance`` is for: ``"history"``, the displacement at any time, or ``"peak"``, its largest value and
        that at rest, and ten times as much at any time.

    Returns
    -------
    MotionResult
        From the finest model; its errors say whether ``tolerance`` was met before the models became too large.

    Raises
    ------
    InputError
        When the scene has no motion, ``dissipation`` is not between 0 and 1, or the watched node does not move in the
        watched direction.
    NotConverged
        When the dead loads, or a time step, find no equilibrium.
    """
    if scene.motion is None:
        raise InputError("motion", "the scene has none", 'add [motion] with duration = "0.2 s"')
    if not 0.0 <= dissipation <= 1.0:
        raise InputError("dissipation", f"{dissipation:g} is not between 0 and 1", "0.8 is ordinary")
    started = time.perf_counter()
    asked, known = scene.motion, dict[tuple[int, int, int], TimeHistory]()

    def followed(elements: int, fibres: int, steps: int) -> TimeHistory:
        model = (elements, fibres, steps)
        if model not in known:
            known[model] = time_history(scene, asked, *model, dissipation, watch)
        return known[model]

    elements, fibres, steps = _COARSEST
    while True:
        fine = followed(elements, fibres, steps)
        others = (followed(elements // 2, fibres // 2, steps), followed(elements, fibres, steps // 2))
        node = asked.watch or max(fine.moved, key=lambda name: float(np.ptp(fine.moved[name], axis=0).max()))
        direction = np.array(unit_vector(asked.direction))
        path = fine.moved[node] @ direction
        peak, at = extreme(path)
        if abs(peak) <= _NOTHING * max(float(np.abs(moved).max()) for moved in fine.moved.values()):
            raise InputError("motion.direction", f'node "{node}" does not move that way', "watch another way or node")
        gaps = [_gaps(fine, other, node, direction) for other in others]
        by_elements, by_steps = (gap.size(of) / abs(peak) for gap in gaps)
        if by_elements + by_steps <= tolerance:
            break
        finer = (1 + (by_elements >= _MATTERS * tolerance), 1 + (by_steps >= _MATTERS * tolerance))
        size = len(scene.members) * elements * steps
        if size * finer[0] * finer[1] > _LARGEST:
            finer = (2, 1) if by_elements > by_steps else (1, 2)
        if size * finer[0] * finer[1] > _LARGEST:
            break
        elements, steps = finer[0] * elements, finer[1] * steps
    balance = fine.energies @ (1.0, 1.0, 1.0, -1.0)
    most = float(np.abs(fine.energies).max())
    energies = [_gap(fine.energies, other.energies) for other in others]
    kinetic, elastic, plastic, external = fine.energies.T
    return MotionResult(
        method=f"displacement-based fibre beam elements, generalised-α with ρ = {dissipation:g}, consistent mass",
        node=node,
        time=np.linspace(0.0, asked.duration, steps + 1),
        displacement=path,
        displacements=fine.moved,
        members=fine.members,
        member_time=np.linspace(0.0, asked.duration, STATES),
        hinges=with_time_errors(fine.hinges, [other.hinges for other in others]),
        utilisation=fine.utilisation,
        energy_share=fine.energy_share,
        kinetic=kinetic,
        elastic=elastic,
        plastic=plastic,
        external=external,
        peak=peak,
        peak_time=at * asked.duration / steps,
        peak_error=sum(gap.peak for gap in gaps),
        residual=fine.rest,
        residual_error=sum(gap.any_rest for gap in gaps),
        rest_error=sum(gap.rest for gap in gaps),
        energy_error=max(sum(energies), float(np.abs(balance - balance[0]).max())) / most,
        error_estimate=sum(gap.any_time for gap in gaps) / abs(peak),
        elements=elements,
        fibres=fibres,
        steps=steps,
        seconds=time.perf_counter() - started,
    )


@dataclass(frozen=True)
class _Gaps:
    """Differences of one model from another [m].

    Of the watched displacement at any time, its peak, and its value at rest; and of any displacement at rest.
    """

    any_time: float
    peak: float
    rest: float
    any_rest: float

    def size(self, of: Judged) -> float:
        return self.any_time if of == "history" else max(self.peak, self.rest, HISTORY_SHARE * self.any_time)


def _gaps(fine: TimeHistory, other: TimeHistory, node: str, direction: np.ndarray) -> _Gaps:
    path, coarse = fine.moved[node] @ direction, other.moved[node] @ direction
    return _Gaps(
        any_time=_gap(path, coarse),
        peak=abs(abs(extreme(coarse)[0]) - abs(extreme(path)[0])),
        rest=abs(float(np.subtract(other.rest[node], fine.rest[node]) @ direction)),
        any_rest=max(float(np.abs(np.subtract(other.rest[name], rest)).max()) for name, rest in fine.rest.items()),
    )


def _gap(fine: np.ndarray, other: np.ndarray) -> float:
    """Largest difference of two histories, one of which may have twice the steps."""
    stride = (len(fine) - 1) // (len(other) - 1)
    return float(np.abs(fine[::stride] - other).max())
