"""What of a scene rigid bodies with joints do not follow, refused by its place."""

from capacity import InputError
from scene import Scene


def check_followed(scene: Scene) -> None:
    """Refuse what only the reference follows.

    Raises
    ------
    InputError
        When a push is led by its load, or a member is of several materials.
    """
    for name, member in scene.members.items():
        if member.section.has_own_materials:
            cure = "use a section of one material; `ductile reference` follows this one"
            raise InputError(f"members.{name}.section", "joints are of one material", cure)
    if scene.pushed is not None and scene.pushed.control != "displacement":
        cure = "leave it out; `ductile reference` follows load and arc-length control"
        raise InputError("push.control", f"joints are not pushed under {scene.pushed.control} control", cure)
