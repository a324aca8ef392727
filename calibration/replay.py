"""The replay page: one HTML file that plays a recording, and needs nothing beside it."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

from jinja2 import Environment, PackageLoader, select_autoescape
from markupsafe import Markup

from calibration.replay_payload import ReferenceShape, payload
from sim.recorded import Recording

__all__ = ["ReferenceShape", "replay_page", "write_replay"]

# In the order in which they build on each other.
_SCRIPTS = (
    "units.js",
    "recording.js",
    "camera.js",
    "player.js",
    "palette.js",
    "stage.js",
    "forces.js",
    "plot.js",
    "joint_cards.js",
    "energy.js",
    "main.js",
)


def replay_page(recording: Recording, reference_shape: ReferenceShape | None = None) -> str:
    """HTML text of the page.

    Parameters
    ----------
    recording : Recording
    reference_shape : ReferenceShape, optional
        Shape of the finite-element reference, drawn over the bodies.
    """
    environment = Environment(loader=PackageLoader("calibration"), autoescape=select_autoescape())
    # Inside a script element only "</" could end the text early.
    content = json.dumps(payload(recording, reference_shape), separators=(",", ":"), allow_nan=False)
    return environment.get_template("replay.html").render(
        title=recording.title or "Replay",
        style=_part("style.css"),
        script=Markup("\n").join(map(_part, _SCRIPTS)),
        payload=Markup(content.replace("<", "\\u003c")),
    )


def write_replay(recording: Recording, path: Path, reference_shape: ReferenceShape | None = None) -> None:
    """Write the page of a recording to ``path``; see `replay_page`."""
    Path(path).write_text(replay_page(recording, reference_shape), encoding="utf-8")


def _part(name: str) -> Markup:
    text = resources.files("calibration").joinpath("templates", "replay", name).read_text(encoding="utf-8")
    return Markup(text)
