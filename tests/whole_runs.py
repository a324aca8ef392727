"""The built-in scenes from beginning to end at their own step, run once for all tests that look at the whole of one."""

from functools import cache

import numpy as np

from scene import load_scene
from sim.world import World


@cache
def whole_run(name: str) -> tuple[World, tuple[np.ndarray, ...]]:
    """The world in the end, which is only to be read; after each step, x, y and speed of each body's middle."""
    world, course = World(load_scene(name)), []
    while not world.finished:
        world.step()
        course.append(
            np.array([(*b.local_to_world(b.center_of_gravity), b.velocity.length) for b in world.space.bodies])
        )
    return world, tuple(course)
