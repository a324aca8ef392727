"""Scenes as plane bodies: one straight member of rectangular section pushed at its end, or a mesh."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from capacity import InputError
from fem_reference.plane.beam_mesh import beam_mesh
from fem_reference.plane.boundary import boundary, edge_weights
from fem_reference.plane.continuum import Continuum
from fem_reference.plane.equilibrium import Body
from fem_reference.plane.j2 import J2
from fem_reference.plane.mesh_file import body_from_mesh
from scene import Plane, Scene

#: Meshes of a member that are worth their time, more of half of it; elements of a refined mesh from a file that are.
_MEMBER_LEVELS, _HALF_LEVELS, _MOST_ELEMENTS = 3, 4, 8000


@dataclass(frozen=True)
class PlaneScene:
    """A scene's body at every level of refinement.

    Attributes
    ----------
    body : callable
        The body at a level, 0 the coarsest.
    levels : int
        How many there are.
    half : bool
        Whether the body is only the upper half of an antisymmetric one, as `halves` has it.
    unit_load : float
        Load that a load factor of 1 stands for [N].
    described : str
        What was meshed and how it is held, in words.
    """

    body: Callable[[int], Body]
    levels: int
    half: bool
    unit_load: float
    described: str


def plane_fault(scene: Scene) -> str | None:
    """Why plane stress cannot follow ``scene``; None when it can."""
    if scene.pushed is None or (len(scene.members) != 1 and scene.meshed is None):
        return "plane stress follows the push of one straight member, or of a mesh"
    if scene.push.control == "arc-length":
        return "plane stress follows pushes led by displacement or load"
    if scene.meshed is not None:
        return None
    (member,) = scene.members.values()
    section = member.section
    square = section.area * section.depth
    if section.has_own_materials:
        return "plane stress follows members of one material, or a mesh"
    if (
        abs(12.0 * section.second_moment_of_area / (square * section.depth) - 1.0) > 1e-9
        or abs(4.0 * section.plastic_modulus / square - 1.0) > 1e-9
    ):
        return "plane stress follows members of rectangular section, or a mesh"
    if scene.kinematics != "small" or scene.yielding != "gradual":
        return "plane stress follows small displacements and gradual yielding"
    if member.releases or member.material.curve is not None:
        return "plane stress follows members without releases, of bilinear material"
    far = member.end if scene.push.node == member.start else member.start
    near = scene.nodes[scene.push.node]
    if scene.nodes[far].support != "clamped" or any(
        node.spring or node.bearing or node.mass or any(node.settlement) for node in scene.nodes.values()
    ):
        return "plane stress follows members that are clamped at the other end, without springs, masses or settlements"
    c, s, _ = scene.axis(next(iter(scene.members)))
    dx, dy = scene.push_direction()
    along = abs(dx * c + dy * s)
    guided = near.held[2] and along < 1e-9 and abs(c * s) < 1e-9
    if any(near.held) and not guided:
        return "plane stress follows pushed ends that are free, or guided along the push"
    root = "clamped" if scene.plane is None else scene.plane.root
    if root == "contraction-free" and along > 1e-9:
        return "a contraction-free root takes pushes across the member"
    for load in scene.loads:
        fx, fy = load.force
        along_push = abs(fx * dy - fy * dx) <= 1e-9 * np.hypot(fx, fy) and fx * dx + fy * dy > 0.0
        if load.kind == "proportional" and (load.node != scene.push.node or load.moment or not along_push):
            return "plane stress follows proportional loads along the push and at its node"
        if load.kind == "dead" and (load.moment or (load.node is not None and load.node != scene.push.node)):
            return "plane stress follows dead loads along the member and forces at the pushed end"
    return None


def plane_scene(scene: Scene) -> PlaneScene:
    """The bodies of ``scene``.

    Raises
    ------
    InputError
        When plane stress cannot follow it, or its mesh cannot be used.
    """
    fault = plane_fault(scene)
    if fault is not None:
        raise InputError("reference", fault, 'write "beam"')
    return _meshed(scene, scene.meshed) if scene.meshed is not None else _member(scene)


def _meshed(scene: Scene, plane: Plane) -> PlaneScene:
    mesh, materials = body_from_mesh(Path(plane.mesh or ""), float(plane.unit), plane.material)
    for place, name in [("push.node", scene.push.node)] + [(f"plane.supports.{name}", name) for name in plane.supports]:
        if name not in mesh.edges:
            known = ", ".join(sorted(mesh.edges))
            raise InputError(place, f'the mesh has no edge "{name}"', f"its edges are {known}")

    def body(level: int) -> Body:
        fine = mesh
        for _ in range(level):
            fine = fine.refined()
        law = J2.of(materials, fine.group, plane.hardening)
        edges = boundary(fine, plane.supports, scene.push.node, scene.push_direction(), "plane.supports")
        continuum = Continuum(fine, plane.body_thickness, law, edges.dofs, edges.axes)
        weight = np.array([[0.0, -material.density * scene.gravity] for material in materials])
        return Body(continuum, edges, continuum.body_force(weight[fine.group]))

    body(0)  # faults of the boundary are found before any long work is done
    held = ", ".join(f"{name} {kind}" for name, kind in plane.supports.items())
    finer = int(math.log(max(_MOST_ELEMENTS / len(mesh.cells), 4.0), 4.0))
    return PlaneScene(body, 1 + finer, False, 1.0, f"mesh {Path(plane.mesh or '').name}, {held}")


def _member(scene: Scene) -> PlaneScene:
    ((name, member),) = scene.members.items()
    c, s, length = scene.axis(name)
    turn = np.array([[c, s], [-s, c]])
    depth = member.section.depth
    thickness = member.section.area / depth
    plane = scene.plane or Plane()
    pushed, root = ("right", "left") if scene.push.node == member.end else ("left", "right")
    supports: dict[str, str] = {root: plane.root}
    if any(scene.nodes[scene.push.node].held):
        supports[pushed] = "roller-y"
    ends = (root == "left" or pushed in supports, root == "right" or pushed in supports)
    way = turn @ scene.push_direction()
    spread = np.array([0.0, -scene.weight_per_length(name)])
    at_end = np.zeros(2)
    for load in scene.loads_of("dead"):
        spread = spread + np.array(load.per_length)
        at_end = at_end + np.array(load.force)
    proportional = scene.loads_of("proportional")
    pulls = np.array([way, turn @ spread, turn @ at_end])
    half = bool(np.all(np.abs(pulls[:, 0]) <= 1e-9 * np.abs(pulls[:, 1])))
    parts = 2 if half else 1
    if half:
        supports["bottom"] = "roller-y"

    def body(level: int) -> Body:
        mesh = beam_mesh(length, depth, level, ends, half=half)
        law = J2.of([member.material], mesh.group, plane.hardening)
        edges = boundary(mesh, supports, pushed, (float(way[0]), float(way[1])), f"members.{name}", half=half)
        continuum = Continuum(mesh, parts * thickness, law, edges.dofs, edges.axes)
        dead = continuum.body_force(np.tile(turn @ spread / member.section.area, (len(mesh.cells), 1)))
        shares = parts * edge_weights(mesh, pushed) / depth
        pull = np.einsum("n,d,ned->ne", shares, turn @ at_end, edges.axes)
        dead += np.bincount(edges.dofs.ravel(), weights=pull.ravel(), minlength=continuum.size)
        return Body(continuum, edges, dead)

    unit = sum(float(np.hypot(*load.force)) for load in proportional) if proportional else 1.0
    return PlaneScene(body, _HALF_LEVELS if half else _MEMBER_LEVELS, half, unit, f"{plane.root} root")
