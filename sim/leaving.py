"""Joints that leave their structure: taken out of the space by hand, broken, or left for another structure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim import chipmunk
from sim.joint import DuctileJoint
from sim.refused_step import space_of
from sim.step_back import raise_after_step

if TYPE_CHECKING:
    from sim.structure import Structure


def those_gone(structure: Structure) -> None:
    """Have joints that were taken out form a structure anew should they come back."""
    for joint, holds in zip(structure.joints, structure.active, strict=True):
        if not (holds or joint.broken) and joint.structure is structure:
            joint.ask_for_structure()


def set_free(structure: Structure) -> None:
    """Have joints do nothing until another structure takes them over, or they come back."""
    for joint in structure.joints:
        if joint.structure is structure:
            chipmunk.release(joint._constraint)
            if not joint.broken:
                joint.ask_for_structure()


def take_out_broken(structure: Structure) -> None:
    """Take joints that broke out of their space, and have those that are left form structures anew."""
    own = [joint for joint in structure.joints if joint.structure is structure]
    for joint in own:
        if not joint.broken:
            joint.ask_for_structure()
    for joint in own:
        if joint.broken:
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
