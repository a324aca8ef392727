"""A scene's members, supports and loads as one `Frame`."""

from __future__ import annotations

import numpy as np

from capacity import InputError
from capacity.fibres import Fibres
from capacity.stress_strain import StressStrain
from fem_reference.frame import NATURAL, Frame
from fem_reference.kinematics import Chords
from fem_reference.member_mesh import SHEAR, MemberMesh, mesh_member, turned
from fem_reference.section_response import FibreSections
from scene import Load, Scene

#: Depths from the axis to the fibres that stand for an ideal hinge.
_FAR = 1e4


def build_frame(scene: Scene, elements: int, fibres: int) -> Frame:
    """Mesh every member of ``scene`` with ``elements`` elements and ``fibres`` fibres a section.

    Elements shrink towards a member's ends with the distance, for that is where hinges form.

    Raises
    ------
    InputError
        When a stress–strain curve grows steeper somewhere.
    """
    ends = {name: np.arange(3) + 3 * i for i, name in enumerate(scene.nodes)}
    meshes = {name: mesh_member(scene.axis(name)[2], elements) for name in scene.members}
    dofs, size = _number(scene, elements, ends)
    strain_matrix = [
        mesh.strain_matrix[..., NATURAL]
        if scene.kinematics == "large"
        else turned(mesh.strain_matrix, *scene.axis(name)[:2])
        for name, mesh in meshes.items()
    ]
    spans = [np.outer(np.diff(mesh.points), scene.axis(name)[:2]) for name, mesh in meshes.items()]
    fixed, settlement = _prescribed(scene, ends, dofs, size)
    weight, element_weight = _loads(scene, scene.loads_of("dead"), meshes, dofs, ends, size, own_weight=True)
    proportional = scene.loads_of("proportional") if scene.motion is None else scene.loads_of("step")
    pattern, element_pattern = _loads(scene, proportional, meshes, dofs, ends, size, own_weight=False)
    if scene.pushed is not None and not proportional:
        pattern = control_vector(scene, ends, size)
    springs, bearings = np.zeros(size), np.zeros(size)
    for name, node in scene.nodes.items():
        springs[ends[name]] += node.spring or (0.0, 0.0, 0.0)
        bearings[ends[name][1]] = node.bearing
    return Frame(
        strain_matrix=np.concatenate(strain_matrix),
        weights=np.concatenate([mesh.weights for mesh in meshes.values()]),
        dofs=np.concatenate(list(dofs.values())),
        chords=Chords(np.concatenate(spans)),
        kinematics=scene.kinematics,
        sections=_sections(scene, elements, fibres),
        springs=springs,
        bearings=bearings,
        fixed=fixed,
        settlement=settlement,
        size=size,
        node_dofs=ends,
        weight=weight,
        element_weight=element_weight,
        element_pattern=element_pattern,
        pattern=pattern,
        meshes=meshes,
    )


def _sections(scene: Scene, elements: int, fibres: int) -> FibreSections:
    """Fibres of every member; sections with fewer fibres than others get some without area, curves with fewer breaks
    some at which nothing changes.
    """
    cut = [
        [_ideal_hinge(scene, name)] if scene.yielding == "ideal-hinges" else _pieces(scene, name, fibres)
        for name in scene.members
    ]
    laws = [law for pieces in cut for _, law in pieces]
    widest = max(sum(len(part.y) for part, _ in pieces) for pieces in cut)
    y, area, material = np.zeros((len(cut), widest)), np.zeros((len(cut), widest)), np.zeros((len(cut), widest), int)
    law = 0
    for m, pieces in enumerate(cut):
        first = 0
        for part, _ in pieces:
            here = slice(first, first := first + len(part.y))
            y[m, here], area[m, here], material[m, here] = part.y, part.area, law
            law += 1
    layers = max(len(law.breaks) for law in laws)
    return FibreSections(
        kind=np.repeat(np.arange(len(cut)), elements),
        y=y,
        area=area,
        material=material,
        youngs_modulus=np.array([law.slopes[0] for law in laws]),
        last_slope=np.array([law.slopes[-1] for law in laws]),
        breaks=np.array([np.pad(law.breaks, (0, layers - len(law.breaks)), constant_values=np.inf) for law in laws]),
        drops=np.array([np.pad(law.drops, (0, layers - len(law.drops))) for law in laws]),
        shear_stiffness=np.repeat([scene.capacity(name).GA_s for name in scene.members], elements),
    )


def _pieces(scene: Scene, name: str, fibres: int) -> list[tuple[Fibres, StressStrain]]:
    """Fibres of each of a member's materials, and its law; the member's axis is the centroid weighted with E."""
    member = scene.members[name]
    section, material = member.section, member.material
    if section.has_own_materials:
        parts = section.fibres_by_material(fibres, material)
    else:
        parts = [(material, section.fibres(fibres))]
    for own, _ in parts:
        if not own.stress_strain.unloads:
            fault = "its stress–strain curve grows steeper somewhere, which says nothing about unloading"
            raise InputError(f"members.{name}.material", fault, "use a curve whose slope only falls")
    if len(parts) == 1:
        return [(part, own.stress_strain) for own, part in parts]
    stiffness = [own.youngs_modulus * part.area for own, part in parts]
    axis = (
        sum(float(k @ part.y) for k, (_, part) in zip(stiffness, parts, strict=True)) / np.concatenate(stiffness).sum()
    )
    return [(Fibres(part.y - axis, part.area), own.stress_strain) for own, part in parts]


def _ideal_hinge(scene: Scene, name: str) -> tuple[Fibres, StressStrain]:
    """Fibres that bend elastically up to M_p and then turn, whatever the axial force.

    Two of area I / 2r² at ± r, far outside the section, make up EI and yield together at the strain r M_p / EI, beside
    which that of the axial force is nothing. The rest of the area lies on the axis and never comes to that strain.
    """
    material, c = scene.members[name].material, scene.capacity(name)
    e = material.youngs_modulus
    r = _FAR * scene.members[name].section.depth
    outer = c.EI / (2.0 * e * r**2)
    fibres = Fibres(np.array([-r, 0.0, r]), np.array([outer, c.EA / e - 2.0 * outer, outer]))
    return fibres, StressStrain.bilinear(e, e * r * c.M_max / c.EI, material.tangent_modulus)


def control_vector(scene: Scene, node_dofs: dict[str, np.ndarray], size: int) -> np.ndarray:
    """The vector (size,) whose product with displacements is the displacement along the push."""
    vector = np.zeros(size)
    vector[node_dofs[scene.push.node][:2]] = scene.push_direction()
    return vector


def _number(scene: Scene, elements: int, ends: dict[str, np.ndarray]) -> tuple[dict[str, np.ndarray], int]:
    """Global degrees of freedom (m, 8) of each member's elements, and their number.

    A released end has a rotation of its own.
    """
    size = 3 * len(ends)
    dofs = {}
    for name, member in scene.members.items():
        inner = size + np.arange(3 * (elements - 1)).reshape(-1, 3)
        size += inner.size
        node = np.vstack([ends[member.start], inner, ends[member.end]])
        for end, row in (("from", 0), ("to", -1)):
            if end in member.releases:
                node[row, 2] = size
                size += 1
        bubbles = size + np.arange(elements)
        size += 2 * elements
        dofs[name] = np.column_stack([node[:-1], node[1:], bubbles, bubbles + elements])
    return dofs, size


def _prescribed(
    scene: Scene, ends: dict[str, np.ndarray], dofs: dict[str, np.ndarray], size: int
) -> tuple[np.ndarray, np.ndarray]:
    """Degrees of freedom that supports hold or that nothing stiffens, and where they are held."""
    value = np.full(size, np.nan)
    for name, node in scene.nodes.items():
        held = np.array(node.held)
        value[ends[name][held]] = np.array([*node.settlement, 0.0])[held]
        # Between hinges only, a node's rotation has no stiffness and no meaning.
        turns = any(np.any(part[:, [2, 5]] == ends[name][2]) for part in dofs.values())
        if not turns and not (node.spring or (0.0, 0.0, 0.0))[2]:
            value[ends[name][2]] = 0.0
    for name, member in scene.members.items():
        if member.theory == "euler-bernoulli":
            value[dofs[name][:, SHEAR]] = 0.0
    fixed = np.flatnonzero(~np.isnan(value))
    return fixed, value[fixed]


def _loads(
    scene: Scene,
    loads: tuple[Load, ...],
    meshes: dict[str, MemberMesh],
    dofs: dict[str, np.ndarray],
    ends: dict[str, np.ndarray],
    size: int,
    *,
    own_weight: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """Nodal loads (size,), and the part of it that is spread over elements (n, 8)."""
    spread = []
    for name, mesh in meshes.items():
        c, s, _ = scene.axis(name)
        qx = sum(float(load.per_length[0]) for load in loads if load.member == name)
        qy = sum(float(load.per_length[1]) for load in loads if load.member == name)
        qy -= scene.weight_per_length(name) if own_weight else 0.0
        spread.append(turned(mesh.spread(c * qx + s * qy, c * qy - s * qx), c, s))
    elements = np.concatenate(spread)
    total = np.bincount(np.concatenate(list(dofs.values())).ravel(), weights=elements.ravel(), minlength=size)
    for load in loads:
        if load.node is not None:
            total[ends[load.node]] += (*load.force, load.moment)
    if own_weight:
        for name, node in scene.nodes.items():
            total[ends[name][1]] -= node.mass * scene.gravity
    return total, elements
