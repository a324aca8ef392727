"""A frame struck in one corner, refined where it is struck: error and time beside uniform cuts.

    python benchmarks/adaptive_frame.py [--rounds 5]

The scene is examples/struck-frame.toml. The error is the largest distance that a node's path has, at any time, from
that of a model with twice the joints at half the step, over the largest way in that path; times are medians of one run
in which the models take turns. Only their ratios carry over to another machine.
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from scene import Scene, load_scene
from sim.world import World

SCENE = Path(__file__).parent.parent / "examples" / "struck-frame.toml"
NODES = ("frame-0-1", "frame-1-1", "frame-0-4")
FINE, STEPS = 26, (2.5e-4, 5e-4)
UNIFORM = (FINE, 11, 6)


@dataclass(frozen=True)
class Run:
    """Paths of the nodes after each step (k, nodes, 2) [m], joints that a step had on average, processor time [s]."""

    path: np.ndarray
    joints: float
    seconds: float
    refined: int


def run(scene: Scene, **settings: Any) -> Run:
    """Simulate ``scene`` with other settings."""
    assert scene.simulation is not None
    world = World(msgspec.structs.replace(scene, simulation=msgspec.structs.replace(scene.simulation, **settings)))
    start, path, joints = _places(world), [], 0
    began = time.thread_time()
    while not world.finished:
        world.step()
        path.append(_places(world) - start)
        joints += sum(map(len, world.joints.values()))
    return Run(np.array(path), joints / world.steps, time.thread_time() - began, len(world.refined))


def _places(world: World) -> np.ndarray:
    return np.array([body.local_to_world(point) for body, point in map(world.point_called, NODES)])


def error(found: Run, reference: Run) -> np.ndarray:
    """Of each node's path, a share of the reference's largest way (nodes,)."""
    every = round(len(reference.path) / len(found.path))
    off = np.linalg.norm(found.path - reference.path[every - 1 :: every], axis=2).max(axis=0)
    share: np.ndarray = off / np.linalg.norm(reference.path, axis=2).max(axis=0)
    return share


def main() -> None:
    """Print a table for each step."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=5)
    rounds, scene = parser.parse_args().rounds, load_scene(str(SCENE))
    reference = run(scene, joints=2 * FINE - 1, dt=0.5 * min(STEPS), refine_at=None)
    models = {
        "refined where struck": {},
        **{f"{n} joints everywhere": {"joints": n, "refine_at": None} for n in UNIFORM},
    }
    for dt in STEPS:
        runs: dict[str, list[Run]] = {name: [] for name in models}
        for _ in range(rounds):
            for name, settings in models.items():
                runs[name].append(run(scene, dt=dt, **settings))
        times = {name: statistics.median(r.seconds for r in own) for name, own in runs.items()}
        fine = times[f"{FINE} joints everywhere"]
        print(f"step {1e3 * dt:g} ms; error of the paths of {', '.join(NODES)}")
        for name, (first, *_) in runs.items():
            shares = "  ".join(f"{100.0 * share:5.2f} %" for share in error(first, reference))
            relative = times[name] / fine
            print(f"  {name:22s} {first.joints:5.0f} joints  {shares}  time {relative:.2f}  {first.refined} refined")


if __name__ == "__main__":
    main()
