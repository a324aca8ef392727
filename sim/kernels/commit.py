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
from sim.kernels.halfway import go_all_the_way, half_a_step_on, take_back
from sim.kernels.kinematics import lag_of, let_go, rates
from sim.kernels.layout import (
    BETA,
    BLOW,
    COMMIT_WORDS,
    DELTA,
    FLOW,
    LEDGER_CONTACT,
    LEDGER_ELASTIC,
    LEDGER_EXTERNAL,
    LEDGER_KINETIC,
    LEDGER_NUMERICAL,
    LEDGER_PLASTIC,
    LEDGER_TO_COME,
    LEDGER_VISCOUS,
    RESULT_BEFORE,
    RESULT_DISSIPATED,
    RESULT_ELASTIC,
    RESULT_FORCE,
    RESULT_PLASTIC,
    RESULT_Q,
    RESULT_USED,
    RESULT_VISCOUS,
    RESULT_WORDS,
    SCRATCH_Q,
    SCRATCH_STATE,
    STEP,
    WANTED_BETA,
)
from sim.kernels.residual import reach_of
from sim.memory import call_law, floats, inlined, kernel

# Of a structure's energy.
_OVERRATED = 0.02


@kernel
def used(limits, result, whole, out):  # type: ignore[no-untyped-def]
    """Largest share of a limit used after ``whole`` times a law's flow, and the share of that there is room for."""
    share, room = 0.0, 1.0
    for mode in range(3):
        limit, before, added = limits[mode], result[RESULT_PLASTIC + 1 + mode], whole * abs(out[FLOW + mode])
        if limit == np.inf:
            continue
        if mode == 0:
            before = result[RESULT_PLASTIC] + (before if limits[3] != 0.0 else 0.0)
            added = added if out[FLOW] > 0.0 or limits[3] != 0.0 else 0.0
        left = limit - before
        if added > 0.0:
            share = max(share, (before + added) / limit) if limit > 0.0 else 1.0
            if added >= left:
                room = min(room, max(left, 0.0) / added)
        elif limit > 0.0:
            share = max(share, before / limit)
    return share, room


@inlined
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
    q, trial = t[at.SCRATCH] + 8 * SCRATCH_Q, t[at.SCRATCH] + 8 * SCRATCH_STATE
    out, place = floats(t[at.SCRATCH], COMMIT_WORDS), floats(q, 3)
    reach, whole, change = reach_of(t), flow_share(t), 0.0
    for k in range(t[at.JOINTS]):
        limit = limits[k]
        if active[k] == 0 or (limit[0] == np.inf and limit[1] == np.inf and limit[2] == np.inf):
            continue
        x, y, z = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        place[0], place[1] = deformation[k, 0] + reach * x, deformation[k, 1] + reach * y
        place[2] = deformation[k, 2] + reach * z
        copy(laws[k, 3], trial, laws[k, 4])
        call_law(laws[k, 1], laws[k, 2], trial, q, t[at.SCRATCH])
        _, room = used(limit, result[k], whole, out)
        if room < 1.0 or scale[k] < 1.0:
            # Once a joint is about to break it stays so for this step, or it would flicker.
            new = min(room, 0.999999)
            change = max(change, abs(new - scale[k]))
            scale[k] = new
    return change


@inlined
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
    lag, lead = lag_of(settings), 0.5 * h - reach
    stiff = t[at.DAMPED] == 1 and is_stiff(t, start, velocity)
    averages = settings[WANTED_BETA] != 0.0 or settings[BLOW] > 0.0
    out, old = floats(t[at.SCRATCH], COMMIT_WORDS), t[at.SCRATCH] + 8 * SCRATCH_STATE
    broke, flows, breakable = 0, False, t[at.BREAKABLE] == 1
    external, elastic, contact, viscous, numerical = 0.0, 0.0, 0.0, 0.0, 0.0
    ahead = views.per_joint(t, at.SLOPE)
    plastic, to_come = ledger[LEDGER_TO_COME], 0.0
    for k in range(t[at.JOINTS]):
        r = result[k]
        if active[k] == 0:
            # Let go by hand: what it stored goes with it.
            external -= 0.5 * (r[RESULT_BEFORE] + r[RESULT_ELASTIC])
            if r[RESULT_USED] < 1.0 or t[at.BROKE] == 0:
                # What broke in a part of this step is still seen.
                for i in range(RESULT_Q, RESULT_ELASTIC):
                    r[i] = 0.0
            r[RESULT_ELASTIC], r[RESULT_BEFORE] = 0.0, 0.0
            continue
        ia, ib = joint_bodies[k, 0], joint_bodies[k, 1]
        x, y, z = rates(gradient, k, velocity, ia, velocity, ib)
        x0, y0, z0 = rates(gradient, k, start, ia, start, ib)
        d, c = deformation[k], damping[k]
        r[0], r[1], r[2] = d[0] + reach * x, d[1] + reach * y, d[2] + reach * z
        for i in range(3):
            r[RESULT_FORCE + i] = -impulse[k, i] / h
        if whole != 1.0:
            copy(laws[k, 3], old, laws[k, 4])
        call_law(laws[k, 1], laws[k, 2], laws[k, 3], t[at.RESULT] + 8 * RESULT_WORDS * k, t[at.SCRATCH])
        if whole != 1.0:
            go_all_the_way(laws[k, 3], old, laws[k, 4], whole)
        at_end, work = out[0], whole * out[1]
        flow_u, flow_v, flow_turn = whole * out[FLOW], whole * out[FLOW + 1], whole * out[FLOW + 2]
        held, room = 1.0, 1.0
        if breakable:
            share, room = used(limits[k], r, whole, out)
            held, r[RESULT_USED] = scale[k], min(share, 1.0)
        lost, second_half = held * work, 0.5 * held * work
        if settings[BETA] != 0.0:
            xl, yl, zl = rates(gradient, k, last, ia, last, ib)
            u, v, turn = lag * xl + lead * x, lag * yl + lead * y, lag * zl + lead * z
            ahead[k, 0] = half_a_step_on(t, k, x, y, z, u, v, turn, whole - 1.0, out)
            at_end += ahead[k, 0]
            second_half = 0.0
            # Where the next step is to find it; after implicit Euler, at q*.
            d[0], d[1], d[2] = r[0] + u, r[1] + v, r[2] + turn
        elif averages:
            d[0], d[1], d[2] = r[0], r[1], r[2]
        damped = 0.0
        if t[at.DAMPED] == 1:
            damped = h * (c[0] * taken(x0, x, stiff) + c[1] * taken(y0, y, stiff) + c[2] * taken(z0, z, stiff))
        x, y, z = 0.5 * (x0 + x), 0.5 * (y0 + y), 0.5 * (z0 + z)
        given = 0.5 * (r[RESULT_BEFORE] + r[RESULT_ELASTIC]) - damped
        given -= impulse[k, 0] * x + impulse[k, 1] * y + impulse[k, 2] * z
        if ia >= moving or ib >= moving:
            external -= work_on_held(t, k, velocity, start)
        if t[at.SHIFTED] == 1:
            by_contacts, by_hand = work_of_shifts(t, k, 0), work_of_shifts(t, k, 3)
            if by_contacts + by_hand < -max(r[RESULT_ELASTIC], 0.0):
                # No more can be released than is stored.
                less = -max(r[RESULT_ELASTIC], 0.0) / (by_contacts + by_hand)
                by_contacts, by_hand = less * by_contacts, less * by_hand
            contact -= by_contacts
            external += by_hand
            given += by_contacts + by_hand
            r[RESULT_ELASTIC] += by_contacts + by_hand
        at_start = r[RESULT_ELASTIC] if settings[BETA] == 0.0 else at_end
        if flow_u != 0.0 or flow_v != 0.0 or flow_turn != 0.0:
            # A joint that breaks flows until its limit, and is gone for the rest of the step.
            r[RESULT_PLASTIC + (0 if flow_u > 0.0 else 1)] += held * abs(flow_u)
            r[RESULT_PLASTIC + 2] += held * abs(flow_v)
            r[RESULT_PLASTIC + 3] += held * abs(flow_turn)
            flows = True
        if held < 1.0 or room < 1.0:
            # What was stored elastically, and what the joint still took of the step's share, is lost with it.
            lost += r[RESULT_ELASTIC] + held * (at_end - r[RESULT_ELASTIC])
            at_start, at_end, second_half, ahead[k, 0] = 0.0, 0.0, 0.0, 0.0
            r[RESULT_USED] = 1.0
            let_go(t, k, scale[k] * h)
            active[k] = 0
            broke += 1
        stored = 0.5 * (at_start + at_end)
        r[RESULT_BEFORE], r[RESULT_ELASTIC] = at_start, at_end
        if lost != 0.0 or damped != 0.0:
            r[RESULT_DISSIPATED] += lost
            r[RESULT_VISCOUS] += damped
        elastic += stored
        plastic += lost - second_half
        to_come += second_half
        viscous += damped
        numerical += given - stored
    if settings[BETA] != 0.0:
        over = take_back(t, elastic)
        elastic, numerical = elastic - over, numerical + over
    t[at.FLOWING] = 1 if flows else 0
    ledger[LEDGER_EXTERNAL] += external
    ledger[LEDGER_ELASTIC] = elastic
    ledger[LEDGER_PLASTIC] += plastic
    ledger[LEDGER_TO_COME] = to_come
    ledger[LEDGER_CONTACT] += contact
    ledger[LEDGER_VISCOUS] += viscous
    ledger[LEDGER_NUMERICAL] += numerical - plastic
    return broke


@inlined
def taken(start, end, stiff):  # type: ignore[no-untyped-def]
    """What viscous damping takes, over its coefficient and the step, where a rate goes from ``start`` to ``end``.

    That is the square of the mean rate; where a step is too ``stiff`` for that, see `is_stiff`, no more than what the
    damping's force, which is that of the end, did along the mean.
    """
    mean = 0.5 * (start + end)
    return min(max(end * mean, 0.0), mean * mean) if stiff else mean * mean


@kernel
def is_stiff(t, start, end):  # type: ignore[no-untyped-def]
    """Whether squares of mean rates overrate viscous work by more than a share of the energy that there was.

    As where a body that was thrown is stopped within the step, by damping or by a stiff joint.
    """
    joint_bodies, gradient, damping = views.joint_bodies(t), views.gradient(t), views.damping(t)
    ledger, over = views.ledger(t), 0.0
    for k in range(t[at.JOINTS]):
        ia, ib, c = joint_bodies[k, 0], joint_bodies[k, 1], damping[k]
        x0, y0, z0 = rates(gradient, k, start, ia, start, ib)
        x1, y1, z1 = rates(gradient, k, end, ia, end, ib)
        over += 0.25 * (c[0] * (x0 * x0 - x1 * x1) + c[1] * (y0 * y0 - y1 * y1) + c[2] * (z0 * z0 - z1 * z1))
    return views.settings(t)[STEP] * over > _OVERRATED * (ledger[LEDGER_KINETIC] + ledger[LEDGER_ELASTIC])


@kernel
def copy(source, target, count):  # type: ignore[no-untyped-def]
    """Copy so many numbers from one address to another."""
    there, here = floats(source, count), floats(target, count)
    for i in range(count):
        here[i] = there[i]
