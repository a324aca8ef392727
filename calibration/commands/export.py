"""``ductile export``: a scene's joints in an engine's own terms."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from rich.console import Console

from calibration.commands.options import Folder, Json, SceneName, WholeNumber, share
from capacity.errors import InputError

_ENGINES = ("pymunk", "box2d", "bullet", "mujoco", "rapier", "godot", "unity", "unreal", "json")


def export(
    scene: SceneName,
    /,
    *,
    engine: str,
    rule: str = "lobatto",
    joints: WholeNumber | None = None,
    dt: str = "1/60 s",
    iterations: WholeNumber = 30,
    damping_ratio: str = "0.2",
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Hand a scene over to a game engine: bodies and joints in its own terms and units, and the error to expect.

    Parameters
    ----------
    engine
        pymunk, box2d, bullet, mujoco, rapier, godot, unity, unreal or json.
    rule
        Where the joints of a member go: lobatto or equal.
    joints
        Points of the rule in each member; by default the best of 2, 3 and 5 where the engine is installed, and 3 else.
    dt
        Step of the engine ("1/60 s").
    iterations
        Of the engine's solver.
    damping_ratio
        Of the rotation of each joint ("0.2", "5 %").
    """
    from calibration.output import OutputFolder
    from calibration.progress import explained_compilation
    from capacity.units import positive
    from scene import load_scene

    if engine not in _ENGINES:
        raise InputError("--engine", f'there is no "{engine}"', f"choose from {', '.join(_ENGINES)}")
    loaded = load_scene(scene)
    step, damping = positive(dt, "time", "--dt"), share(damping_ratio, "--damping-ratio")
    for option, value, least in (("--joints", joints, 2), ("--iterations", iterations, 1)):
        if value is not None and value < least:
            raise InputError(option, f"{value} is too few", f"write {least} or more")
    folder = OutputFolder.of_scene(scene, output)
    messages = Console(stderr=True)
    with explained_compilation(messages):
        import sim
    if rule not in sim.RULES:
        raise InputError("--rule", f'there is no "{rule}"', f"choose from {', '.join(sim.RULES)}")
    from calibration.engines.catalogue import ENGINES
    from calibration.engines.export import export as hand_over
    from calibration.engines.handover import LAW

    name = Path(scene).stem
    model = sim.Model(rule, joints or 2, LAW, dt=step, iterations=iterations)
    found = hand_over(loaded, name, engine, model, joints, damping)
    file = f"{name.replace('-', '_')}_{engine}{ENGINES[engine].suffix}"
    folder.write({file: found.text})
    if as_json:
        errors = {key: None if e is None else asdict(e) for key, e in
                  (("model_errors", found.model_errors), ("measured_errors", found.measured))}  # fmt: skip
        print(json.dumps({"scene": scene, "engine": engine, "file": file, "text": found.text, **errors,
                          "notes": list(found.notes)}))  # fmt: skip
    else:
        Console(highlight=False).print("\n".join(found.notes), markup=False, soft_wrap=True)
    folder.announce(messages)
    return 0
