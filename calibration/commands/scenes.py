"""``ductile scenes``: the scenes that come with it."""

from __future__ import annotations

import sys


def scenes(name: str | None = None, /) -> int:
    """List the scenes that come with it, or write one out to edit: ductile scenes cantilever > my.toml

    Parameters
    ----------
    name
        A built-in scene.
    """
    import scene as package

    if name is not None:
        sys.stdout.write(package.builtin_text(name))
        return 0
    for builtin in package.builtin_names():
        print(f"{builtin:20} {package.load_scene(builtin).title}")
    return 0
