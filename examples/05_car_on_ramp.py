"""The car on the ramp with two joints: a ductile one, and one that counts as the original did.

    ductile:    M = clamp(k (θ - p)) + c ω;  p follows θ while the spring is at M_max.
    original:   M = clamp(k (θ - r) + c ω);  whenever that is at M_max, r is put to θ less the whole elastic rotation.

With the original's rule the damper helps to reach M_max, and the spring is then set to its full elastic rotation though
it had less: plastic rotation that never took place is counted, once when the ramp is let go and again at every jump.
"""

import math
import sys

import pymunk

from scene import builtin_text, parse_scene
from sim.world import World

INERTIA, FREQUENCY, RATIO, ELASTIC, LIMIT = 58320.0, 1.0, 0.2, 0.12, 0.4
STIFFNESS = (2.0 * math.pi * FREQUENCY) ** 2 * INERTIA
DAMPING = 2.0 * RATIO * 2.0 * math.pi * FREQUENCY * INERTIA
M_MAX = STIFFNESS * ELASTIC
OWN_WEIGHT, INERTIA_AT_JOINT = 2160.0 * 10.0 * 9.0, INERTIA + 2160.0 * 81.0


class OriginalJoint:
    """The original's joint in its own words, on a stock pivot: a soft constraint, solved by implicit Euler."""

    def __init__(self, world: World) -> None:
        self._ramp = world.bodies["ramp"]
        pivot = pymunk.PivotJoint(world.bodies["deck"], self._ramp, (60.0, 5.0))
        pivot.collide_bodies = False
        world.space.add(pivot)
        self._reference, self._at_limit, self.capacity_used = 0.0, 0.0, 0.0

    def act(self, dt: float) -> None:
        """Bear the ramp in the next step of ``dt`` [s], which begins with a move."""
        angle = self._ramp.angle + dt * self._ramp.angular_velocity
        if self._at_limit:
            reference = angle - math.copysign(ELASTIC, self._at_limit)
            self.capacity_used += abs(reference - self._reference) / LIMIT
            self._reference = reference
        free = self._ramp.angular_velocity + dt * OWN_WEIGHT * math.cos(angle) / INERTIA_AT_JOINT
        softness = DAMPING + dt * STIFFNESS
        moment = STIFFNESS * (angle - self._reference) + softness * free
        moment /= 1.0 + dt * softness / INERTIA_AT_JOINT
        self._at_limit = math.copysign(1.0, moment) if abs(moment) >= M_MAX else 0.0
        self._ramp.torque -= max(-M_MAX, min(M_MAX, moment))


def shares(dt: float, laps: int, original: bool) -> list[float]:
    """Shares of plastic capacity used by own weight and after each lap [%]."""
    text = builtin_text("car-on-ramp")
    if original:
        joint, car, measures = (text.index(key) for key in ("[joints.", "[vehicles.", "[measures."))
        text = text[:joint] + text[car:measures]
    world = World(parse_scene(text, "car-on-ramp"), dt, duration=20.0 * (laps + 1))
    bearing = OriginalJoint(world) if original else world.joints["ramp-joint"][0]
    found: list[float] = []
    passed = world.cars["car"].laps
    while (len(passed) < laps or not found) and not world.broken:
        if isinstance(bearing, OriginalJoint):
            bearing.act(dt)
        world.step()
        if len(found) < len(passed) + (world.time > 4.9):
            found.append(100.0 * bearing.capacity_used)
    return found


def main() -> float:
    """Share used by own weight under the original's rule, at 1/1000 s [%]."""
    return shares(1e-3, 0, original=True)[0]


if __name__ == "__main__":
    counts = [int(text) for text in sys.argv[1:]] or [60, 240, 1000, 4000]
    print("share of plastic capacity used by own weight, and after each lap [%]")
    for original in (False, True):
        for steps in counts:
            row = ", ".join(f"{share:.1f}" for share in shares(1.0 / steps, 4, original))
            print(f"{'original' if original else 'ductile':9} 1/{steps} s: {row}")
