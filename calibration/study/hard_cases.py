"""A hard case: a cantilever chain with a body at its tip, let down into its static sag.

Gravity grows until the chain must sag by a fixed share of its length, and is held. With x_i the joints, and M_i and Q_i
what gravity makes them bear, the chain's own exact answer for the tip is

    δ = Σ M_i (L - x_i) / k_i + Σ Q_i / k_Q,i .

The tip's mean while gravity is held is compared with it: wrong by the stiffness that a solver lost or added, or run
away. Nothing yields.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk

from calibration.study.points import HardPoint
from scene import Scene
from sim import DuctileJoint, ElasticPlastic

PIECES = 4
#: Share of the chain's length that it sags.
SAG = 1 / 200
#: Of the stock springs.
DAMPING_RATIO = 0.2
#: A tip further than this many sags from where it started has run away.
_FAR = 20.0
# Gravity grows over so many periods of the lowest vibration, and is then held for as many.
_PERIODS = 4.0
_FEWEST_STEPS, _MOST_STEPS = 120, 40_000
_NO_LIMIT = (math.inf, math.inf, math.inf)


def let_down(scene: Scene, point: HardPoint) -> dict[str, Any]:
    """Sag over the exact one, less one, as ``sag_error``; ``stable`` when the tip stayed near.

    The chain is `PIECES` equal pieces of the scene's first member.
    """
    name = next(iter(scene.members))
    member, c, length = scene.members[name], scene.capacity(name), scene.axis(name)[2]
    piece = length / PIECES
    mass = np.full(PIECES + 1, member.material.density * member.section.area * piece)
    mass[-1] *= point.mass_ratio
    centre = np.append((np.arange(PIECES) + 0.5) * piece, length)
    joint_at = np.arange(PIECES + 1) * piece
    share = np.full(PIECES + 1, piece)
    share[[0, -1]] *= 0.5
    stiffness = point.stiffness_factor * np.array([c.EA, c.GA_s, c.EI]) / share[:, None]

    arm = np.maximum(centre - joint_at[:, None], 0.0)
    rotation = arm @ mass / stiffness[:, 2]
    slip = (centre >= joint_at[:, None]) @ mass / stiffness[:, 1] * (point.kind == "ductile")
    gravity = SAG * length / float(rotation @ (length - joint_at) + slip.sum())
    # Rayleigh's quotient of the sag's own shape: ω² = g Σ m δ / Σ m δ².
    shape = gravity * (rotation @ arm)
    omega = math.sqrt(gravity * float(mass @ shape) / float(mass @ shape**2))

    space, tip = _chain(point, mass, centre, joint_at, stiffness)
    steps = int(np.clip(2.0 * _PERIODS * math.tau / (omega * point.dt), _FEWEST_STEPS, _MOST_STEPS))
    held = 0.0
    for i in range(steps):
        space.gravity = (0.0, -gravity * min(1.0, 2.0 * (i + 1) / steps))
        space.step(point.dt)
        sag = -tip.position.y
        if not abs(sag) < _FAR * SAG * length:
            return {"stable": False, "sag_error": None, "steps": i + 1}
        held += sag * (2 * i >= steps)
    return {"stable": True, "sag_error": held / (0.5 * steps) / (SAG * length) - 1.0, "steps": steps}


def _chain(
    point: HardPoint, mass: np.ndarray, centre: np.ndarray, joint_at: np.ndarray, stiffness: np.ndarray
) -> tuple[pymunk.Space, pymunk.Body]:
    """The chain in a space of its own, and the body at its tip."""
    space = pymunk.Space()
    space.iterations = point.iterations
    last = space.static_body
    for m, x, at, k in zip(mass.tolist(), centre.tolist(), joint_at.tolist(), stiffness.tolist(), strict=True):
        body = pymunk.Body(m, m * float(joint_at[1]) ** 2 / 12.0)
        body.position = (x, 0.0)
        space.add(body)
        if point.kind == "ductile":
            space.add(DuctileJoint(last, body, (at, 0.0), ElasticPlastic((k[0], k[1], k[2]), _NO_LIMIT), direction=0.0))
        else:
            space.add(pymunk.PivotJoint(last, body, (at, 0.0)))
            damping = 2.0 * DAMPING_RATIO * math.sqrt(k[2] * body.moment)
            spring = pymunk.DampedRotarySpring(last, body, 0.0, k[2], damping)
            space.add(pymunk.GearJoint(last, body, 0.0, 1.0) if point.kind == "gear" else spring)
        last = body
    return space, last
