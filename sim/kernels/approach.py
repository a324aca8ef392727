"""From the present velocities to a step's solution, by Newton's method (`newton`).

Few steps will do, mostly. They get nowhere where weak joints are stiff: the energy has a kink wherever one begins to
yield, each in the way of all others, or a joint flows one way and then the other and is never found at rest between.
Which of them yield is decided by their strength and by the bodies' inertia, though, and not by stiffness. So after some
steps all joints are made soft, resisting some times as much as their bodies' inertia, and stiffer again by and by. Soft
ones resist with a share a of their stiffness, from the place q̂ on where they would bear what they bore, elastically:

    s = law(q̂ + a (q* - q̂)).

When a solution with soft joints is found, q̂ goes to where they bear that. What they bear stays as it is then, while
they are made stiffer; what is left of q* - q̂ vanishes, and faster the stiffer they are. That is the method of
multipliers (M. J. D. Powell, M. R. Hestenes, 1969), the multipliers being the joints' forces.
"""

import math

import numpy as np

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import factorise_matrix
from sim.kernels.commit import copy
from sim.kernels.kinematics import rates
from sim.kernels.layout import COMMIT_WORDS, FLOW, SCRATCH_Q, SCRATCH_STATE, STEP
from sim.kernels.newton import measure, newton_step, predict, search
from sim.kernels.residual import motion_scale, reach_of
from sim.memory import call_law, floats, inlined, kernel

MOST_NEWTON_STEPS = 200
#: After so many steps in which nothing is found, joints are made soft, or it is seen what they bear.
_PATIENCE = 15
# After so many, a line search is to end nearer to a kink; so many that change little say that rounding remains.
_CAREFUL, _FEW = 8, 3
# How much rounding may be that remains: over the tolerance, and over what it is reckoned to be.
_REST, _ROUNDED = 1e6, 100.0
# Resistance of joints that are soft, over their bodies' inertia; by how much they are made stiffer after few steps, and
# after many.
_SOFT, _STIFFER, _LITTLE_STIFFER = 10.0, 30.0, 3.0


@inlined
def iterate(t, predicting):  # type: ignore[no-untyped-def]
    """Newton's method from the present velocities; returns steps taken, whether it converged, and the residual.

    The first solve of a step is ``predicting``. The residual is finite if impulses and velocities are.
    """
    settings = views.settings(t)
    factor, tolerance, steps = settings[STEP] * reach_of(t), settings[at.TOLERANCE], 0
    if predicting:
        error, size, spring, motion = predict(t, factor, tolerance)
        steps = 1
    else:
        error, size, spring = measure(t)
        motion = motion_scale(t)
    converged = error <= enough(settings, size, motion)
    if not converged:
        taken, converged, error, size, spring = approach(t, factor, error, size, spring, motion)
        steps += taken
        if not converged:
            taken, converged, error, size = soften(t, factor, error, motion)
            steps += taken
        motion = motion_scale(t)
    total = size + motion + settings[at.ROUNDING] / tolerance
    return steps, converged, math.sqrt(error / total) if 0.0 < total < math.inf else total


@inlined
def enough(settings, size, motion):  # type: ignore[no-untyped-def]
    """How large the energy of the residuals may be."""
    return settings[at.TOLERANCE] * (size + motion) + settings[at.ROUNDING]


@kernel
def approach(t, factor, error, size, spring, motion):  # type: ignore[no-untyped-def]
    """Newton's steps from what `measure` has found; returns how many, whether they converged, and what it finds."""
    settings, steps, best = views.settings(t), 0, error
    converged = error <= enough(settings, size, motion)
    while not converged and steps < _PATIENCE and math.isfinite(error):
        steps += 1
        factorise_matrix(t, factor)
        start, change = newton_step(t, factor, spring)
        error, size, spring, gone = search(t, factor, start, change, settings[at.TOLERANCE], motion, steps > _CAREFUL)
        # Below this it is rounding that remains, and another step would not take it away; one that was cut short says
        # so only when many have been taken.
        most = _FEW if gone == 1.0 else _PATIENCE - 1
        rest = _REST * settings[at.TOLERANCE] * (size + motion) + _ROUNDED * settings[at.ROUNDING]
        little = steps > most and error >= 0.25 * best and error <= rest
        converged = little or error <= enough(settings, size, motion)
        best = min(best, error)
    return steps, converged, error, size, spring


@kernel
def soften(t, factor, error, motion):  # type: ignore[no-untyped-def]
    """Find the solution by joints that are soft, and stiffer by and by; returns the same but for the spring.

    Where nothing better is found than what there is, with its ``error``, that stays.
    """
    settings, result, impulse = views.settings(t), views.result(t), views.per_joint(t, at.IMPULSE)
    velocity, pull, steps = views.per_body(t, at.VELOCITY), settings[at.SPREAD_IMPULSE], 0
    ended, borne, moved = np.empty((t[at.JOINTS], 3)), np.empty((t[at.JOINTS], 3)), np.empty((t[at.MOVING], 3))
    for i in range(3):
        for k in range(t[at.JOINTS]):
            ended[k, i], borne[k, i] = result[k, i], impulse[k, i]
        for k in range(t[at.MOVING]):
            moved[k, i] = velocity[k, i]
    share, before = softness(t, factor), error
    while True:
        error, size, spring = resist(t, share)
        taken, converged, error, size, spring = approach(t, factor, error, size, spring, motion)
        steps += taken
        error, size, spring = resist(t, 1.0)
        found = error <= enough(settings, size, motion) or (converged and share == 1.0)
        if found or steps >= MOST_NEWTON_STEPS or not math.isfinite(error):
            break
        note_borne(t, share)
        if converged:
            share = min(share * (_STIFFER if taken <= _CAREFUL else _LITTLE_STIFFER), 1.0)
    for k in range(t[at.JOINTS]):
        for i in range(3):
            result[k, i] = ended[k, i]
    if not (found or error < before):
        settings[at.SPREAD_IMPULSE] = pull
        for i in range(3):
            for k in range(t[at.JOINTS]):
                impulse[k, i] = borne[k, i]
            for k in range(t[at.MOVING]):
                velocity[k, i] = moved[k, i]
        error, size, spring = measure(t)
    return steps, found, error, size


@kernel
def softness(t, factor):  # type: ignore[no-untyped-def]
    """Share of their stiffness at which joints resist no more than some times as much as their bodies' inertia."""
    lightness, stiffness, most = views.per_joint(t, at.LIGHTNESS), views.stiffness(t), 0.0
    for k in range(t[at.JOINTS]):
        for i, word in ((0, 0), (1, 3), (2, 5)):
            most = max(most, factor * stiffness[k, word] * lightness[k, i])
    return min(_SOFT / most, 1.0) if most > 0.0 else 1.0


@kernel
def resist(t, share):  # type: ignore[no-untyped-def]
    """Have all joints resist with a ``share`` of their stiffness; returns what `measure` finds then."""
    views.settings(t)[at.SOFT] = share
    return measure(t)


@kernel
def note_borne(t, share):  # type: ignore[no-untyped-def]
    """Let joints that resist with a ``share`` of their stiffness do so from where they would bear it elastically."""
    joint_bodies, laws, result = views.joint_bodies(t), views.laws(t), views.result(t)
    gradient, deformation = views.gradient(t), views.per_joint(t, at.DEFORMATION)
    velocity, reach = views.per_body(t, at.VELOCITY), reach_of(t)
    q, trial = t[at.SCRATCH] + 8 * SCRATCH_Q, t[at.SCRATCH] + 8 * SCRATCH_STATE
    out, place = floats(t[at.SCRATCH], COMMIT_WORDS), floats(q, 3)
    for k in range(t[at.JOINTS]):
        x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        place[0] = result[k, 0] + share * (deformation[k, 0] + reach * x - result[k, 0])
        place[1] = result[k, 1] + share * (deformation[k, 1] + reach * y - result[k, 1])
        place[2] = result[k, 2] + share * (deformation[k, 2] + reach * z - result[k, 2])
        copy(laws[k, 3], trial, laws[k, 4])
        call_law(laws[k, 1], laws[k, 2], trial, q, t[at.SCRATCH])
        for i in range(3):
            result[k, i] = place[i] - out[FLOW + i]
