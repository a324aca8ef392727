"""The plane stress answer to a push: a curve, where the work went, and how wrong each may be."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from fem_reference.hinge_events import HingeEvent
from fem_reference.legs import even_legs, resolved_legs
from fem_reference.plane.bodies import plane_scene
from fem_reference.plane.continuum import Continuum, State
from fem_reference.plane.equilibrium import Body, Control
from fem_reference.plane.extrapolation import SAFETY, Convergence
from fem_reference.plane.halves import whole
from fem_reference.plane.path import Trace, trace
from fem_reference.pushover import Energy
from scene import Scene

#: Points at which the load is quoted, on the path or, of one that turns, on each leg.
POINTS, POINTS_A_LEG = 60, 30
#: Points at which the fields are kept.
SNAPSHOTS = 13
#: The error that is aimed at when nothing else is said.
TOLERANCE = 2e-3
#: A path is level when its last slope is below this share of its first.
_LEVEL = 1e-4
_DISPLACEMENT, _LOAD = attrgetter("displacement"), attrgetter("load")
_ENERGIES = tuple(map(attrgetter, ("external", "elastic", "plastic")))

#: Displacements [m] and loads [N], or load factors.
Curve = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Fields:
    """Whole states along a path.

    Attributes
    ----------
    continuum : Continuum
    displacement : tuple of float
        Of the pushed edge, at each [m].
    states : tuple of State
    """

    continuum: Continuum
    displacement: tuple[float, ...]
    states: tuple[State, ...]


@dataclass(frozen=True)
class AxisShape:
    """A member's axis at the end of a path.

    Attributes
    ----------
    point : (j,) float
        From the member's start [m].
    shape : (j, 2) float
        Displacements x, y there [m].
    error_estimate : float
        Largest difference of any of them from those on the next coarser mesh, times `SAFETY` [m].
    """

    point: np.ndarray
    shape: np.ndarray
    error_estimate: float


@dataclass(frozen=True)
class PlanePush:
    """A load–displacement curve of a plane stress body with its estimated error.

    Attributes
    ----------
    method : str
        What was solved, in words.
    displacement : (k,) float
        Displacement of the pushed edge along the push [m], from 0.
    load : (k,) float
        Force on it along the push [N]; with proportional loads in the scene, their load factor. Extrapolated from
        three meshes where that is the better estimate, and so are the energies.
    error_estimate : float
        Estimated largest error of the load, over the largest load [-]; see `extrapolation`. Never less than what is out
        of balance.
    elements : int
        Of the finest mesh, both halves of one of which one was solved.
    seconds : float
        Time that all meshes took.
    hinges : tuple of HingeEvent
        Of a cantilever without dead loads that is pushed across: where the moment at its root passes M_pl.
    outcome : str
        How the path ended.
    residual, residual_error : float
        Displacement at the end of an unloaded path, or the last displacement of another, and its estimated
        error [m].
    energy : Energy
    imbalance : float
        Largest sum of the out-of-balance forces, over the largest load [-].
    axes : dict[str, AxisShape]
        By member; none of a mesh.
    fields : Fields
        States on the finest mesh.
    """

    method: str
    displacement: np.ndarray
    load: np.ndarray
    error_estimate: float
    elements: int
    seconds: float
    hinges: tuple[HingeEvent, ...]
    outcome: str
    residual: float
    residual_error: float
    energy: Energy
    imbalance: float
    axes: dict[str, AxisShape]
    fields: Fields


def plane_push(
    scene: Scene, tolerance: float = TOLERANCE, watch: Callable[[float], None] = lambda share: None
) -> PlanePush:
    """Push ``scene`` on finer and finer meshes until the estimated error is at most ``tolerance``.

    Parameters
    ----------
    scene : Scene
    tolerance : float
        Largest error of the load, as a share of the largest load [-].
    watch : callable
        Told the finished share of the current mesh's path.

    Returns
    -------
    PlanePush
        From the finest mesh; its ``error_estimate`` says whether ``tolerance`` was met. A path that finds no
        equilibrium any more ends there, and ``outcome`` says so.

    Raises
    ------
    InputError
        When plane stress cannot follow the scene, or its mesh cannot be used.
    NotConverged
        When the dead loads find no equilibrium.
    """
    started = time.perf_counter()
    found = plane_scene(scene)
    led_by_load = scene.push.control == "load"
    stops = (scene.push.largest_load * found.unit_load,) if led_by_load else scene.push.stops()
    control: Control = "load" if led_by_load else "displacement"
    legs = even_legs(stops, POINTS if len(stops) == 1 else POINTS_A_LEG)

    def solve(level: int) -> tuple[Body, Trace]:
        body = found.body(level)
        path = trace(body, legs, control, scene.push.unload, SNAPSHOTS if level else 0, watch)
        return body, path

    _, first = solve(0)
    if not led_by_load:
        legs = resolved_legs(stops, legs, np.array(first.load))
    body, coarse = solve(0)
    paths = [coarse]
    for level in range(1, found.levels):
        coarse_body, coarse = body, paths[-1]
        body, fine = solve(level)
        paths.append(fine)
        converged = Convergence.of(paths[-2:] if led_by_load else paths)
        error = SAFETY * _apart(fine, coarse) if led_by_load else converged.error(_LOAD)
        error = max(error, fine.imbalance)
        if error <= tolerance:
            break
    displacement, load = converged.answer(_DISPLACEMENT), converged.answer(_LOAD) / found.unit_load
    external, elastic, plastic = (converged.answer(along) for along in _ENERGIES)
    scale = float(np.abs(external).max())
    continuum, states = body.continuum, tuple(state for _, state in fine.snapshots)
    if found.half:
        continuum, states = whole(continuum, states)
    mesh = continuum.mesh
    kind = "triangles" if mesh.cells.shape[1] == 6 else "quadrilaterals"
    limit = ", load and energy extrapolated" if converged.extrapolated else ""
    return PlanePush(
        method=f"plane stress continuum, J2 plasticity, quadratic {kind}, small displacements: "
        f"{found.described}{limit}",
        displacement=displacement,
        load=load,
        error_estimate=error,
        elements=len(mesh.cells),
        seconds=time.perf_counter() - started,
        hinges=_hinges(scene, (displacement, load), _curve(coarse, found.unit_load), found.unit_load, error),
        outcome=fine.stopped or _outcome(scene, displacement, load),
        residual=float(displacement[-1]),
        residual_error=SAFETY * abs(fine.displacement[-1] - coarse.displacement[-1]),
        energy=Energy(external, elastic, plastic, max(converged.error(along, scale) for along in _ENERGIES)),
        imbalance=fine.imbalance,
        axes=_axes(scene, body, coarse_body),
        fields=Fields(continuum, tuple(at for at, _ in fine.snapshots), states),
    )


def _apart(fine: Trace, coarse: Trace) -> float:
    """`_difference` of loads of paths led by load: at the same displacements, on the way there and of the largest."""
    load, displacement = np.array(fine.load), np.array(fine.displacement)
    top, coarse_top = int(np.argmax(load)) + 1, int(np.argmax(coarse.load)) + 1
    reached = displacement[:top] <= coarse.displacement[coarse_top - 1]
    other = np.interp(displacement[:top], coarse.displacement[:coarse_top], coarse.load[:coarse_top])
    limits = abs(load[top - 1] - coarse.load[coarse_top - 1])
    return float(max(np.abs(load[:top] - other)[reached].max(), limits) / load[top - 1])


def _axes(scene: Scene, fine: Body, coarse: Body) -> dict[str, AxisShape]:
    found = {}
    for name in scene.members:
        c, s, _ = scene.axis(name)
        (point, shape), (points, shapes) = (_axis(body) for body in (fine, coarse))
        error = max(float(np.abs(shape[:, i] - np.interp(point, points, shapes[:, i])).max()) for i in (0, 1))
        found[name] = AxisShape(point, shape @ np.array([[c, s], [-s, c]]), SAFETY * error)
    return found


def _axis(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Nodes on a member's axis, from its start, and their displacements along and across it [m]."""
    points = body.continuum.mesh.points
    axis = np.flatnonzero(np.abs(points[:, 1]) <= 1e-9 * points[:, 0].max())
    axis = axis[np.argsort(points[axis, 0])]
    return points[axis, 0], body.continuum.nodal_displacement(body.state.displacement)[axis]


def _hinges(scene: Scene, fine: Curve, coarse: Curve, unit: float, error: float) -> tuple[HingeEvent, ...]:
    if scene.meshed is not None or scene.gravity or scene.loads_of("dead") or len(scene.push.stops()) > 1:
        return ()
    ((name, member),) = scene.members.items()
    c, s, length = scene.axis(name)
    dx, dy = scene.push_direction()
    if abs(dx * c + dy * s) > 1e-9 or any(scene.nodes[scene.push.node].held):
        return ()
    force = member.material.yield_stress * member.section.plastic_modulus / length / unit
    places = [_first_at(force, path) for path in (fine, coarse)]
    if places[0] is None:
        return ()
    root, place = (member.start, 0.0) if scene.push.node == member.end else (member.end, length)
    spread = None if places[1] is None else SAFETY * abs(places[0] - places[1])
    return (HingeEvent(name, place, root, force, places[0], error, spread),)


def _curve(path: Trace, unit: float) -> Curve:
    return np.array(path.displacement), np.array(path.load) / unit


def _first_at(force: float, curve: Curve) -> float | None:
    """The displacement at which a curve first comes to ``force`` [m], if it does."""
    displacement, load = curve
    over = load >= force
    k = int(np.argmax(over))
    return float(np.interp(force, load[k - 1 : k + 1], displacement[k - 1 : k + 1])) if over.any() else None


def _outcome(scene: Scene, displacement: np.ndarray, load: np.ndarray) -> str:
    slopes = np.diff(load) / np.diff(displacement)
    if len(scene.push.stops()) == 1 and not scene.push.unload and abs(slopes[-1]) <= _LEVEL * slopes[0]:
        return f"mechanism: the load stays at {load[-1]:.6g} N"
    return "reached the end of its programme"
