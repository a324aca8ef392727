"""Which joints of a space form a structure together.

Found before any structure begins a step, whenever the space has other bodies or constraints than in the last one, or a
joint asks for it. A structure whose joints are no longer all there, and no others, ends there; those that have its
joints now go on from it (`sim.succession`).
"""

from __future__ import annotations

from collections.abc import Iterable

import pymunk

from capacity import InputError
from sim import chipmunk
from sim.joint import DuctileJoint
from sim.kernels.noted import LOOKED
from sim.noted import Notes, notes_known, notes_of
from sim.space_state import look_after
from sim.step_back import raise_after_step
from sim.structure import Structure
from sim.succession import book_gone, let_go, was_away


def ask(joint: DuctileJoint) -> None:
    """Have the joints of a joint's space grouped at the start of the next step that it is in."""
    joint.pre_solve = group
    chipmunk.call_before_step(joint._constraint)
    for space in {body.space for body in (joint.a, joint.b)}:
        notes = notes_known(space) if space is not None else None
        if notes is not None:
            notes.outdate()


def group(constraint: pymunk.Constraint, space: pymunk.Space | None) -> None:
    """Group the joints of ``space``: what Chipmunk calls for one that has no structure.

    Where that fails, joints that have no structure do nothing; the space raises why when its step is over.
    """
    if space is None:
        raise _not_there(constraint)  # type: ignore[arg-type]  # which Python prints, for no space is known
    look_through(space)


def look_through(space: pymunk.Space) -> Notes:
    """Once in a step, before any structure begins it: group the joints of ``space``, and list all else that it has."""
    notes = notes_of(space)
    if notes.table[LOOKED] == chipmunk.steps_begun(space):
        return notes
    look_after(space)
    joints = [c for c in space.constraints if isinstance(c, DuctileJoint) and not c.broken]
    try:
        _group(joints, space)
    except Exception as error:
        raise_after_step(space, error)
    notes.look(space)
    for structure in _structures(joints):
        structure.know(notes)
    return notes


def _group(joints: list[DuctileJoint], space: pymunk.Space) -> None:
    strays = [joint for joint in joints if any(body.space is not space for body in _ends(joint))]
    olds = _structures(joints)
    if not set(olds).isdisjoint(joint.structure for joint in strays) or not all(map(_knows_what_moves, olds)):
        return  # whose step the kernels refuse
    for old in olds:
        if was_away(old, space):
            let_go(old)
    before, kept = _structures(joints), set()
    found: list[list[DuctileJoint]] = []
    for members in _companies(joint for joint in joints if joint not in strays):
        own = members[0].structure
        if own is not None and not own.superseded and own.is_of(members):
            kept.add(own)
            for joint in members:
                joint.pre_solve = None
        else:
            found.append(members)
    ended = [old for old in before if old not in kept]
    for old in ended:
        book_gone(old, space)
    try:
        for members in found:
            Structure(members)
    finally:
        for old in ended:
            let_go(old)
    if strays:
        raise _not_there(strays[0])


def _knows_what_moves(structure: Structure) -> bool:
    """Whether a structure's bodies are of the types that they were, or it is asked for anew."""
    return structure.knows_what_moves or any(joint.pre_solve is not None for joint in structure.joints)


def _structures(joints: Iterable[DuctileJoint]) -> list[Structure]:
    """Structures that joints are in, those that have not ended."""
    found = dict.fromkeys(joint.structure for joint in joints)
    return [structure for structure in found if structure is not None and not structure.superseded]


def _companies(joints: Iterable[DuctileJoint]) -> list[list[DuctileJoint]]:
    """Joints that hang together by dynamic bodies."""
    parent: dict[pymunk.Body, pymunk.Body] = {}

    def root(body: pymunk.Body) -> pymunk.Body:
        while parent.setdefault(body, body) is not body:
            parent[body] = parent[parent[body]]
            body = parent[body]
        return body

    own = [(joint, _ends(joint)) for joint in joints]
    for _, ends in own:
        parent[root(ends[0])] = root(ends[-1])
    found: dict[pymunk.Body, list[DuctileJoint]] = {}
    for joint, ends in own:
        found.setdefault(root(ends[0]), []).append(joint)
    return list(found.values())


def _ends(joint: DuctileJoint) -> list[pymunk.Body]:
    """Bodies of a joint that are dynamic."""
    return [body for body in (joint.a, joint.b) if body.body_type == pymunk.Body.DYNAMIC]


def _not_there(joint: DuctileJoint) -> InputError:
    x, y = joint.at
    return InputError(f"joint at {x:g}, {y:g}", "a body of it is not in the space", "space.add(body)")
