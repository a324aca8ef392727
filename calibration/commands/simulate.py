"""``ductile simulate``: what rigid bodies with ductile joints do."""

from __future__ import annotations

import json
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from calibration.commands.options import Folder, Json
from capacity.errors import InputError


def simulate(
    scene: str,
    /,
    *,
    dt: str | None = None,
    iterations: int | None = None,
    duration: str | None = None,
    csv: Annotated[bool, Parameter(name="--csv", negative=())] = False,
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Run a scene with rigid bodies and ductile joints, and tell the figures that it measures.

    Parameters
    ----------
    scene
        A TOML file, or the name of a built-in scene.
    dt
        Step, in place of the scene's ("1/240 s").
    iterations
        Iterations of Chipmunk's solver in a step, in place of the scene's.
    duration
        How long, in place of the scene's ("20 s").
    csv
        Write all joints over time to joints.csv.
    output
        Folder for the files; out/SCENE by default.
    as_json
        Print one JSON object, in SI units, in place of the table.
    """
    from calibration.output import OutputFolder
    from calibration.progress import explained_compilation, progress_bar
    from capacity.units import positive
    from scene import load_scene

    step = None if dt is None else positive(dt, "time", "--dt")
    length = None if duration is None else positive(duration, "time", "--duration")
    if iterations is not None and iterations < 1:
        raise InputError("--iterations", f"{iterations} is less than 1", "write a whole number such as 10")
    loaded = load_scene(scene)
    folder = OutputFolder.of_scene(scene, output)
    messages = Console(stderr=True)
    with explained_compilation(messages):
        import sim  # noqa: F401
    from calibration.simulate_command import JointTable, as_object, print_answer, run
    from sim.world import World

    world = World(loaded, step, iterations, length)
    table = JointTable(world, max(world.dt, world.duration / 1000.0))
    with progress_bar(messages) as watch:
        seconds = run(world, table.note if csv else lambda: None, watch)
    answer = as_object(world, scene, seconds)
    files = {"simulation.json": json.dumps(answer, indent=1)}
    if csv:
        files["joints.csv"] = table.text()
    folder.write(files)
    if as_json:
        print(json.dumps(answer))
    else:
        print_answer(answer, Console())
    folder.announce(messages)
    return 0
