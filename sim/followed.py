"""What of a scene rigid bodies with joints do not follow, refused by its place."""

from capacity import InputError
from scene import Scene


def check_followed(scene: Scene) -> None:
    """Refuse what only the reference follows.

    Raises
    ------
    InputError
        When a push is led by its load.
    """
    if scene.pushed is not None and scene.pushed.control != "displacement":
        cure = "leave it out; `ductile reference` follows load and arc-length control"
        raise InputError("push.control", f"joints are not pushed under {scene.pushed.control} control", cure)
