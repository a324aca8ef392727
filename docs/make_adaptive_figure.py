"""Draws docs/images/adaptive-frame.png: which members of the struck frame were refined, and what that does to its path.

python docs/make_adaptive_figure.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import msgspec
import numpy as np

from scene import Scene, load_scene
from sim.world import World

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

HERE = Path(__file__).parent
SCENE = HERE.parent / "examples" / "struck-frame.toml"
COARSE, REFINED, GREY = "#7a8793", "#c1440e", "#4c566a"
CURVES = {
    "26 joints in every member": ({"refine_at": None}, "-", GREY, 3.5),
    "refined where struck": ({}, "--", REFINED, 1.8),
    "6 joints in every member": ({"refine_at": None, "joints": 6}, "-", COARSE, 1.0),
}


def run(scene: Scene, **settings: Any) -> tuple[World, np.ndarray, np.ndarray]:
    """The scene after its duration, with times [s] and the way of the first floor [m]."""
    assert scene.simulation is not None
    world = World(msgspec.structs.replace(scene, simulation=msgspec.structs.replace(scene.simulation, **settings)))
    start, times, way = world.point_called("frame-0-1")[0].position.x, [0.0], [0.0]
    while not world.finished:
        world.step()
        times.append(world.time)
        way.append(world.point_called("frame-0-1")[0].position.x - start)
    return world, np.array(times), np.array(way)


def draw_frame(axes: Axes, world: World) -> None:
    """Members with their joints, refined ones in colour, displacements as they are."""
    when = {name: time for time, name in world.refined}
    for name, member in world.scene.members.items():
        joints = world.joints[name]
        x, y = np.array([joint.point_on(joint.b) for joint in joints]).T
        colour = REFINED if name in when else COARSE
        axes.plot(x, y, "-", color=colour, linewidth=2.2 if name in when else 1.2)
        axes.plot(x, y, "o", color=colour, markersize=2.4)
        if name in when:
            middle, across = len(x) // 2, member.start[-1] == member.end[-1]
            offset = (0, 5) if across else (5, 0)
            label, kind = f"{1e3 * when[name]:.0f} ms", {"ha": "center"} if across else {"va": "center"}
            axes.annotate(label, (x[middle], y[middle]), offset, textcoords="offset points", fontsize=7, **kind)
    for body in (world.bodies["lorry"], world.bodies["bumper"]):
        for shape in body.shapes:
            outline = shape.get_vertices() if hasattr(shape, "get_vertices") else []
            if outline:
                corners = np.array([body.local_to_world(corner) for corner in [*outline, outline[0]]])
                axes.plot(*corners.T, color=GREY, linewidth=1.0)
            else:
                axes.add_patch(plt.Circle(tuple(body.position), shape.radius, fill=False, color=GREY))
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_title("Refined members, and when", fontsize=9)


def main() -> None:
    """Run the scene three times and draw."""
    scene = load_scene(str(SCENE))
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 4.2), layout="constrained")
    for label, (settings, line, colour, width) in CURVES.items():
        world, times, way = run(scene, **settings)
        right.plot(1e3 * times, 1e3 * way, line, color=colour, linewidth=width, label=label)
        if not settings:
            draw_frame(left, world)
    right.set_xlabel("time [ms]")
    right.set_ylabel("way of the first floor [mm]")
    right.legend(fontsize=8, frameon=False)
    right.set_title("Path of the floor above the struck column", fontsize=9)
    for axes in (left, right):
        axes.tick_params(labelsize=8)
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(HERE / "images" / "adaptive-frame.png", dpi=110)


if __name__ == "__main__":
    main()
