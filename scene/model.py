"""What a scene consists of. These structs are the schema of a scene file, too."""

from __future__ import annotations

import math
from typing import Literal

import msgspec

from capacity import Capacity, InputError, Material, Section, capacity
from scene.quantities import Acceleration, Length

Support = Literal["free", "pinned", "clamped"]
Theory = Literal["euler-bernoulli", "timoshenko"]


class Node(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A point where members begin, end or meet.

    Attributes
    ----------
    at : (Length, Length)
        Position x, y [m].
    support : str
        ``"clamped"`` holds x, y and rotation, ``"pinned"`` x and y, ``"free"`` nothing.
    """

    at: tuple[Length, Length]
    support: Support = "free"


class Member(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A straight prismatic member from one node to another.

    Attributes
    ----------
    start, end : str
        Names of the nodes; written ``from`` and ``to``.
    section : Section
    material : Material
    theory : str
        ``"timoshenko"`` with shear flexibility, ``"euler-bernoulli"`` without.
    """

    start: str = msgspec.field(name="from")
    end: str = msgspec.field(name="to")
    section: Section
    material: Material
    theory: Theory = "timoshenko"


class Push(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A displacement-controlled push of one node.

    Attributes
    ----------
    node : str
    direction : (float, float)
        Direction of the push and of the force, any length but zero.
    distance : Length
        How far the node is pushed [m].
    """

    node: str
    direction: tuple[float, float]
    distance: Length


class Scene(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A structure and what happens to it.

    Attributes
    ----------
    title : str
    nodes : dict[str, Node]
    members : dict[str, Member]
    push : Push
    gravity : Acceleration
        Downward acceleration [m/s²].
    criterion : str
        Yield criterion in shear, ``"tresca"`` or ``"von-mises"``.
    """

    title: str
    nodes: dict[str, Node]
    members: dict[str, Member]
    push: Push
    gravity: Acceleration = Acceleration(9.81)
    criterion: Literal["tresca", "von-mises"] = "von-mises"

    def capacity(self, member: str) -> Capacity:
        """Capacities and stiffnesses of a member by name."""
        m = self.members[member]
        return capacity(m.section, m.material, self.criterion)

    def axis(self, member: str) -> tuple[float, float, float]:
        """Direction cosines and length (c, s, L) of a member by name [-, -, m]."""
        m = self.members[member]
        (x0, y0), (x1, y1) = self.nodes[m.start].at, self.nodes[m.end].at
        length = math.hypot(x1 - x0, y1 - y0)
        return (x1 - x0) / length, (y1 - y0) / length, length

    def push_direction(self) -> tuple[float, float]:
        """Unit vector of the push."""
        dx, dy = self.push.direction
        size = math.hypot(dx, dy)
        return dx / size, dy / size


def check(scene: Scene) -> Scene:
    """``scene`` itself, when it hangs together.

    Raises
    ------
    InputError
        When a name is unknown, a member has no length, nothing is supported, or the push goes nowhere.
    """
    known = ", ".join(scene.nodes)
    if not scene.members:
        raise InputError("members", "there is no member", "add a table such as [members.beam]")
    for name, member in scene.members.items():
        for key, node in (("from", member.start), ("to", member.end)):
            if node not in scene.nodes:
                raise InputError(f"members.{name}.{key}", f'there is no node "{node}"', f"the nodes are {known}")
        if scene.nodes[member.start].at == scene.nodes[member.end].at:
            raise InputError(f"members.{name}", "its two ends are at the same point", "move one of its nodes")
    if scene.push.node not in scene.nodes:
        raise InputError("push.node", f'there is no node "{scene.push.node}"', f"the nodes are {known}")
    if scene.push.direction == (0.0, 0.0) or not all(map(math.isfinite, scene.push.direction)):
        raise InputError("push.direction", "it has no direction", "write for example [0, -1]")
    if scene.push.distance <= 0.0:
        raise InputError("push.distance", "it must be greater than zero", 'write a length such as "75 mm"')
    if scene.nodes[scene.push.node].support != "free":
        raise InputError("push.node", f'node "{scene.push.node}" is supported', "push a free node")
    if all(node.support == "free" for node in scene.nodes.values()):
        raise InputError("nodes", "nothing is supported", 'give a node support = "clamped"')
    return scene
