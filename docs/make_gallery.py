"""Run the scenes that come with it and make docs/gallery.md from them: a picture and the key figures of each.

    python docs/make_gallery.py [NAME …]

With names, only those pictures are made again, and only their parts of the page.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from calibration.moving_picture import write_still
from calibration.run_pictures import Camera
from calibration.simulate_command import as_object, key_figures, run
from scene import builtin_names, load_scene
from sim.recorded import Recording
from sim.world import World

PAGE = Path(__file__).parent / "gallery.md"
PICTURES = Path(__file__).parent / "images" / "gallery"
HEAD = """# Gallery

Every scene that comes with it, as `ductile simulate NAME` runs it. Joints are coloured by utilisation, pale to red; a
cross marks a broken one. The replay that each run leaves shows the rest: forces, curves, energies
([replay.md](replay.md)).

Made by `python docs/make_gallery.py`.
"""
# Moments worth a look [s]; others are shown at their end.
MOMENTS = {
    "bridge": 15.5,
    "car-on-ramp": 11.0,
    "charpy": 0.004,
    "demolisher": 25.5,
    "gate": 11.0,
    "multifloor-frame": 0.2,
    "post-impact": 0.08,
}


def part(name: str) -> str:
    """The scene's part of the page; its picture is written."""
    scene = load_scene(name)
    world = World(scene)
    camera = Camera(world)
    seconds = run(world, camera.note, lambda what, share: None)
    recording = camera.recording()
    write_still(recording, moment(recording, MOMENTS.get(name)), PICTURES / f"{name}.png")
    figures = "\n".join(
        f"| {what} | {value} |" for what, value in key_figures(as_object(world, name, seconds, recording))
    )
    return f"## {name}\n\n{scene.title}.\n\n![{name}](images/gallery/{name}.png)\n\n| | |\n|---|---|\n{figures}\n"


def moment(recording: Recording, time: float | None) -> int:
    """The sample at ``time``, or the last one."""
    if time is None:
        return len(recording.time) - 1
    return int(abs(recording.time - time).argmin())


def parts_of(page: str) -> dict[str, str]:
    """The parts of a page by name."""
    pieces = re.split(r"^## (.+)\n", page, flags=re.MULTILINE)
    return {name: f"## {name}\n{text.rstrip()}\n" for name, text in zip(pieces[1::2], pieces[2::2], strict=True)}


def main(names: list[str]) -> None:
    """Make the parts called ``names``, or all."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    parts = parts_of(PAGE.read_text(encoding="utf-8")) if PAGE.exists() else {}
    for name in names or builtin_names():
        print(name, file=sys.stderr)
        parts[name] = part(name)
    kept = [parts[name] for name in builtin_names() if name in parts]
    PAGE.write_text("\n".join([HEAD, *kept]), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
