"""Whether a scene hangs together; what does not is named by its place."""

from __future__ import annotations

import itertools
import math

from capacity import InputError
from scene.actions import Load, Motion, Push
from scene.model import Scene
from scene.plane import check_plane
from scene.simulation_checks import check_simulation


def check(scene: Scene) -> Scene:
    """``scene`` itself, when it hangs together.

    Raises
    ------
    InputError
        When a name is unknown, a member has no length, nothing is supported, a load is nowhere or nothing, the push
        goes nowhere, a motion has no cause, or a body has no mass.
    """
    if scene.plane is not None:
        check_plane(scene.plane)
    if scene.meshed is not None:
        return _check_meshed(scene)
    _check_members(scene)
    for name, node in scene.nodes.items():
        _check_node(scene, name)
        if node.spring is not None and min(node.spring) < 0.0:
            raise InputError(f"nodes.{name}.spring", "a stiffness is negative", "write 0 where there is no spring")
        if node.bearing < 0.0:
            raise InputError(f"nodes.{name}.bearing", "it is negative", 'write a stiffness such as "1e8 N/m"')
    if scene.pushed is None and scene.motion is None and scene.simulation is None:
        raise InputError("push", "nothing happens in the scene", "add a table [push], [motion] or [simulation]")
    if scene.pushed is not None and scene.motion is not None:
        raise InputError("motion", "the scene has a push, too", "keep one of [push] and [motion]")
    for i, load in enumerate(scene.loads):
        _check_load(scene, load, f"loads[{i}]")
    if scene.pushed is not None:
        _check_push(scene, scene.pushed)
    if scene.motion is not None:
        _check_motion(scene, scene.motion)
    elif scene.pushed is not None and not is_supported(scene):
        raise InputError("nodes", "nothing is supported", 'give a node support = "clamped"')
    check_simulation(scene)
    return scene


def is_supported(scene: Scene) -> bool:
    """Whether any node is held, or tied to the ground by a spring."""
    return any(any(node.held) or node.spring is not None or node.bearing for node in scene.nodes.values())


def _check_meshed(scene: Scene) -> Scene:
    for key in ("nodes", "members", "loads", "motion", "simulation"):
        if getattr(scene, key):
            raise InputError(
                key, "a mesh stands in place of nodes, members and loads", f"take {key} out, or plane.mesh"
            )
    if scene.reference == "beam":
        raise InputError("reference", "beams do not follow a mesh", 'write "plane-stress", or take it out')
    if scene.kinematics != "small":
        raise InputError("kinematics", "a mesh is followed in small displacements only", 'write "small"')
    if scene.pushed is None:
        raise InputError("push", "nothing happens in the scene", 'add a table [push] with node = "right", say')
    _check_way(scene.pushed)
    return scene


def _check_members(scene: Scene) -> None:
    if not scene.members and (scene.pushed is not None or scene.motion is not None):
        raise InputError("members", "there is no member", "add a table such as [members.beam]")
    for name, member in scene.members.items():
        for key, node in (("from", member.start), ("to", member.end)):
            _check_known(scene, node, f"members.{name}.{key}")
        if scene.nodes[member.start].at == scene.nodes[member.end].at:
            raise InputError(f"members.{name}", "its two ends are at the same point", "move one of its nodes")
        if member.material.curve is not None and scene.yielding == "ideal-hinges":
            cure = 'give a yield stress such as "fy=235 MPa", or take yielding = "gradual"'
            raise InputError(f"members.{name}.material", "ideal hinges have no table of stresses", cure)


def _check_known(scene: Scene, node: str, place: str) -> None:
    if node not in scene.nodes:
        raise InputError(place, f'there is no node "{node}"', f"the nodes are {', '.join(scene.nodes)}")


def _check_node(scene: Scene, name: str) -> None:
    node, place = scene.nodes[name], f"nodes.{name}"
    if not any(name in (member.start, member.end) for member in scene.members.values()):
        raise InputError(place, "no member begins or ends there", "take it out, or name it in a member's from or to")
    for axis, moved, held in zip("xy", node.settlement, node.held[:2], strict=True):
        if moved and not held:
            raise InputError(f"{place}.settlement", f"the support does not hold {axis}", "write 0 there")
    if node.mass < 0.0:
        raise InputError(f"{place}.mass", "it is negative", 'write a mass such as "500 kg"')
    if any(node.velocity) and (node.mass == 0.0 or scene.motion is None):
        raise InputError(
            f"{place}.velocity",
            "no mass of this node moves",
            "it is the velocity of `mass`, and needs a table [motion]",
        )


def _check_load(scene: Scene, load: Load, place: str) -> None:
    if (load.node is None) == (load.member is None):
        raise InputError(place, "a load needs a node or a member, and not both", 'write node = "…" or member = "…"')
    if load.node is not None:
        _check_known(scene, load.node, f"{place}.node")
        if any(load.per_length):
            raise InputError(f"{place}.per_length", "a node has no length", "write force = [fx, fy], or name a member")
        if not any(load.force) and load.moment == 0.0:
            raise InputError(place, "the load is zero", 'write force = ["0 N", "-10 kN"], or a moment')
    if load.member is not None:
        if load.member not in scene.members:
            known = ", ".join(scene.members)
            raise InputError(f"{place}.member", f'there is no member "{load.member}"', f"the members are {known}")
        if any(load.force) or load.moment != 0.0:
            raise InputError(place, "force and moment act on nodes", "write per_length = [qx, qy], or name a node")
        if not any(load.per_length):
            raise InputError(place, "the load is zero", 'write per_length = ["0 N/m", "-5 kN/m"]')
    if scene.pushed is None and load.kind == "proportional":
        raise InputError(
            f"{place}.kind", "there is no load factor without a push", 'write kind = "step" or kind = "dead"'
        )
    if scene.pushed is not None and load.kind == "step":
        raise InputError(f"{place}.kind", "nothing is sudden in a push", 'write kind = "dead", or add a table [motion]')
    _check_history(scene, load, place)


def _check_history(scene: Scene, load: Load, place: str) -> None:
    if (load.kind == "history") != bool(load.history):
        cure = 'write kind = "history" and history = [["0 s", 0.0], ["1 s", 1.0]]'
        raise InputError(f"{place}.history", "kind and history do not go together", cure)
    if load.kind == "history" and (scene.pushed is not None or scene.motion is not None):
        raise InputError(f"{place}.kind", "only a simulation follows a history", "take [push] and [motion] out")
    times = [time for time, _ in load.history]
    if any(b <= a for a, b in itertools.pairwise(times)):
        raise InputError(f"{place}.history", "the times do not grow", "order its rows by time")
    if not all(math.isfinite(factor) for _, factor in load.history):
        raise InputError(f"{place}.history", "a factor is not finite", "write a number such as 1.0")


def _check_direction(direction: tuple[float, float], place: str) -> None:
    if not any(direction) or not all(map(math.isfinite, direction)):
        raise InputError(place, "it has no direction", "write for example [0, -1]")


def _check_push(scene: Scene, push: Push) -> None:
    _check_known(scene, push.node, "push.node")
    _check_way(push)
    held = scene.nodes[push.node].held
    if any(component != 0.0 and stops for component, stops in zip(push.direction, held, strict=False)):
        raise InputError("push.node", f'node "{push.node}" is supported', "push a node that is free to move that way")


def _check_way(push: Push) -> None:
    _check_direction(push.direction, "push.direction")
    if push.turning_points:
        if push.distance != 0.0:
            raise InputError("push.distance", "turning_points say it, too", "keep one of them")
        if push.control != "displacement":
            raise InputError("push.turning_points", f"{push.control} control knows none", "write distance instead")
        stops = (0.0, *push.turning_points)
        if any(a == b for a, b in itertools.pairwise(stops)):
            raise InputError("push.turning_points", "a turning point repeats the one before", "take it out")
    elif push.control == "load":
        if push.distance != 0.0 or push.largest_load <= 0.0:
            raise InputError("push.largest_load", "load control goes to a load", "write largest_load, and no distance")
    elif push.distance <= 0.0:
        raise InputError("push.distance", "it must be greater than zero", 'write a length such as "75 mm"')


def _check_motion(scene: Scene, motion: Motion) -> None:
    if motion.duration <= 0.0:
        raise InputError("motion.duration", "it must be greater than zero", 'write a time such as "0.2 s"')
    if motion.watch is not None:
        _check_known(scene, motion.watch, "motion.watch")
    _check_direction(motion.direction, "motion.direction")
    moves = any(any(node.velocity) for node in scene.nodes.values()) or any(motion.velocity)
    if not moves and not scene.loads_of("step"):
        raise InputError(
            "motion", "nothing sets the structure in motion", 'give a velocity, or a load of kind = "step"'
        )
