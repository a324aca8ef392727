"""Where a beam is not enough, by the reference's own word."""

from scene import Scene

#: Length over depth below which shear and clamps disturb the whole member.
SLENDER = 5.0
#: Rotations beyond which the kinematics of small displacements shift a load by more than its error.
SMALL_ROTATION = 0.05


def remarks(scene: Scene) -> tuple[str, ...]:
    """What to mind about beam theory and kinematics in ``scene``; empty when there is nothing."""
    found = []
    for name, member in scene.members.items():
        ratio = scene.axis(name)[2] / member.section.depth
        if ratio < SLENDER:
            found.append(
                f"members.{name}: L/h = {ratio:.2g} is below {SLENDER:g}; a plane stress continuum is wanted there"
            )
    if scene.pushed is not None and scene.kinematics == "small":
        furthest = max(map(abs, scene.pushed.stops()))
        longest = max(scene.axis(name)[2] for name in scene.members)
        if furthest > SMALL_ROTATION * longest:
            found.append(
                f'the push goes {furthest / longest:.2g} of a member\'s length; kinematics = "large" follows that'
            )
    return tuple(found)
