"""Loads of a scene as forces on its rigid bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import pymunk

from scene import LoadKind, Scene
from sim.pieces import NodePoint, Span


@dataclass(frozen=True)
class BodyLoad:
    """A force [N] on a body at a point of it, and a moment [N m]; both keep their direction."""

    body: pymunk.Body
    force: tuple[float, float]
    moment: float
    point: tuple[float, float]

    def act(self, share: float = 1.0) -> None:
        """Act with a share of the load on the body in the next step."""
        force = (share * self.force[0], share * self.force[1])
        self.body.apply_force_at_world_point(force, self.body.local_to_world(self.point))
        self.body.torque += share * self.moment


def body_loads(
    scene: Scene, kind: LoadKind, spans: Sequence[Span], nodes: Mapping[str, NodePoint]
) -> tuple[BodyLoad, ...]:
    """The scene's loads of one kind, on the bodies that they act on.

    A load per length acts on each piece at its middle: the moments at the joints are then those of the even load.
    """
    loads: list[BodyLoad] = []
    for load in scene.loads_of(kind):
        if load.member is not None:
            for span in spans:
                if span.member == load.member:
                    length = span.end - span.start
                    force = (load.per_length[0] * length, load.per_length[1] * length)
                    loads.append(BodyLoad(span.body, force, 0.0, span.middle))
        elif load.node is not None:
            at = nodes[load.node]
            fx, fy = load.force
            loads.append(BodyLoad(at.body, (fx, fy), float(load.moment), at.point))
    return tuple(loads)
