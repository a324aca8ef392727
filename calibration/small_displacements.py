"""Pushes in which displacements count as small.

The rigid bodies of a simulation turn by what they turn; equilibrium is where they have moved to. A reference of small
displacements leaves that out, and a model compared with it must leave out the same, or geometry would be taken for an
error of the joints. Where geometry has no part, a structure of yield stress ε fy under ε times its loads, settlements
and prescribed displacements answers with ε times the loads; and what geometry adds falls with ε. So the model is pushed
with all of them `SHARE` times as large, and its answer is enlarged again.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import msgspec
import numpy as np

from capacity import Material, StressStrain
from scene import Scene
from scene.quantities import Acceleration, Force, ForcePerLength, Length, Moment
from sim import Model, Push, push_over

#: ε: what geometry adds is this much smaller, and rounding, some 1e-12 of a deformation, still far smaller.
SHARE = 1e-3


def push_model(scene: Scene, model: Model, distances: np.ndarray) -> Push:
    """Push ``model`` through ``distances`` [m], with what geometry the scene's kinematics asks for."""
    return (push_over_small if scene.kinematics == "small" else push_over)(scene, model, distances)


def push_over_small(scene: Scene, model: Model, distances: np.ndarray) -> Push:
    """`sim.push_over` of ``scene`` in the limit of small displacements."""
    push = push_over(shrunk(scene, SHARE), model, SHARE * distances)
    return replace(
        push,
        displacement=push.displacement / SHARE,
        load=push.load / SHARE,
        load_at_distances=push.load_at_distances / SHARE,
        force=push.force / SHARE,
        dissipated=push.dissipated / SHARE**2,
    )


def shrunk(scene: Scene, share: float) -> Scene:
    """``scene`` with strengths, loads and prescribed displacements ``share`` times as large, and the same stiffness."""
    struct = msgspec.structs.replace
    return struct(
        scene,
        gravity=Acceleration(share * scene.gravity),
        nodes={
            name: struct(node, settlement=tuple(Length(share * s) for s in node.settlement))
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
            if load.kind == "dead"
            else load
            for load in scene.loads
        ),
        pushed=struct(
            scene.push,
            distance=Length(share * scene.push.distance),
            turning_points=tuple(Length(share * d) for d in scene.push.turning_points),
        ),
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
