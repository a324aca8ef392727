"""Where a beam is not enough, by the reference's own word."""

import math

from fem_reference.plane.bodies import plane_fault
from scene import Scene

#: Length over depth up to which shear and clamps disturb the whole member.
SLENDER = 5.0
#: Rotations beyond which the kinematics of small displacements shift a load by more than its error.
SMALL_ROTATION = 0.05


def wants_plane_stress(scene: Scene) -> bool:
    """Whether the push of ``scene`` is followed as a plane stress continuum.

    It is when the scene asks for it or is a mesh, and, on ``"auto"``, when its one member is no longer than five depths
    and plane stress can follow it.
    """
    if scene.meshed is not None or scene.reference == "plane-stress":
        return True
    return scene.reference == "auto" and bool(_stocky(scene)) and plane_fault(scene) is None


def remarks(scene: Scene, moved: float = 0.0) -> tuple[str, ...]:
    """What to mind about beam theory and kinematics in ``scene``; empty when there is nothing.

    Parameters
    ----------
    scene : Scene
    moved : float
        How far its motion goes, where it has one and that is known [m].
    """
    done = "it is followed as" if wants_plane_stress(scene) else "beam theory is not enough there: it wants"
    found = [
        f"members.{name}: L/h = {ratio:.2g} is not above {SLENDER:g}; {done} a plane stress continuum"
        for name, ratio in _stocky(scene).items()
    ]
    way = {"push": max(map(abs, scene.pushed.stops()), default=0.0) if scene.pushed else 0.0, "motion": abs(moved)}
    for what, furthest in way.items():
        longest = max((scene.axis(name)[2] for name in scene.members), default=math.inf)
        if scene.kinematics == "small" and furthest > SMALL_ROTATION * longest:
            found.append(
                f'the {what} goes {furthest / longest:.2g} of a member\'s length; kinematics = "large" follows that'
            )
    return tuple(found)


def _stocky(scene: Scene) -> dict[str, float]:
    """Members that are no longer than `SLENDER` depths, with that ratio."""
    ratios = {name: scene.axis(name)[2] / member.section.depth for name, member in scene.members.items()}
    return {name: ratio for name, ratio in ratios.items() if ratio <= SLENDER * (1.0 + 1e-9)}
