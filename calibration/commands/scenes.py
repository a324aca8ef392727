"""``ductile scenes``: the scenes that come with it."""

from __future__ import annotations

import json
import sys
from typing import Annotated

from cyclopts import Parameter


def scenes(
    name: str | None = None, /, *, schema: Annotated[bool, Parameter(name="--schema", negative=())] = False
) -> int:
    """List the scenes that come with it, or write one out to edit: ductile scenes cantilever > my.toml

    Parameters
    ----------
    name
        A built-in scene.
    schema
        Print the JSON schema of scene files, for editors that check them.
    """
    import scene as package

    if schema:
        print(json.dumps(package.json_schema(), indent=1))
        return 0
    if name is not None:
        sys.stdout.write(package.builtin_text(name))
        return 0
    for builtin in package.builtin_names():
        print(f"{builtin:20} {package.load_scene(builtin).title}")
    return 0
