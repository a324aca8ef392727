"""``ductile simulate``: what rigid bodies with ductile joints do."""

from __future__ import annotations

import json
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from calibration.commands.options import Folder, Json, SceneName, WholeNumber
from capacity.errors import InputError


def simulate(
    scene: SceneName,
    /,
    *,
    dt: str | None = None,
    iterations: WholeNumber | None = None,
    duration: str | None = None,
    csv: Annotated[bool, Parameter(name="--csv", negative=())] = False,
    gif: Annotated[bool, Parameter(name="--gif", negative=())] = False,
    mp4: Annotated[bool, Parameter(name="--mp4", negative=())] = False,
    live: Annotated[bool, Parameter(name="--live", negative=())] = False,
    reference: bool | None = None,
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Run a scene with rigid bodies and ductile joints: the figures that it measures, and a replay to look at.

    Parameters
    ----------
    dt
        Step, in place of the scene's ("1/240 s").
    iterations
        Iterations of Chipmunk's solver in a step, in place of the scene's.
    duration
        How long, in place of the scene's ("20 s").
    csv
        Write all joints over time to joints.csv, and the energy ledger to energy.csv.
    gif
        Write a film of the run to run.gif.
    mp4
        Write a film of the run to run.mp4; needs ffmpeg, or the extra "video".
    live
        Show the run in a window while it goes on; needs the extra "live".
    reference
        Lay the finite-element reference's shape over the replay; for a push this is done unless told not to.
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
    from calibration.moving_picture import ffmpeg
    from calibration.reference_shape import shape_for_replay
    from calibration.run_pictures import Camera, pictures
    from calibration.simulate_command import JointTable, as_object, energy_table, print_answer, run, run_in_window
    from sim.scene_model import left_out
    from sim.world import World

    if mp4:
        ffmpeg()
    world = World(loaded, step, iterations, length)
    for remark in left_out(loaded):
        messages.print(f"Mind: {remark}.", soft_wrap=True, markup=False)
    table, camera = JointTable(world, max(world.dt, world.duration / 1000.0)), Camera(world)

    def after_step() -> None:
        camera.note()
        if csv:
            table.note()

    if live:
        seconds = run_in_window(world, after_step)
    else:
        with progress_bar(messages) as watch:
            seconds = run(world, after_step, watch)
    recording = camera.recording()
    answer = as_object(world, scene, seconds, recording)
    files: dict[str, str | bytes] = {"simulation.json": json.dumps(answer, indent=1)}
    if csv:
        files["joints.csv"] = table.text()
        files["energy.csv"] = energy_table(recording)
    with progress_bar(messages) as watch:
        wanted = loaded.pushed is not None if reference is None else reference
        shape = None
        if wanted:
            shape = shape_for_replay(loaded, camera.pushed, messages, lambda share: watch("reference", share))
        watch("drawing", 1.0)
        files |= pictures(recording, shape, gif, mp4)
    folder.write(files)
    if as_json:
        print(json.dumps(answer))
    else:
        print_answer(answer, Console())
    folder.announce(messages)
    return 0
