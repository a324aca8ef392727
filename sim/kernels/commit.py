"""Plastic state, breaking, and what the joints bore.

A joint breaks when the plastic deformation of one kind (elongation, slip or rotation, each summed without sign) reaches
its limit p_lim. A step that would add Δp > p_lim - p breaks it within the step: its force is scaled by

    φ = (p_lim - p) / Δp,

so that the work done, φ s Δp, is what was left, s (p_lim - p), at any length of the step. φ and Δp are found together:
the structure is solved again with the new φ until it no longer changes.
"""

import numpy as np
from numba import njit

from sim.kernels.kinematics import rates
from sim.kernels.layout import (
    BETA,
    COMMIT_WORDS,
    DELTA,
    RESULT_DISSIPATED,
    RESULT_ELASTIC,
    RESULT_FORCE,
    RESULT_PLASTIC,
    RESULT_USED,
    RESULT_VISCOUS,
    STEP,
)
from sim.memory import call_law, floats


@njit(inline="always", error_model="numpy")
def used(limits, plastic, flow):  # type: ignore[no-untyped-def]
    """Largest share of a limit used after ``flow``, and the share of the flow that the limit leaves room for."""
    share, room = 0.0, 1.0
    for mode in range(3):
        limit = limits[mode]
        if mode == 0:
            before = plastic[0] + (plastic[1] if limits[3] != 0.0 else 0.0)
            added = abs(flow[0]) if flow[0] > 0.0 or limits[3] != 0.0 else 0.0
        else:
            before, added = plastic[mode + 1], abs(flow[mode])
        left = limit - before
        if added > 0.0:
            share = max(share, (before + added) / limit) if limit > 0.0 else 1.0
            if added >= left:
                room = min(room, max(left, 0.0) / added)
        elif limit > 0.0:
            share = max(share, before / limit)
    return share, room


@njit(error_model="numpy")
def weaken(  # type: ignore[no-untyped-def]
    n, joint_bodies, laws, limits, active, settings, jacobian, deformation, velocity, result, scratch, scale
):
    """Scale the forces of joints that would pass their limits; returns by how much any scale changed."""
    reach = settings[STEP] * (settings[BETA] + settings[DELTA])
    q, out = np.empty(3), np.empty(COMMIT_WORDS)
    change = 0.0
    for k in range(n):
        limit = limits[k]
        if active[k] == 0 or (limit[0] == np.inf and limit[1] == np.inf and limit[2] == np.inf):
            continue
        x, y, z = rates(jacobian, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        q[0], q[1], q[2] = (
            deformation[k, 0] + reach * x,
            deformation[k, 1] + reach * y,
            deformation[k, 2] + reach * z,
        )
        state = floats(laws[k, 3], laws[k, 4])
        for i in range(laws[k, 4]):
            scratch[i] = state[i]
        call_law(laws[k, 1], laws[k, 2], scratch.ctypes.data, q.ctypes.data, out.ctypes.data)
        _, room = used(limit, result[k, RESULT_PLASTIC:], out[2:])
        if room < 1.0 or scale[k] < 1.0:
            # Once a joint is about to break it stays so for this step, or it would flicker.
            new = min(room, 0.999999)
            change = max(change, abs(new - scale[k]))
            scale[k] = new
    return change


@njit(error_model="numpy")
def commit(  # type: ignore[no-untyped-def]
    n, joint_bodies, laws, limits, active, damping, settings, jacobian, deformation, velocity, impulse, scale, result
):
    """Let every law take over its plastic state at the step's final q*; returns how many joints broke."""
    h = settings[STEP]
    reach = h * (settings[BETA] + settings[DELTA])
    q, out = np.empty(3), np.empty(COMMIT_WORDS)
    broke = 0
    for k in range(n):
        r = result[k]
        if active[k] == 0:
            r[0:RESULT_PLASTIC] = 0.0
            r[RESULT_ELASTIC] = 0.0
            continue
        x, y, z = rates(jacobian, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        start, c = deformation[k], damping[k]
        q[0], q[1], q[2] = start[0] + reach * x, start[1] + reach * y, start[2] + reach * z
        for i in range(3):
            r[i] = q[i]
            r[RESULT_FORCE + i] = -impulse[k, i] / h
        call_law(laws[k, 1], laws[k, 2], laws[k, 3], q.ctypes.data, out.ctypes.data)
        share, room = used(limits[k], r[RESULT_PLASTIC:], out[2:])
        r[RESULT_VISCOUS] += h * (c[0] * x * x + c[1] * y * y + c[2] * z * z)
        r[RESULT_ELASTIC] = out[0]
        r[RESULT_DISSIPATED] += scale[k] * out[1]
        r[RESULT_USED] = min(share, 1.0)
        r[RESULT_PLASTIC + (0 if out[2] > 0.0 else 1)] += abs(out[2])
        r[RESULT_PLASTIC + 2] += abs(out[3])
        r[RESULT_PLASTIC + 3] += abs(out[4])
        if scale[k] < 1.0 or room < 1.0:
            # What was stored elastically is lost with the joint.
            r[RESULT_DISSIPATED] += out[0]
            r[RESULT_ELASTIC] = 0.0
            r[RESULT_USED] = 1.0
            active[k] = 0
            broke += 1
    return broke
