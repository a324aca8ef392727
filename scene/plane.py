"""A plane stress body: how the end of a member is held in one, or a body of any shape from a mesh file."""

from __future__ import annotations

from typing import Literal

import msgspec

from capacity import InputError, Material
from scene.quantities import Length, si

Root = Literal["clamped", "contraction-free"]
EdgeSupport = Literal["clamped", "contraction-free", "roller-x", "roller-y"]
Hardening = Literal["kinematic", "isotropic"]


class Plane(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What only a plane stress reference needs to know.

    Attributes
    ----------
    root : str
        How the clamped end of a member is held: ``"clamped"``, no point of it moves, or ``"contraction-free"``, no
        point moves along the member and the whole does not move across it.
    hardening : str
        ``"kinematic"``, as in members, or ``"isotropic"``.
    mesh : str, optional
        Path of a mesh; it stands in place of nodes and members.
    unit : Length
        One of the mesh's units of length [m].
    thickness : Length, optional
        Of the mesh [m].
    material : Material, optional
        Of the mesh, where its groups of cells name none.
    supports : dict[str, str]
        How each held edge of the mesh is held.
    """

    root: Root = "clamped"
    hardening: Hardening = "kinematic"
    mesh: str | None = None
    unit: Length = si(1.0)
    thickness: Length | None = None
    material: Material | None = None
    supports: dict[str, EdgeSupport] = {}

    @property
    def body_thickness(self) -> float:
        """Thickness of the mesh [m].

        Raises
        ------
        InputError
            When the scene gives none.
        """
        if self.thickness is None:
            raise InputError("plane.thickness", "the mesh has no thickness", 'write thickness = "10 mm"')
        return float(self.thickness)


def check_plane(plane: Plane) -> None:
    """Check the keys of a mesh.

    Raises
    ------
    InputError
        When a length is not positive, nothing is held, or keys of a mesh are there without one.
    """
    if plane.mesh is None:
        for key in ("thickness", "material", "supports"):
            if getattr(plane, key):
                raise InputError(f"plane.{key}", "there is no mesh that it could be of", 'add mesh = "body.msh"')
        return
    for key, value in (("thickness", plane.body_thickness), ("unit", float(plane.unit))):
        if not value > 0.0:
            raise InputError(f"plane.{key}", "it must be greater than zero", 'write a length such as "10 mm"')
    if not plane.supports:
        raise InputError("plane.supports", "no edge of the mesh is held", 'write supports = { left = "clamped" }')
