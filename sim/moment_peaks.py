"""At which ends of a member its moments peak, as far as a scene says so before anything is solved."""

from scene import MemberEnd, Scene


def moment_peaks(scene: Scene, name: str) -> tuple[bool, bool]:
    """Whether the moments of a member peak at its start, and at its end: where an end is held against turning.

    The peak that a load along the member may have in its span is round, and wide beside those.
    """
    member = scene.members[name]
    return _held(scene, name, member.start, "from"), _held(scene, name, member.end, "to")


def _others(scene: Scene, name: str, node: str) -> list[bool]:
    """For each other member's end at ``node`` whether it is released."""
    return [
        end in other.releases
        for key, other in scene.members.items()
        for end, at in (("from", other.start), ("to", other.end))
        if key != name and at == node
    ]


def _held(scene: Scene, name: str, node: str, end: MemberEnd) -> bool:
    """Whether a support, another member, a spring or a load puts a moment on a member's end."""
    at = scene.nodes[node]
    if end in scene.members[name].releases:
        return False
    sprung = at.spring is not None and at.spring[2] > 0.0
    loaded = any(load.node == node and load.moment != 0.0 for load in scene.loads)
    return at.held[2] or sprung or loaded or not all(_others(scene, name, node))
