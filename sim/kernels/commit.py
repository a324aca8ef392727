"""Plastic state, breaking, and what the joints bore.

A joint breaks when the plastic deformation of one kind (elongation, slip or rotation, each summed without sign) reaches
its limit p_lim. A step that would add Δp > p_lim - p breaks it within the step: its force is scaled by

    φ = (p_lim - p) / Δp,

so that the work done, φ s Δp, is what was left, s (p_lim - p), at any length of the step. φ and Δp are found together:
the structure is solved again with the new φ until it no longer changes.

In implicit Euler q* is where the step ends. In the average-acceleration rule it lies halfway through the step, from
q_n - ½ h q̇₀ to q_n + ½ h q̇₁, and so does the plastic flow that the law finds there (the midpoint rule of J. C. Simo,
T. J. R. Hughes, Computational Inelasticity, section 1.4.3). The whole step's is twice that, and the state goes twice
the way: what a law keeps as state has to be plastic strains, or anything else that grows evenly along a step. The work
done is then stored and dissipated without remainder, at any length of the step.
"""

import numpy as np

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.energy import work_of_shifts, work_on_held
from sim.kernels.kinematics import lag_of, rates
from sim.kernels.layout import (
    BETA,
    COMMIT_WORDS,
    DELTA,
    LEDGER_CONTACT,
    LEDGER_ELASTIC,
    LEDGER_EXTERNAL,
    LEDGER_NUMERICAL,
    LEDGER_PLASTIC,
    LEDGER_TO_COME,
    LEDGER_VISCOUS,
    RESULT_BEFORE,
    RESULT_DISSIPATED,
    RESULT_ELASTIC,
    RESULT_FORCE,
    RESULT_PLASTIC,
    RESULT_USED,
    RESULT_VISCOUS,
    STEP,
)
from sim.kernels.residual import reach_of
from sim.memory import call_law, floats, kernel


@kernel
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


@kernel
def flow_share(t):  # type: ignore[no-untyped-def]
    """How much of a step's plastic flow there is for what the law finds at q*."""
    settings = views.settings(t)
    return 1.0 if settings[BETA] == 0.0 else 1.0 / (0.5 + settings[DELTA])


@kernel
def weaken(t):  # type: ignore[no-untyped-def]
    """Scale the forces of joints that would pass their limits; returns by how much any scale changed."""
    joint_bodies, laws, limits = views.joint_bodies(t), views.laws(t), views.limits(t)
    active, gradient, deformation = views.active(t), views.gradient(t), views.per_joint(t, at.DEFORMATION)
    velocity, result, scale = views.per_body(t, at.VELOCITY), views.result(t), views.scale(t)
    reach, whole = reach_of(t), flow_share(t)
    q, out = np.empty(3), np.empty(COMMIT_WORDS)
    change = 0.0
    for k in range(t[at.JOINTS]):
        limit = limits[k]
        if active[k] == 0 or (limit[0] == np.inf and limit[1] == np.inf and limit[2] == np.inf):
            continue
        x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        q[0], q[1], q[2] = (
            deformation[k, 0] + reach * x,
            deformation[k, 1] + reach * y,
            deformation[k, 2] + reach * z,
        )
        state, scratch = floats(laws[k, 3], laws[k, 4]), floats(t[at.SCRATCH], laws[k, 4])
        for i in range(laws[k, 4]):
            scratch[i] = state[i]
        call_law(laws[k, 1], laws[k, 2], t[at.SCRATCH], q.ctypes.data, out.ctypes.data)
        _, room = used(limit, result[k, RESULT_PLASTIC:], whole * out[2:])
        if room < 1.0 or scale[k] < 1.0:
            # Once a joint is about to break it stays so for this step, or it would flicker.
            new = min(room, 0.999999)
            change = max(change, abs(new - scale[k]))
            scale[k] = new
    return change


@kernel
def commit(t):  # type: ignore[no-untyped-def]
    """Let every law take over its plastic state at the step's final q*, and book the joints' energies.

    Returns how many joints broke.
    """
    joint_bodies, laws, limits = views.joint_bodies(t), views.laws(t), views.limits(t)
    active, damping, gradient = views.active(t), views.damping(t), views.gradient(t)
    deformation, impulse = views.per_joint(t, at.DEFORMATION), views.per_joint(t, at.IMPULSE)
    start, velocity = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.WRITTEN)
    last = views.per_body(t, at.LAST_VELOCITY)
    scale, result, settings = views.scale(t), views.result(t), views.settings(t)
    ledger, moving = views.ledger(t), t[at.MOVING]
    h, reach, whole = settings[STEP], reach_of(t), flow_share(t)
    q, out = np.empty(3), np.empty(COMMIT_WORDS)
    broke, flowing = 0, 0.0
    external, elastic, contact, viscous, numerical = 0.0, 0.0, 0.0, 0.0, 0.0
    plastic, to_come = ledger[LEDGER_TO_COME], 0.0
    for k in range(t[at.JOINTS]):
        r = result[k]
        if active[k] == 0:
            # Let go by hand: what it stored goes with it.
            external -= 0.5 * (r[RESULT_BEFORE] + r[RESULT_ELASTIC])
            r[0:RESULT_PLASTIC] = 0.0
            r[RESULT_BEFORE], r[RESULT_ELASTIC] = 0.0, 0.0
            continue
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        x, y, z = rates(gradient, k, velocity, ia, velocity, ib)
        x0, y0, z0 = rates(gradient, k, start, ia, start, ib)
        d, c = deformation[k], damping[k]
        q[0], q[1], q[2] = d[0] + reach * x, d[1] + reach * y, d[2] + reach * z
        for i in range(3):
            r[i] = q[i]
            r[RESULT_FORCE + i] = -impulse[k, i] / h
        state, old = floats(laws[k, 3], laws[k, 4]), floats(t[at.SCRATCH], laws[k, 4])
        if whole != 1.0:
            for i in range(laws[k, 4]):
                old[i] = state[i]
        call_law(laws[k, 1], laws[k, 2], laws[k, 3], q.ctypes.data, out.ctypes.data)
        if whole != 1.0:
            for i in range(laws[k, 4]):
                state[i] = old[i] + whole * (state[i] - old[i])
            for i in range(1, COMMIT_WORDS):
                out[i] *= whole
        share, room = used(limits[k], r[RESULT_PLASTIC:], out[2:])
        at_end, lost, second_half = out[0], scale[k] * out[1], 0.5 * scale[k] * out[1]
        if settings[BETA] != 0.0:
            xl, yl, zl = rates(gradient, k, last, ia, last, ib)
            at_end += half_a_step_on(t, k, xl, yl, zl, x, y, z, (1.0 - 1.0 / whole) * out[2:])
            second_half = 0.0
        x, y, z = 0.5 * (x0 + x), 0.5 * (y0 + y), 0.5 * (z0 + z)
        damped = h * (c[0] * x * x + c[1] * y * y + c[2] * z * z)
        given = 0.5 * (r[RESULT_BEFORE] + r[RESULT_ELASTIC]) - damped
        given -= impulse[k, 0] * x + impulse[k, 1] * y + impulse[k, 2] * z
        if ia >= moving or ib >= moving:
            external -= work_on_held(t, k, velocity, start)
        if t[at.SHIFTED] == 1:
            by_contacts, by_hand = work_of_shifts(t, k, 0), work_of_shifts(t, k, 3)
            if by_contacts + by_hand < -r[RESULT_ELASTIC]:
                # No more can be released than is stored.
                less = -r[RESULT_ELASTIC] / (by_contacts + by_hand)
                by_contacts, by_hand = less * by_contacts, less * by_hand
            contact -= by_contacts
            external += by_hand
            given += by_contacts + by_hand
            r[RESULT_ELASTIC] += by_contacts + by_hand
        at_start = r[RESULT_ELASTIC] if settings[BETA] == 0.0 else at_end
        r[RESULT_USED] = min(share, 1.0)
        r[RESULT_PLASTIC + (0 if out[2] > 0.0 else 1)] += abs(out[2])
        r[RESULT_PLASTIC + 2] += abs(out[3])
        r[RESULT_PLASTIC + 3] += abs(out[4])
        if scale[k] < 1.0 or room < 1.0:
            # What was stored elastically, and what the joint still took of the step's share, is lost with it.
            lost += r[RESULT_ELASTIC] + scale[k] * (at_end - r[RESULT_ELASTIC])
            at_start, at_end, second_half = 0.0, 0.0, 0.0
            r[RESULT_USED] = 1.0
            active[k] = 0
            broke += 1
        stored = 0.5 * (at_start + at_end)
        r[RESULT_BEFORE], r[RESULT_ELASTIC] = at_start, at_end
        r[RESULT_DISSIPATED] += lost
        r[RESULT_VISCOUS] += damped
        flowing += abs(out[2]) + abs(out[3]) + abs(out[4])
        elastic += stored
        plastic += lost - second_half
        to_come += second_half
        viscous += damped
        numerical += given - stored
    t[at.FLOWING] = 1 if flowing > 0.0 else 0
    ledger[LEDGER_EXTERNAL] += external
    ledger[LEDGER_ELASTIC] = elastic
    ledger[LEDGER_PLASTIC] += plastic
    ledger[LEDGER_TO_COME] = to_come
    ledger[LEDGER_CONTACT] += contact
    ledger[LEDGER_VISCOUS] += viscous
    ledger[LEDGER_NUMERICAL] += numerical - plastic
    return broke


@kernel
def half_a_step_on(t, k, x0, y0, z0, x, y, z, flow):  # type: ignore[no-untyped-def]
    """Elastic energy of joint k half a step after its position, where the velocities are, less that at q*.

    That is s·dq + ½ dq·K dq for dq = q_n + ½ h q̇₁ - q* less the plastic ``flow`` after q*, with its rates of
    deformation q̇₀ and q̇₁ before and after the step.
    """
    damping, settings, response, stiffness = views.damping(t), views.settings(t), views.response(t), views.stiffness(t)
    h, s, stiff = settings[STEP], response[k], stiffness[k]
    lag, lead = lag_of(settings), 0.5 * h - reach_of(t)
    u, v, turn = lag * x0 + lead * x - flow[0], lag * y0 + lead * y - flow[1], lag * z0 + lead * z - flow[2]
    linear = (s[0] - damping[k, 0] * x) * u + (s[1] - damping[k, 1] * y) * v + (s[2] - damping[k, 2] * z) * turn
    square = stiff[0] * u * u + stiff[3] * v * v + stiff[5] * turn * turn
    mixed = stiff[1] * u * v + stiff[2] * u * turn + stiff[4] * v * turn
    return linear + 0.5 * square + mixed
