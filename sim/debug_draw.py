"""Joints drawn as pymunk draws its own: `Space.debug_draw` knows the constraints of Chipmunk alone."""

from __future__ import annotations

import pymunk
from pymunk.space_debug_draw_options import SpaceDebugColor, SpaceDebugDrawOptions

from sim.joint import DuctileJoint

#: A joint that bears as much as it can.
FULL = SpaceDebugColor(231, 76, 60, 255)


def draw_joints(space: pymunk.Space, options: SpaceDebugDrawOptions, size: float = 5.0) -> None:
    """Draw a dot for every ductile joint of a space; to be called after `Space.debug_draw`, with the same options.

    Its colour goes from the options' `constraint_color` to red with the largest of N / N_max, Q / Q_max, M / M_max.

    Parameters
    ----------
    space : pymunk.Space
    options : pymunk.SpaceDebugDrawOptions
        Those of pygame, pyglet, matplotlib, or of one's own. Nothing is drawn where they draw no constraints.
    size : float
        Of a dot, as the options take it.
    """
    if not options.flags & SpaceDebugDrawOptions.DRAW_CONSTRAINTS:
        return
    idle = options.constraint_color
    for joint in space.constraints:
        if isinstance(joint, DuctileJoint):
            share = min(max(joint.utilisation), 1.0)
            colour = SpaceDebugColor(*(a + share * (b - a) for a, b in zip(idle, FULL, strict=True)))
            options.draw_dot(size, pymunk.Vec2d(*joint.point_on(joint.a)), colour)
