"""``ductile calibrate``: the cheapest model that follows the reference closely enough."""

from __future__ import annotations

import json

from rich.console import Console

from calibration.commands.options import Folder, Json, SceneName, share


def calibrate(
    scene: SceneName,
    /,
    *,
    target_error: str = "1 %",
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Find the cheapest rigid-body model that follows the elastic–plastic reference closely enough.

    Writes report.html, report.md, calibration.json, joints.json and the curves as CSV.

    Parameters
    ----------
    target_error
        Largest difference of load allowed on the path, as a share of the largest load ("1 %", "0.003"); in a motion, of
        the peak and of where it comes to rest, as a share of the peak.
    """
    from calibration.output import OutputFolder
    from calibration.progress import explained_compilation, progress_bar
    from calibration.report import print_report
    from capacity.errors import InputError
    from scene import load_scene

    target = share(target_error, "--target-error")
    loaded = load_scene(scene)
    if loaded.meshed is not None:
        raise InputError("plane.mesh", "a mesh has no members to put joints in", "`ductile reference` follows it")
    folder = OutputFolder.of_scene(scene, output)
    messages = Console(stderr=True)
    with explained_compilation(messages):
        import sim  # noqa: F401
    from calibration.calibrate_command import answer

    with progress_bar(messages) as watch:
        found = answer(loaded, target, scene, watch)
        watch("writing the report", 1.0)
        folder.write(found.files())
    if as_json:
        print(json.dumps(found.whole))
    else:
        print_report(found.report, Console())
    folder.announce(messages)
    return 0 if found.report.met else 1
