"""Joints that break leave their space."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.joint import DuctileJoint
from sim.refused_step import space_of
from sim.step_back import raise_after_step

if TYPE_CHECKING:
    from sim.structure import Structure


def take_out_broken(structure: Structure) -> None:
    """Take joints that broke out of their space."""
    for joint in structure.joints:
        if joint.structure is structure and joint.broken:
            _take_out(joint)


def _take_out(joint: DuctileJoint) -> None:
    """Take a joint out of its space, and tell the user; what that raises comes out of the step."""
    space = space_of(joint)
    if joint not in space.constraints:
        return
    space.remove(joint)
    if joint.on_break is not None:
        try:
            joint.on_break(joint)
        except Exception as error:
            raise_after_step(space, error)
