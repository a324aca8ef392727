"""``ductile calibrate``: the cheapest model that follows the reference closely enough."""

from __future__ import annotations

import json

from rich.console import Console

from calibration.commands.options import Folder, Json, share


def calibrate(
    scene: str,
    /,
    *,
    target_error: str = "1 %",
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Find the cheapest rigid-body model that follows the elastic–plastic reference closely enough.

    Parameters
    ----------
    scene
        A TOML file, or the name of a built-in scene.
    target_error
        Largest difference of load allowed on the path, as a share of the largest load ("1 %", "0.003").
    output
        Folder for report.html, report.md, calibration.json, joints.json and the curves as CSV; out/SCENE by default.
    as_json
        Print one JSON object, in SI units, in place of the report.
    """
    from calibration.output import OutputFolder
    from calibration.progress import explained_compilation, progress_bar
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
    from calibration.export import calibration_object, curve_csv, joint_table
    from calibration.page import report_page
    from calibration.report import print_report, report_markdown
    from calibration.tables import report
    from calibration.tuning import calibrate as tune

    with progress_bar(messages) as watch:
        result = tune(loaded, target, scene, watch)
        watch("writing the report", 1.0)
        whole, found = calibration_object(result), report(result)
        folder.write(
            {
                "report.html": report_page(found),
                "report.md": report_markdown(found),
                "calibration.json": json.dumps(whole, indent=1),
                "joints.json": json.dumps(joint_table(result.fitted_scene, result.best.model, scene), indent=1),
                "reference.csv": curve_csv(result.reference.displacement, result.reference.load),
                "model.csv": curve_csv(result.best.push.displacement, result.best.push.load),
            }
        )
    if as_json:
        print(json.dumps(whole))
    else:
        print_report(found, Console())
    folder.announce(messages)
    return 0 if result.target_met else 1
