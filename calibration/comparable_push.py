"""Pushes of a model that leave out what its reference leaves out.

Geometry. The rigid bodies of a simulation turn by what they turn; equilibrium is where they have moved to. A reference
of small displacements knows nothing of that, one of P–Δ only that axial forces turn with the chords, and a model must
leave out the same, or geometry would be taken for an error of the joints. Where geometry has no part, a structure of
yield stress ε fy under ε times its loads, settlements and prescribed displacements answers with ε times the loads; and
what geometry adds falls with ε. So the model is pushed with all of them `SHARE` times as large, and its answer is
enlarged again. Of the moments of P–Δ, forces times rotations, which come out ε² times as large, P–Δ wants 1/ε times as
much and small displacements want nothing; `sim.second_order` sees to the difference.

Shear. Beams of the reference do not yield in shear, so the joints pushed beside them do not either.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import msgspec
import numpy as np

from capacity import Material, StressStrain
from fem_reference import wants_plane_stress
from scene import Scene
from scene.quantities import Acceleration, Force, ForcePerLength, Length, Moment, Speed
from sim import PACE, Model, Pace, Push, push_over

#: ε: what geometry adds is this much smaller, and rounding, some 1e-12 of a deformation, still far smaller.
SHARE = 1e-3
# By kinematics: how many times more of the second-order moments is wanted.
_SECOND_ORDER = {"small": -1.0, "p-delta": 1.0 / SHARE - 1.0}


def push_model(scene: Scene, model: Model, distances: np.ndarray, pace: Pace = PACE) -> Push:
    """Push ``model`` through ``distances`` [m] as the reference of ``scene`` is pushed."""
    model = replace(model, shear_yields=model.shear_yields and wants_plane_stress(scene))
    if scene.kinematics == "large":
        return push_over(scene, model, distances, pace=pace)
    more = _SECOND_ORDER[scene.kinematics]
    push = push_over(shrunk(scene, SHARE), model, SHARE * distances, second_order=more, pace=pace)
    return replace(
        push,
        displacement=push.displacement / SHARE,
        load=push.load / SHARE,
        load_at_distances=push.load_at_distances / SHARE,
        force=push.force / SHARE,
        dissipated=push.dissipated / SHARE**2,
    )


def shrunk(scene: Scene, share: float) -> Scene:
    """``scene`` with strengths, loads, prescribed displacements and velocities ``share`` times as large.

    Stiffness and mass stay. Proportional loads stay, too: their factor follows the push.
    """
    struct = msgspec.structs.replace
    return struct(
        scene,
        gravity=Acceleration(share * scene.gravity),
        nodes={
            name: struct(
                node,
                settlement=tuple(Length(share * s) for s in node.settlement),
                velocity=tuple(Speed(share * v) for v in node.velocity),
            )
            for name, node in scene.nodes.items()
        },
        members={
            name: struct(member, material=_weaker(member.material, share)) for name, member in scene.members.items()
        },
        loads=tuple(
            struct(
                load,
                force=tuple(Force(share * f) for f in load.force),
                moment=Moment(share * load.moment),
                per_length=tuple(ForcePerLength(share * q) for q in load.per_length),
            )
            if load.kind in ("dead", "step")
            else load
            for load in scene.loads
        ),
        pushed=scene.pushed
        and struct(
            scene.pushed,
            distance=Length(share * scene.pushed.distance),
            turning_points=tuple(Length(share * d) for d in scene.pushed.turning_points),
        ),
        motion=scene.motion and struct(scene.motion, velocity=tuple(Speed(share * v) for v in scene.motion.velocity)),
    )


@cache
def _weaker(material: Material, share: float) -> Material:
    """``material`` with stresses and strains beyond the elastic line ``share`` times as large; the same each time."""
    curve = material.curve
    return Material(
        material.name,
        material.youngs_modulus,
        share * material.yield_stress,
        material.density,
        material.poissons_ratio,
        material.tangent_modulus,
        share * material.ultimate_strain,
        None if curve is None else StressStrain(share * curve.breaks, curve.slopes, share * curve.ultimate_strain),
    )
