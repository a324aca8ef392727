"""``ductile study``: speed against error, and the maps of hard cases."""

from __future__ import annotations

import json
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from calibration.commands.options import Folder, Json, SceneName
from capacity.errors import InputError

Wanted = Annotated[str | None, Parameter()]


def study(
    scene: SceneName,
    /,
    *,
    rules: Wanted = None,
    joints: Wanted = None,
    laws: Wanted = None,
    dt: Wanted = None,
    iterations: Wanted = None,
    stock: bool = True,
    hard_cases: bool = True,
    executor: str = "local",
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Sweep rule, joints, law, step and iterations, and draw speed against error; stop and resume as you like.

    Writes study.html, study.json, CSV and pictures, and the journal from which a study resumes.

    Parameters
    ----------
    rules
        Where the joints of a member go, separated by commas ("lobatto, equal").
    joints
        Points of the rule in a member ("3, 5, 8").
    laws
        Joint laws ("elastic-plastic, fibre").
    dt
        Steps ("1/60 s, 1/240 s").
    iterations
        Iterations of the solver ("2, 10").
    stock
        Compare with pymunk's own joints.
    hard_cases
        Map which mass ratios and stiffnesses are borne at which step.
    executor
        Where to compute: "local" (all cores), "local:2", or "dask://HOST:PORT".
    """
    from concurrent.futures import CancelledError
    from functools import partial

    from calibration.output import OutputFolder
    from calibration.progress import explained_compilation, progress_bar
    from calibration.study.executors import workers
    from scene import load_scene

    loaded = load_scene(scene)
    if loaded.pushed is None and loaded.motion is not None:
        cure = "add [push], or read the speed against error of `ductile calibrate`, which follows motions"
        raise InputError("push", "a study pushes its scene over, and this one has only a motion", cure)
    folder = OutputFolder.of_scene(scene, output)
    messages = Console(stderr=True)
    with explained_compilation(messages):
        import sim  # noqa: F401
    from calibration.study import figures
    from calibration.study.choices import read_choices
    from calibration.study.journal import Journal, point_keys
    from calibration.study.measure import measure
    from calibration.study.outcome import outcome, plain, points_csv
    from calibration.study.page import print_study, study_page
    from calibration.study.points import Point, hard_points, model_points, total_cost
    from calibration.study.sweep import sweep
    from calibration.tuning import REFERENCE_TOLERANCE
    from fem_reference import push_over
    from sim.followed import check_followed

    check_followed(loaded)

    journal = Journal(folder.path)
    points: list[Point] = [
        *model_points(read_choices(rules, joints, laws, dt, iterations, stock)),
        *(hard_points() if hard_cases else []),
    ]
    with workers(executor) as hired, progress_bar(messages) as watch:
        reference = push_over(loaded, REFERENCE_TOLERANCE, lambda part: watch("reference", part))
        keys = point_keys(loaded, points)
        left = [point for key, point in keys.items() if key not in journal.results]
        whole, done = total_cost(left), 0.0
        if len(left) < len(points):
            messages.print(f"{len(points) - len(left)} of {len(points)} points are in {journal.path} already")

        def one_more(point: Point) -> None:
            nonlocal done
            done += point.cost
            watch(point.name, done / whole)

        try:
            sweep(keys, partial(measure, loaded, reference), hired, journal, one_more)
        except KeyboardInterrupt:
            kept = len(keys.keys() & Journal(folder.path).results.keys())
            messages.print(f"Stopped: {kept} of {len(points)} points are in {journal.path}; run it again to go on")
            raise
        except CancelledError as error:  # as Dask's futures end when its scheduler is gone
            raise InputError("--executor", "the cluster went away", "start it again, and then the study") from error
        watch("drawing", 1.0)
        found = outcome(scene, loaded.title, reference, points, [journal.results[key] for key in keys])
        folder.write(
            {
                "study.html": study_page(found),
                "study.json": json.dumps(plain(found), indent=1),
                "study.csv": points_csv(found),
                "frontier.png": figures.png(figures.frontier(found)),
                **({"hard-cases.png": figures.png(figures.hard_maps(found))} if hard_cases else {}),
            }
        )
    if as_json:
        print(json.dumps(plain(found)))
    else:
        print_study(found, Console())
    folder.announce(messages)
    return 0
