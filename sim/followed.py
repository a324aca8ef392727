"""What of a scene rigid bodies with joints do not follow, refused by its place."""

from capacity import InputError
from scene import Scene


def check_followed(scene: Scene) -> None:
    """Refuse what only the reference follows.

    Raises
    ------
    InputError
        When a member's material is a table of stresses, a node has a bearing, or a push is led by its load.
    """
    for name, member in scene.members.items():
        if member.material.curve is not None:
            cure = 'give the slope beyond yield instead, for example "Et=2 GPa"; `ductile reference` follows tables'
            raise InputError(f"members.{name}.material", "joints do not follow a table of stresses", cure)
    for name, node in scene.nodes.items():
        if node.bearing:
            cure = "give it a support or a spring; `ductile reference` follows bearings"
            raise InputError(f"nodes.{name}.bearing", "joints have no support that only pushes", cure)
    if scene.pushed is not None and scene.pushed.control != "displacement":
        cure = "leave it out; `ductile reference` follows load and arc-length control"
        raise InputError("push.control", f"joints are not pushed under {scene.pushed.control} control", cure)
