"""``ductile fit``: parameters of the joints that follow load cases best."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from calibration.commands.options import Folder, Json, SceneName, WholeNumber, at_least, share
from capacity.errors import InputError


def fit(
    *scenes: SceneName,
    vary: str = "stiffness, strength, spread",
    bounds: str = "",
    weights: str = "",
    check: Annotated[list[str] | None, Parameter(negative=())] = None,
    rule: str = "lobatto",
    joints: WholeNumber = 6,
    law: str = "fibre",
    fibres: WholeNumber = 12,
    dt: str | None = None,
    target_error: str = "1 %",
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Fit parameters of the joints to the references of one load case or several: pushes, cycles and motions together.

    Writes report.html, report.md, fit.json and joints.json. Ends with 1 when a load case, or what the fit did not see,
    is not followed within the target error.

    Parameters
    ----------
    vary
        What to fit: stiffness and strength (factors of E and fy), spread (of yield stresses), hardening (E_t / E),
        reserve (hardening begins that share below the strength and ends there), hinge_length (in section depths, of
        the rule "radau"), damping (over stiffness, in seconds).
    bounds
        Where parameters are held, instead of the ordinary bounds ("strength=0.8:1.2, damping=0:0.02").
    weights
        Of the load cases, in their order ("1, 2"); all alike by default.
    check
        A scene that the fit does not see and is checked on; may be given several times. By default the first scene,
        pushed half as far and back, or set going half as hard.
    rule
        Where the joints of a member go: lobatto, equal or radau.
    joints
        Points of the rule in each member.
    law
        What they yield by: rigid-plastic, elastic-plastic, interaction or fibre.
    fibres
        In a section, for the fibre law.
    dt
        Step; 1/60 s by default, and 1/1000 s where a scene has a motion.
    target_error
        Largest difference wanted, as a share of the largest load or of the peak ("1 %", "0.003").
    """
    from calibration.output import OutputFolder
    from calibration.progress import explained_compilation, progress_bar
    from capacity.units import positive
    from scene import load_scene

    target = share(target_error, "--target-error")
    if not scenes:
        raise InputError("fit", "there is nothing to fit to", "name a scene or several")
    loaded = [(Path(name).stem, load_scene(name)) for name in dict.fromkeys(scenes)]
    checks = [(Path(name).stem, load_scene(name)) for name in check or ()]
    if len({name for name, _ in (*loaded, *checks)}) < len(loaded) + len(checks):
        raise InputError("fit", "two scenes have the same name", "give their files names of their own")
    for name, scene in (*loaded, *checks):
        if not scene.members or (scene.pushed is None and scene.motion is None):
            raise InputError(name, "has no members that are pushed or move", "name a scene with [push] or [motion]")
    shares = [positive(part, "number", "--weights") for part in weights.split(",") if part.strip()]
    if shares and len(shares) != len(loaded):
        fault = f"{len(shares)} weights for {len(loaded)} scenes"
        raise InputError("--weights", fault, "write one for each scene, with commas between")
    at_least(joints, 2, "--joints")
    at_least(fibres, 4, "--fibres")
    moves = any(scene.pushed is None for _, scene in (*loaded, *checks))
    step = (1.0 / 1000.0 if moves else 1.0 / 60.0) if dt is None else positive(dt, "time", "--dt")
    folder = OutputFolder.of_scene(scenes[0], output)
    messages = Console(stderr=True)
    with explained_compilation(messages):
        import sim
    from calibration.fit_command import answer, parameter_names, read_bounds
    from calibration.report import print_report

    for option, value, known in (("--rule", rule, sim.RULES), ("--law", law, sim.LAWS)):
        if value not in known:
            raise InputError(option, f'there is no "{value}"', f"choose from {', '.join(known)}")
    if rule == "radau":
        at_least(joints, 6, "--joints")
    names = parameter_names(vary)
    scheme = (sim.AVERAGE_ACCELERATION[0], 0.02)
    model = sim.Model(rule, joints, law, fibres, step, scheme=scheme)
    with progress_bar(messages) as watch:
        found = answer(
            loaded, checks, model, names, read_bounds(bounds, names), shares or [1.0] * len(loaded), target, watch
        )
        folder.write(found.files())
    if as_json:
        print(json.dumps(found.whole()))
    else:
        print_report(found.report, Console())
    folder.announce(messages)
    return 1 if found.limit else 0
