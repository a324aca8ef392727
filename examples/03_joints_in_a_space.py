"""Ductile joints in a pymunk space of one's own: a shelf bracket that an overload bends for good.

The joint at the wall yields at M_max; what the load gives beyond that goes into plastic rotation, and stays:

    θ_plastic > 0 when m g L > M_max.
"""

import pymunk

from capacity import capacity, parse_material, parse_section
from sim import DuctileJoint, ElasticPlastic


def main() -> float:
    """Rotation that stays when the load is gone [rad]."""
    bar = capacity(parse_section("rectangle 20x10 mm"), parse_material("S235"))
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)

    shelf = pymunk.Body(mass=0.5, moment=0.5 * 0.4**2 / 12)
    shelf.position = (0.2, 1.0)
    space.add(shelf)

    length = 0.05  # of the bar that bends at the wall
    law = ElasticPlastic(
        stiffness=(bar.EA / length, bar.GA_s / length, bar.EI / length),
        capacity=(bar.N_max, bar.Q_max, bar.M_max),
    )
    space.add(DuctileJoint(space.static_body, shelf, (0.0, 1.0), law))

    for step in range(180):
        if 60 <= step < 62:  # somebody jumps on it
            shelf.apply_force_at_world_point((0.0, -360.0), shelf.local_to_world((0.2, 0.0)))
        space.step(1 / 60)
    return shelf.angle


if __name__ == "__main__":
    print(f"the shelf hangs at {main():.3f} rad")
