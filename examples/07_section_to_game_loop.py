"""From a section to a beam that bends in a game: calibrate it, build it in a space of one's own, drop a crate on it.

What the crate brings is what the root's hinge takes, m g (h + θ a) = M_max θ, so θ = m g h / (M_max - m g a), less what
the blow itself and the beam's vibrations take.
"""

import pymunk

from calibration import calibrate
from scene import builtin_text, parse_scene
from sim import assemble


def main() -> float:
    """By how much the tip hangs when all is quiet [mm]."""
    text = builtin_text("cantilever").replace("rectangle 50x100 mm", "IPE 100")
    scene = parse_scene(text, "my beam")
    result = calibrate(scene, target_error=0.02)
    print(f"{result.best.push.joints} joints, within {100 * result.best.errors.path_max:.2g} % of the reference")

    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    beam = assemble(scene, result.best.model, space)
    crate = pymunk.Body(200.0, 200.0 * 0.3**2 / 6)
    crate.position = (0.85, 0.05 + 0.4 + 0.15)
    space.add(crate, pymunk.Poly.create_box(crate, (0.3, 0.3)))
    for shape in crate.shapes:
        shape.friction = 1.0

    for _frame in range(240):
        space.step(1 / 60)
    print(f"the root took {beam.joints[0].dissipated:.0f} J and bears {beam.joints[0].utilisation[2]:.0%} of M_max")
    return -1e3 * beam.nodes["tip"].now()[1]


if __name__ == "__main__":
    print(f"the tip hangs by {main():.0f} mm")
