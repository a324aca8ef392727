"""Whether what only a simulation needs hangs together: bodies, joints, vehicles, the programme, measures."""

from __future__ import annotations

import difflib
import itertools
import math
from collections.abc import Collection
from typing import get_args

from capacity import InputError
from scene.bodies import GROUND, Body, Box, Circle, Ground, Joint, Polygon, Shape
from scene.model import Scene
from scene.programme import JointQuantity, Measure, NodeQuantity, Simulation
from scene.vehicles import Vehicle

#: What a measure names for all joints of a scene.
ALL_JOINTS = "joints"
# [m/s]
_LIGHT = 299_792_458.0
_ROUNDING = 1e-9


def check_simulation(scene: Scene) -> None:
    """Check bodies, joints, vehicles, grounds, the programme and the measures of ``scene``.

    Raises
    ------
    InputError
        When a name is unknown or used twice, a size or mass is not greater than zero, or there is nothing to simulate.
    """
    _check_names(scene)
    if scene.simulation is not None:
        _check_programme(scene, scene.simulation)
    elif scene.bodies or scene.joints or scene.vehicles or scene.grounds:
        raise InputError("simulation", "bodies move in a simulation only", 'add [simulation] with duration = "5 s"')
    for name, body in scene.bodies.items():
        _check_body(body, f"bodies.{name}")
    for name, joint in scene.joints.items():
        _check_joint(scene, joint, f"joints.{name}")
    for name, vehicle in scene.vehicles.items():
        _check_vehicle(vehicle, f"vehicles.{name}")
    for i, ground in enumerate(scene.grounds):
        _check_ground(ground, f"grounds[{i}]")
    for name, member in scene.members.items():
        for key in ("break_elongation", "break_slip", "break_rotation"):
            _positive(getattr(member, key), f"members.{name}.{key}")
    for name, measure in scene.measures.items():
        _check_measure(scene, measure, f"measures.{name}")


def _check_names(scene: Scene) -> None:
    seen = {GROUND: "the fixed world", ALL_JOINTS: "all joints"}
    for kind in ("bodies", "vehicles", "joints", "members"):
        for name in getattr(scene, kind):
            if name in seen:
                raise InputError(f"{kind}.{name}", f'"{name}" already names {seen[name]}', "give it another name")
            seen[name] = f"one of the {kind}"


def _check_programme(scene: Scene, simulation: Simulation) -> None:
    _positive(simulation.dt, "simulation.dt", '"1/60 s"')
    _positive(simulation.hinge_length, "simulation.hinge_length", '"0.3 m"')
    counts = {f"members.{name}.joints": member.joints for name, member in scene.members.items()}
    for place, joints in {"simulation.joints": simulation.joints, **counts}.items():
        if simulation.rule in ("graded", "radau") and joints is not None and joints < 6:
            raise InputError(place, f"{joints} are too few for that rule", "write 6 or more")
    for key in ("gravity_ramp", "joint_damping"):
        if getattr(simulation, key) < 0.0:
            raise InputError(f"simulation.{key}", "it is negative", "take it out, or write a time")
    _positive(simulation.collision_slop, "simulation.collision_slop", '"1 mm"')
    _positive(simulation.largest_travel, "simulation.largest_travel", '"1 mm"')
    gives_its_own = scene.pushed is not None or scene.motion is not None
    if simulation.duration is None and not gives_its_own:
        raise InputError("simulation.duration", "it is missing", 'write a time such as "5 s"')
    if simulation.duration is not None and gives_its_own:
        raise InputError("simulation.duration", "[push] and [motion] have their own", "take it out")
    _positive(simulation.duration, "simulation.duration", '"5 s"')
    if not (scene.members or scene.bodies or scene.vehicles):
        raise InputError("simulation", "nothing moves in the scene", "add [members.NAME], [bodies.NAME] or a vehicle")


def _check_ground(ground: Ground, place: str) -> None:
    _check_restitution(ground.restitution, place)
    _positive(ground.thickness, f"{place}.thickness", '"1 m"')
    if len(ground.points) < 2:
        raise InputError(f"{place}.points", "a line has at least two points", "add one")
    for k, (a, b) in enumerate(itertools.pairwise(ground.points), 1):
        if a == b:
            raise InputError(f"{place}.points[{k}]", "it repeats the point before", "take it out")
    for k, (a, b, c) in enumerate(zip(ground.points, ground.points[1:], ground.points[2:], strict=False), 1):
        (ux, uy), (vx, vy) = (b[0] - a[0], b[1] - a[1]), (c[0] - b[0], c[1] - b[1])
        if ux * vy == uy * vx and ux * vx + uy * vy < 0.0:
            fault = "the line turns back on itself there"
            raise InputError(
                f"{place}.points[{k}]", fault, "give a wall two sides, or make it a body with fixed = true"
            )


def _check_body(body: Body, place: str) -> None:
    _check_shapes(body.shapes, f"{place}.shapes")
    for key in ("mass", "density", "depth", "moment_of_inertia"):
        _positive(getattr(body, key), f"{place}.{key}")
    _check_speed(body.velocity, f"{place}.velocity")
    _check_restitution(body.restitution, place)
    if body.fixed and (any(body.velocity) or body.spin):
        raise InputError(f"{place}.fixed", "a fixed body does not move", "take its velocity and spin out")


def _check_speed(velocity: tuple[float, float], place: str) -> None:
    if math.hypot(*velocity) > _LIGHT:
        raise InputError(place, "it is faster than light", 'write a speed such as "5 m/s"')


def _check_restitution(restitution: float, place: str) -> None:
    if restitution > 1.0:
        raise InputError(f"{place}.restitution", "it is greater than 1: impacts would give energy", "write 0 to 1")


def _check_shapes(shapes: tuple[Shape, ...], place: str) -> None:
    if not shapes:
        raise InputError(place, "there is no shape", 'write [{kind = "circle", radius = "1 m"}]')
    for i, shape in enumerate(shapes):
        if isinstance(shape, Circle):
            _positive(shape.radius, f"{place}[{i}].radius")
        elif isinstance(shape, Box):
            for k in (0, 1):
                _positive(shape.size[k], f"{place}[{i}].size[{k}]")
        else:
            _check_polygon(shape, f"{place}[{i}].points")


def _check_polygon(polygon: Polygon, place: str) -> None:
    corners = polygon.points
    if len(corners) < 3:
        raise InputError(place, "a polygon has at least three corners", "add one")
    following = [*corners[1:], *corners[:1]]
    edges = [(bx - ax, by - ay) for (ax, ay), (bx, by) in zip(corners, following, strict=True)]
    turns = [ax * by - ay * bx for (ax, ay), (bx, by) in itertools.pairwise([*edges, edges[0]])]
    full = sum(
        math.atan2(t, a[0] * b[0] + a[1] * b[1])
        for t, (a, b) in zip(turns, itertools.pairwise([*edges, edges[0]]), strict=True)
    )
    if min(turns) < 0.0 < max(turns) or not any(turns) or abs(abs(full) - 2.0 * math.pi) > 1e-6:
        raise InputError(place, "the polygon is not convex", "make it of several convex ones")


def _check_joint(scene: Scene, joint: Joint, place: str) -> None:
    for body in joint.between:
        known = [*scene.bodies, GROUND]
        if body not in known:
            raise InputError(f"{place}.between", f'there is no body "{body}"', _known(body, known, "bodies"))
    free = [body for body in joint.between if body != GROUND and not scene.bodies[body].fixed]
    if not free or joint.between[0] == joint.between[1]:
        raise InputError(f"{place}.between", "nothing moves there", "name two bodies, at least one of them not fixed")
    if joint.direction is not None and (not any(joint.direction) or not all(map(math.isfinite, joint.direction))):
        raise InputError(f"{place}.direction", "it has no direction", "write for example [0, 1]")
    keys = ["N_max", "Q_max", "M_max", "elastic_elongation", "elastic_slip", "elastic_rotation", "frequency"]
    for key in (*keys, "break_elongation", "break_slip", "break_rotation"):
        _positive(getattr(joint, key), f"{place}.{key}")
    if joint.stiffness is not None and min(joint.stiffness) < 0.0:
        raise InputError(f"{place}.stiffness", "a stiffness is negative", "write 0 where there is no spring")
    if joint.stiffness is None:
        for key in ("N_max", "Q_max"):
            if getattr(joint, key) is None:
                raise InputError(f"{place}.{key}", "it is missing", f'write {key} = "100 kN", or stiffness = [...]')
        if joint.M_max is None and joint.frequency is None:
            raise InputError(f"{place}.M_max", "it is missing", 'write M_max = "10 kN m", or a frequency')
    elif joint.frequency is not None:
        raise InputError(f"{place}.frequency", "stiffness says it, too", "keep one of them")
    if joint.damping_ratio > 0.0 and joint.frequency is None:
        raise InputError(f"{place}.damping_ratio", "it goes with a frequency", 'add frequency = "1 Hz"')


def _check_vehicle(vehicle: Vehicle, place: str) -> None:
    _check_shapes(vehicle.chassis, f"{place}.chassis")
    for key in ("mass", "density", "depth"):
        _positive(getattr(vehicle, key), f"{place}.{key}")
    _check_speed(vehicle.velocity, f"{place}.velocity")
    _check_restitution(vehicle.restitution, place)
    if not vehicle.wheels:
        raise InputError(f"{place}.wheels", "it has no wheel", "add [[" + place + ".wheels]]")
    for i, wheel in enumerate(vehicle.wheels):
        for key in ("radius", "mass", "suspension_frequency"):
            _positive(getattr(wheel, key), f"{place}.wheels[{i}].{key}")
    if vehicle.drive and not any(wheel.driven for wheel in vehicle.wheels):
        raise InputError(f"{place}.drive", "no wheel is driven", "write driven = true in one of them")
    if any(b.time <= a.time for a, b in itertools.pairwise(vehicle.drive)):
        raise InputError(f"{place}.drive", "the times do not grow", "order them by time")
    for i, drive in enumerate(vehicle.drive):
        if drive.torque < 0.0:
            raise InputError(f"{place}.drive[{i}].torque", "it is negative", "the speed's sign says which way")
    if vehicle.lap is not None and vehicle.lap.back_to >= vehicle.lap.beyond:
        raise InputError(f"{place}.lap.back_to", "it is not before `beyond`", "write a smaller x")


def _check_measure(scene: Scene, measure: Measure, place: str) -> None:
    of_joints, of_nodes = measure.quantity in get_args(JointQuantity), measure.quantity in get_args(NodeQuantity)
    known: list[str] = []
    if of_joints:
        known = [*scene.joints, *scene.members, ALL_JOINTS]
    else:
        known = [*scene.bodies, *scene.vehicles] + (list(scene.nodes) if of_nodes else [])
    if measure.of not in known:
        what = f'nothing with a {measure.quantity} is called "{measure.of}"'
        raise InputError(f"{place}.of", what, _known(measure.of, known, "names"))
    _check_times(scene, measure, place)
    if measure.take == "laps" and not any(vehicle.lap is not None for vehicle in scene.vehicles.values()):
        raise InputError(f"{place}.take", "no vehicle drives laps", "add [vehicles.NAME.lap]")


def _check_times(scene: Scene, measure: Measure, place: str) -> None:
    ends = [program.duration for program in (scene.simulation, scene.motion) if program is not None]
    end = next((float(duration) for duration in ends if duration is not None), math.inf)
    for key in ("at", "since", "until"):
        time = getattr(measure, key)
        if time is not None and (time < 0.0 or (key != "until" and time > end * (1.0 + _ROUNDING))):
            raise InputError(f"{place}.{key}", f"{time:g} s is not within the run", f"write a time from 0 to {end:g} s")
    if measure.since is not None and measure.until is not None and measure.until < measure.since:
        raise InputError(f"{place}.until", "it is before `since`", "write a later time")


def _known(name: str, names: Collection[str], what: str) -> str:
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"did you mean {near[0]}? " if near else ""
    return f"{hint}The {what} are {', '.join(names)}"


def _positive(value: float | None, place: str, example: str | None = None) -> None:
    if value is not None and not value > 0.0:
        cure = f"write one such as {example}" if example else "write a greater value, or take it out"
        raise InputError(place, "it must be greater than zero", cure)
