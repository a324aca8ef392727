"""``ductile reference``: what the continuum does."""

from __future__ import annotations

import json

from rich.console import Console

from calibration.commands.options import Folder, Json, SceneName, share


def reference(
    scene: SceneName,
    /,
    *,
    target_error: str | None = None,
    output: Folder = None,
    as_json: Json = False,
    cache: bool = True,
) -> int:
    """Follow a push or a motion with the elastic–plastic finite-element reference; each number with its error.

    Writes the curve, hinges and sections as CSV, a plot as SVG, and fields as VTU.

    Parameters
    ----------
    target_error
        Largest estimated error of the load, as a share of the largest load ("0.05 %", "0.001"); 0.05 % by default, in
        plane stress 0.2 %; of a motion, of the displacement, 1 %.
    cache
        Keep results on disk and use them again for the same content.
    """
    from calibration.output import OutputFolder
    from calibration.progress import progress_bar
    from calibration.reference_command import answer, files, print_answer
    from fem_reference import default_tolerance
    from scene import load_scene

    loaded = load_scene(scene)
    target = default_tolerance(loaded) if target_error is None else share(target_error, "--target-error")
    folder = OutputFolder.of_scene(scene, output)
    messages = Console(stderr=True)
    with progress_bar(messages) as watch:
        found = answer(loaded, target, cache, lambda part: watch("reference", part))
    folder.write(files(found, loaded.title))
    if as_json:
        print(json.dumps({key: value for key, value in found.items() if key != "fields"}))
    else:
        print_answer(found, Console())
    folder.announce(messages)
    return 0 if found["error_estimate"] <= target else 1
