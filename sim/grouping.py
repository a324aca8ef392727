"""Which joints of a space form a structure together."""

from __future__ import annotations

import pymunk

from sim.joint import DuctileJoint
from sim.structure import Structure


def group(constraint: pymunk.Constraint, space: pymunk.Space) -> None:  # noqa: ARG001
    """Group all ductile joints of ``space`` into structures; those whose company has not changed stay as they are."""
    joints = [c for c in space.constraints if isinstance(c, DuctileJoint) and not c.broken]
    parent: dict[pymunk.Body, pymunk.Body] = {}

    def root(body: pymunk.Body) -> pymunk.Body:
        while parent.setdefault(body, body) is not body:
            parent[body] = parent[parent[body]]
            body = parent[body]
        return body

    for joint in joints:
        ends = [body for body in (joint.a, joint.b) if body.body_type == pymunk.Body.DYNAMIC]
        if len(ends) == 2:
            parent[root(ends[0])] = root(ends[1])
    groups: dict[pymunk.Body, list[DuctileJoint]] = {}
    for joint in joints:
        body = joint.a if joint.a.body_type == pymunk.Body.DYNAMIC else joint.b
        groups.setdefault(root(body), []).append(joint)
    for members in groups.values():
        old = members[0].structure
        if old is not None and set(old.joints) == set(members):
            for joint in members:
                joint.pre_solve = None
        else:
            Structure(members)
