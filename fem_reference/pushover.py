"""The reference answer to a pushover: a curve, what happens along it, and how wrong each may be."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from capacity import InputError
from fem_reference.frame import Frame
from fem_reference.frame_mesh import build_frame, control_vector
from fem_reference.hinge_events import HingeEvent, hinge_events
from fem_reference.judging import difference, energy_error, outcome, with_errors
from fem_reference.legs import even_legs, resolved_legs, with_events
from fem_reference.member_results import MemberErrors, MemberResult, member_results
from fem_reference.paths import NotConverged, State, Trace
from fem_reference.programme import trace
from scene import Scene

#: Points at which the load is quoted, on the path or, of one that turns, on each leg.
POINTS = 200
POINTS_A_LEG = 100
_COARSEST = (10, 24)
_MOST_REFINEMENTS = 5
#: A node that moves by less than this share of what moves most is not moved.
_UNMOVED = 1e-9
_KINEMATICS = {"small": "small displacements", "p-delta": "P–Δ", "large": "corotational large displacements"}
_YIELDING = {"gradual": "fibre beam elements", "ideal-hinges": "beam elements with ideal hinges"}


@dataclass(frozen=True)
class Energy:
    """Where the work of the loads went, along the path.

    Attributes
    ----------
    external : (k,) float
        Work of all loads and settlements [J].
    elastic : (k,) float
        What unloading would give back [J].
    plastic : (k,) float
        Plastic work [J].
    error_estimate : float
        Largest difference of any of them from the next coarser model, over the largest external work [-].
    """

    external: np.ndarray
    elastic: np.ndarray
    plastic: np.ndarray
    error_estimate: float


@dataclass(frozen=True)
class Pushover:
    """A load–displacement curve with its estimated error.

    Attributes
    ----------
    method : str
        What was solved, in words.
    displacement : (k,) float
        Displacement of the pushed node along the push [m], from 0.
    load : (k,) float
        Force on it along the push [N]; with proportional loads in the scene, their load factor.
    error_estimate : float
        Largest difference from the curve of the next coarser model, over the largest load [-]. The errors of both
        models fall at least linearly with refinement, so the finer one is nearer to the truth than that. Never less
        than by how far the whole frame is out of balance.
    elements : int
        Elements a member.
    fibres : int
        Fibres a section.
    seconds : float
        Time that all refinements took.
    hinges : tuple of HingeEvent
        In the order in which they form.
    outcome : str
        How the path ended: what was reached, or at which limit point or mechanism.
    members : dict[str, MemberResult]
        Forces along the path, and the state at its end.
    member_errors : dict[str, MemberErrors]
        Error estimate of each of these numbers.
    residual : float
        Displacement at the end of an unloaded path, or the last displacement of another [m].
    residual_error : float
        Its difference from that of the next coarser model [m].
    energy : Energy
    imbalance : float
        Largest resultant of the out-of-balance forces, over the largest sum of loads [-].
    """

    method: str
    displacement: np.ndarray
    load: np.ndarray
    error_estimate: float
    elements: int
    fibres: int
    seconds: float
    hinges: tuple[HingeEvent, ...]
    outcome: str
    members: dict[str, MemberResult]
    member_errors: dict[str, MemberErrors]
    residual: float
    residual_error: float
    energy: Energy
    imbalance: float


def pushover(scene: Scene, tolerance: float = 5e-4, watch: Callable[[float], None] = lambda share: None) -> Pushover:
    """Push ``scene`` with finer and finer models until the estimated error is at most ``tolerance``.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Largest error of the load, as a share of the largest load [-].
    watch : callable
        Told the finished share of the current model's path.

    Returns
    -------
    Pushover
        From the finest model; its ``error_estimate`` says whether ``tolerance`` was met within five refinements. A path
        that finds no equilibrium any more ends there, and ``outcome`` says so.

    Raises
    ------
    InputError
        When the scene has no push, or its loads do not move the pushed node.
    NotConverged
        When the dead loads find no equilibrium, or the push none from its start on.
    """
    started = time.perf_counter()
    elements, fibres = _COARSEST
    stops = scene.push.stops() if scene.push.control != "load" else (scene.push.largest_load,)
    legs = even_legs(stops, POINTS if len(stops) == 1 else POINTS_A_LEG)
    first = _solve(scene, elements, fibres, legs, watch)
    if len(first.trace.load) == 1:
        if not _moved(scene, first.frame):
            raise InputError(
                "push.direction",
                f'the loads do not move node "{scene.push.node}" that way',
                "push it in the direction in which they do",
            )
        raise NotConverged(
            f"{first.trace.stopped}: the structure may move without any load; support it, or take a release out"
        )
    if scene.push.control == "displacement":
        legs = resolved_legs(stops, legs, np.array(first.trace.load))
    if scene.yielding == "ideal-hinges" and len(legs) == 1 and scene.push.control == "displacement":
        legs = [with_events(legs[0], [hinge.displacement for hinge in first.hinges])]
    coarse = _solve(scene, elements, fibres, legs, watch)
    for _ in range(_MOST_REFINEMENTS):
        elements, fibres = 2 * elements, 2 * fibres
        fine = _solve(scene, elements, fibres, legs, watch)
        error = max(difference(scene, fine.trace, coarse.trace), fine.trace.imbalance)
        if error <= tolerance:
            break
        coarse, last = fine, coarse
    else:
        coarse = last
    theories = " and ".join(sorted({m.theory.replace("-", "–").title() for m in scene.members.values()}))
    path = fine.trace
    members, rough = (member_results(scene, solved.frame, solved.trace) for solved in (fine, coarse))
    external, elastic, plastic = (np.array(values) for values in (path.external, path.elastic, path.plastic))
    return Pushover(
        method=f"displacement-based {_YIELDING[scene.yielding]} ({theories}, cubic Hermite), "
        f"{_KINEMATICS[scene.kinematics]}",
        displacement=np.array(path.displacement),
        load=np.array(path.load),
        error_estimate=error,
        elements=elements,
        fibres=fibres,
        seconds=time.perf_counter() - started,
        hinges=with_errors(fine.hinges, coarse.hinges, float(np.abs(path.load).max())),
        outcome=path.stopped or outcome(scene, path),
        members=members,
        member_errors={name: member.differences(rough[name]) for name, member in members.items()},
        residual=path.displacement[-1],
        residual_error=abs(path.displacement[-1] - coarse.trace.displacement[-1]),
        energy=Energy(external, elastic, plastic, energy_error(path, coarse.trace)),
        imbalance=path.imbalance,
    )


def _moved(scene: Scene, frame: Frame) -> bool:
    """Whether the loads move the pushed node along the push; of a mechanism nothing can be said."""
    state = State(frame, control_vector(scene, frame.node_dofs, frame.size))
    try:
        return abs(state.reach) > _UNMOVED
    except np.linalg.LinAlgError:
        return True


@dataclass(frozen=True)
class _Solved:
    """One model's answer."""

    frame: Frame
    trace: Trace
    hinges: tuple[HingeEvent, ...]


def _solve(scene: Scene, elements: int, fibres: int, legs: list[np.ndarray], watch: Callable[[float], None]) -> _Solved:
    frame = build_frame(scene, elements, fibres)
    control = control_vector(scene, frame.node_dofs, frame.size)
    path = trace(frame, control, scene.push, legs, watch)
    return _Solved(frame, path, hinge_events(frame, scene, path))
