"""Which joints of a space form a structure together."""

from __future__ import annotations

from typing import cast

import pymunk

from capacity import InputError
from sim import chipmunk
from sim.joint import DuctileJoint
from sim.space_state import look_after
from sim.step_back import raise_after_step
from sim.structure import Structure


def ask(joint: DuctileJoint) -> None:
    """Have the joints of a joint's space grouped at the start of the next step that it is in."""
    joint.pre_solve = group
    chipmunk.call_before_step(joint._constraint)


def group(constraint: pymunk.Constraint, space: pymunk.Space | None) -> None:
    """Group all ductile joints of ``space`` into structures; those whose company has not changed stay as they are.

    Chipmunk calls this, and has no use for an exception: the space raises it when its step is over. Until then joints
    that have no structure do nothing.
    """
    if space is None:
        raise _not_there(cast(DuctileJoint, constraint))  # which Python prints, for no space is known
    try:
        _group(space)
    except Exception as error:
        asking = (c for c in space.constraints if isinstance(c, DuctileJoint) and c.pre_solve is group)
        if next(asking) is constraint:  # all of them ask, and fail alike
            raise_after_step(space, error)


def _group(space: pymunk.Space) -> None:
    look_after(space)
    joints = [c for c in space.constraints if isinstance(c, DuctileJoint) and not c.broken]
    parent: dict[pymunk.Body, pymunk.Body] = {}

    def root(body: pymunk.Body) -> pymunk.Body:
        while parent.setdefault(body, body) is not body:
            parent[body] = parent[parent[body]]
            body = parent[body]
        return body

    for joint in joints:
        ends = [body for body in (joint.a, joint.b) if body.body_type == pymunk.Body.DYNAMIC]
        if any(body.space is not space for body in ends):
            raise _not_there(joint)
        if len(ends) == 2:
            parent[root(ends[0])] = root(ends[1])
    groups: dict[pymunk.Body, list[DuctileJoint]] = {}
    for joint in joints:
        body = joint.a if joint.a.body_type == pymunk.Body.DYNAMIC else joint.b
        groups.setdefault(root(body), []).append(joint)
    for members in groups.values():
        old = members[0].structure
        if old is not None and set(old.joints) == set(members) and old.knows_what_moves and old.active.all():
            for joint in members:
                joint.pre_solve = None
        else:
            Structure(members)


def _not_there(joint: DuctileJoint) -> InputError:
    x, y = joint.at
    return InputError(f"joint at {x:g}, {y:g}", "a body of it is not in the space", "space.add(body)")
