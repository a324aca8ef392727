"""What comes suddenly without anything being hit: an impulse or a set velocity, a force put on at once, a jerk of a
support, a joint that lets go.

Implicit Euler takes the energy out of what such a change sets swinging, within few steps at 60 Hz. So a change that
brings much is taken like a blow, see `blow`: in parts. With ΔF what forces from outside are more than in the last step
(an impulse counts as a force for one step), and H the matrix that was factored last, it brings the energy

    ½ h ΔF · H⁻¹ h ΔF,   H = M + h² Jᵀ D J,

within a step: ½ ΔF²/k for a load on a spring that the step is long for, and kinetic energy where it is short. A support
whose velocity changes brings, at the most, what it takes to have the whole structure follow. Forces of joints that let
go count as if they had been forces from outside until then.

What moves a structure that nothing holds as a rigid body brings nothing.

Bodies that are set going begin to bend a structure from where they are, faster than parts by implicit Euler resolve: up
to a quarter of the plastic work would be lost. Where impulses bring much, the parts are taken by the
average-acceleration rule, see `guard`, with a little damping (δ = 0.02) of what they no longer resolve as they grow:
undamped, that would tear at stiff joints in longer parts. By forces that begin at once stiff joints would ring with it,
to twice what they bear at rest. So implicit Euler goes first, until what is stiff has settled, and damping is
stronger (δ = 0.1).

Where the rule is wanted for all steps, forces that begin at once are taken in whole ones, which do not damp them. So
are impulses that whole steps resolve: whose velocities deform joints in a step by less than the tenth part of their
energy, twenty steps a period. Others are taken in parts, too; how these go over to whole steps is told in `lengths`.

What brings less than a hundredth of the energy that is there already, a tenth of the forces, is none: loads that grow
within ten steps or more, say.
"""

import math

from sim.chipmunk import BODY_WORDS, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.blocks import solve
from sim.kernels.bodies import force_on
from sim.kernels.guard import relative_velocity, rigid_motion
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.layout import (
    AFTER_FORCES,
    AFTER_IMPULSES,
    BLOW,
    INERTIA_I,
    INERTIA_M,
    INVERSE_I,
    INVERSE_M,
    LEDGER_ELASTIC,
    LEDGER_KINETIC,
    MOVE,
    OVER_AT,
    STEP,
    UNDAMPED,
    WANTED_BETA,
    WHOLE_ONLY,
)
from sim.kernels.resolved import loss_of_joints
from sim.memory import floats, inlined, kernel

#: Of the structure's energy.
WORTH = 1e-2
# Likewise, for impulses to be followed without damping.
_MUCH = 0.25
# (ωh)² of what whole steps of the average-acceleration rule resolve: twenty a period.
_RESOLVED = 0.1
# Of the energy that a support's new velocity brings: what may move against it before.
_STRAYED = 1e-2
# Of a step.
_ROUNDING = 1e-9


@inlined
def sudden_energy(t, last_step):  # type: ignore[no-untyped-def]
    """Energy that comes suddenly in the step that begins, in implicit Euler [J].

    While a blow lasts that is not damped, only more than its own counts; while another does, none. Masses and gradients
    must be those of the step, and Chipmunk not have applied its forces yet.
    """
    settings, ledger = views.settings(t), views.ledger(t)
    energy, by_impulses = note_forces(t) if t[at.FORCED] == 1 else (0.0, 0.0)
    t[at.JERKED] = 0
    by_supports = note_supports(t)
    present = ledger[LEDGER_KINETIC] + ledger[LEDGER_ELASTIC]
    at_once = max(by_impulses, by_supports if t[at.JERKED] == 1 else 0.0)
    much, wanted = at_once > _MUCH * present, settings[WANTED_BETA] != 0.0
    whole = settings[WHOLE_ONLY] != 0.0 or t[at.SPREAD] == 1 or (wanted and not much)
    lasting = settings[BLOW] if settings[OVER_AT] == 0.0 else 0.0
    if whole or (lasting > 0.0 and (wanted or settings[UNDAMPED] == 0.0)):
        return 0.0
    undamped = AFTER_IMPULSES if much else AFTER_FORCES
    if lasting == 0.0:
        settings[UNDAMPED] = undamped
    enough = WORTH * present
    if energy > enough and t[at.FREE] == 1:
        enough += WORTH * energy
        energy = leave_relative(t)
    if wanted and loss_of_joints(t, views.per_body(t, at.START_VELOCITY)) <= _RESOLVED * max(energy, by_supports):
        return 0.0
    if energy > enough and t[at.NEWTON_STEPS] > 0:
        # So far that is what it would be without joints, which is the most.
        energy = min(energy, with_joints(t) * (last_step / settings[STEP]) ** 2)
    energy = max(energy, by_supports)
    if not max(enough, lasting) < energy < math.inf:
        return 0.0
    settings[UNDAMPED] = undamped
    return energy


@kernel
def leave_relative(t):  # type: ignore[no-untyped-def]
    """Of the impulses in `SOLUTION`, leave what moves bodies relative to each other; returns its energy [J]."""
    jump, weight, body_at, energy = views.per_body(t, at.SOLUTION), views.weight(t), views.body_at(t), 0.0
    for i in range(t[at.MOVING]):
        for axis in range(3):
            jump[i, axis] *= weight[i, INVERSE_I if axis == 2 else INVERSE_M]
    frame = rigid_motion(t, jump)
    for i in range(t[at.MOVING]):
        jump[i, 0], jump[i, 1], jump[i, 2] = relative_velocity(body_at[i], jump[i], frame)
        for axis in range(3):
            mass = weight[i, INERTIA_I if axis == 2 else INERTIA_M]
            energy += 0.5 * mass * jump[i, axis] ** 2
            jump[i, axis] *= mass
    return energy


@kernel
def with_joints(t):  # type: ignore[no-untyped-def]
    """Energy that the change of impulses in `SOLUTION` brings, by the last factor of the matrix [J].

    That is of the last step, or of its last part: the change is to be one of impulses within its length.
    """
    # Nothing has been written in this step so far.
    jump, response, energy = views.per_body(t, at.SOLUTION), views.per_body(t, at.WRITTEN), 0.0
    for i in range(t[at.MOVING]):
        for axis in range(3):
            response[i, axis] = jump[i, axis]
    solve(t, 0, response)
    for i in range(t[at.MOVING]):
        for axis in range(3):
            energy += 0.5 * jump[i, axis] * response[i, axis]
    return energy


@kernel
def note_forces(t):  # type: ignore[no-untyped-def]
    """Note forces from outside, leaving by how much their impulses changed in `SOLUTION`.

    Returns the energy that this would bring if there were no joints, which is the most, and that of what came at once,
    as impulses and velocities [J].
    """
    body_at, weight, h, most, at_once = views.body_at(t), views.weight(t), views.settings(t)[STEP], 0.0, 0.0
    start, last = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.LAST_VELOCITY)
    force, jump, rate = views.per_body(t, at.LAST_FORCE), views.per_body(t, at.SOLUTION), 1.0 / h
    for i in range(t[at.MOVING]):
        x, y, turn = start[i, 0] - last[i, 0], start[i, 1] - last[i, 1], start[i, 2] - last[i, 2]
        now, b = force_on(body_at[i], rate * x, rate * y, rate * turn), floats(body_at[i], BODY_WORDS)
        given = mass_of(b) * x, mass_of(b) * y, moment_of(b) * turn
        for axis in range(3):
            lightness = weight[i, INVERSE_I if axis == 2 else INVERSE_M]
            known = lightness > 0.0 and math.isfinite(force[i, axis])
            jump[i, axis] = h * (now[axis] - force[i, axis]) if known else 0.0
            most += 0.5 * lightness * jump[i, axis] ** 2
            at_once += 0.5 * lightness * given[axis] ** 2
            force[i, axis] = now[axis]
    return most, at_once


@inlined
def note_supports(t):  # type: ignore[no-untyped-def]
    """Note how fast held bodies are carried along, by velocity or by hand.

    Returns the most energy that it takes to have the structure follow the change [J]. What has gone with a support
    until that was given another velocity can be taken back to then.
    """
    start, shift, force = views.per_body(t, at.START_VELOCITY), views.shift(t), views.per_body(t, at.LAST_FORCE)
    last = views.per_body(t, at.LAST_VELOCITY)
    body_at, weight, h, most = views.body_at(t), views.weight(t), views.settings(t)[STEP], 0.0
    for k in range(t[at.MOVING], t[at.BODIES]):
        # What is held bears any force; its rows of forces hold velocities.
        x, y = start[k, 0] + shift[k, 3] / h, start[k, 1] + shift[k, 4] / h
        turn = start[k, 2] + shift[k, 5] / h
        x0, y0, w0 = force[k, 0], force[k, 1], force[k, 2]
        dx, dy, dw = x - x0, y - y0, turn - w0
        force[k, 0], force[k, 1], force[k, 2] = x, y, turn
        if dx == 0.0 and dy == 0.0 and dw == 0.0:
            continue
        energy, strayed, centre = 0.0, 0.0, floats(body_at[k], BODY_WORDS)
        for i in range(t[at.MOVING]):
            b = floats(body_at[i], BODY_WORDS)
            rx, ry = b[X] - centre[X], b[X + 1] - centre[X + 1]
            u, v = dx - dw * ry, dy + dw * rx
            energy += 0.5 * (weight[i, INERTIA_M] * (u * u + v * v) + weight[i, INERTIA_I] * dw * dw)
            u, v, w = last[i, 0] - x0 + w0 * ry, last[i, 1] - y0 - w0 * rx, last[i, 2] - w0
            strayed += 0.5 * (weight[i, INERTIA_M] * (u * u + v * v) + weight[i, INERTIA_I] * w * w)
        most = max(most, energy)
        by_hand = shift[k, 3] != 0.0 or shift[k, 4] != 0.0 or shift[k, 5] != 0.0
        in_step = abs(views.settings(t)[MOVE] - h) <= _ROUNDING * h
        if strayed <= _STRAYED * energy and in_step and not by_hand and t[at.AFTER_PARTS] == 0:
            t[at.JERKED] = 1
    return most
