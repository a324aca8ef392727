"""The ledger: where the energy that a structure was given has gone.

With a body's momentum changed in a step by p = p_ext + p_J + p_c + p_g (from outside, by joints, by contacts, and by
the geometric inertia of `inertia`), from V₀ to V₁,

    ΔT = p · ½ (V₀ + V₁) = p · V_w - (w - ½) ΔV·M ΔV,   V_w = V₀ + w ΔV, summed over the bodies,

exactly. Work is booked with V_w, w = 1 for implicit Euler (it is force times the way that Chipmunk moves the bodies
next), and w = ½ for the average-acceleration rule. Joints take - p_J · V_w = - λ · J V_w, of which they store ΔE, and
dissipate plastic and viscous work. What is left over is numerical dissipation. For implicit Euler it is

    ½ ΔV·M ΔV  +  Σ (s* Δq* - ΔE - plastic work)  -  Σ s* (q_n - q*_{n-1})  -  p_g · V₁.

The first term is not negative, the second is not since laws are convex, and the last is not either. The third is what
a joint is stretched by because bodies move straight while they turn; it is of second order in the angle turned in a
step, and balances the first one where a body is swung round. In the average-acceleration rule, the elastic energy is
that of the deformation half a step on, where the velocities are, and all terms cancel.

A contact's impulse j does the work j v_w on each of two bodies; what one gives and the other does not get is friction,
j times the velocity of one relative to the other. In an impact that velocity changes by Δv, and ½ j Δv of the energy is
lost besides: by the structure, where it is part of ½ ΔV·M ΔV, or by the other body. It is booked as lost to contact,
the structure's part of it up to all of ½ ΔV·M ΔV: where joints bear on the body within the step, j is larger than what
changed the body's velocity. A loose body that is slowed over several steps loses ½ m Δv² more in each of them than
the structure is given: that is the time integration's loss on its side, and in no structure's ledger.

The elastic energy that a movement without velocity (by hand, or taking out overlap) puts into the joints is external
work and contact work.
"""

from numba import njit

from sim.chipmunk import BODY_WORDS, CONTACT_NORMAL_IMPULSE, CONTACT_TANGENT_IMPULSE, CONTACT_WORDS
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.contacts import other_velocity, own_velocity
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.kinematics import rates
from sim.kernels.layout import (
    BETA,
    CACHED,
    INERTIA_I,
    LEDGER_CONTACT,
    LEDGER_EXTERNAL,
    LEDGER_KINETIC,
    LEDGER_NUMERICAL,
    OTHER_START,
    OWNER_A,
    OWNER_B,
    SPREAD_IMPULSE,
    STEP,
    STEP_RATIO,
    WHERE,
)
from sim.memory import floats


@njit(inline="always", error_model="numpy")
def weight_of_end(settings):  # type: ignore[no-untyped-def]
    """Share w of the velocities at the step's end in V_w."""
    return 1.0 if settings[BETA] == 0.0 else 0.5


@njit(error_model="numpy")
def work_on_held(t, k, velocity, start, w):  # type: ignore[no-untyped-def]
    """Work that joint k does on bodies which are not dynamic."""
    joint_bodies, j, impulse = views.joint_bodies(t), views.jacobian(t), views.per_joint(t, at.IMPULSE)
    total = 0.0
    for side in range(2):
        i = joint_bodies[k, side]
        if i >= t[at.MOVING]:
            for axis in range(3):
                v = start[i, axis] + w * (velocity[i, axis] - start[i, axis])
                c = 3 * side + axis
                total += v * (impulse[k, 0] * j[k, c] + impulse[k, 1] * j[k, 6 + c] + impulse[k, 2] * j[k, 12 + c])
    return total


@njit(error_model="numpy")
def work_of_shifts(t, k, column):  # type: ignore[no-untyped-def]
    """Work on joint k of movements without velocity; ``column`` 0: by contacts, 3: by hand."""
    joint_bodies, jacobian, impulse = views.joint_bodies(t), views.jacobian(t), views.per_joint(t, at.IMPULSE)
    by = views.shift(t)[:, column : column + 3]
    x, y, z = rates(jacobian, k, by, joint_bodies[k, 0], by, joint_bodies[k, 1])
    return -(impulse[k, 0] * x + impulse[k, 1] * y + impulse[k, 2] * z) / views.settings(t)[STEP]


@njit(error_model="numpy")
def close(c, t):  # type: ignore[no-untyped-def]
    """Book what bodies and contacts did in a step; the joints' part is booked by `commit`."""
    ledger, settings, body_at = views.ledger(t), views.settings(t), views.body_at(t)
    start, end = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.WRITTEN)
    external, struck = views.per_body(t, at.EXTERNAL), views.per_body(t, at.CONTACT_IMPULSE)
    pattern, weight = views.per_body(t, at.PATTERN), views.weight(t)
    solved = views.per_body(t, at.VELOCITY)
    w, factor = weight_of_end(settings), settings[SPREAD_IMPULSE]
    touching, driven, turns = t[at.CONTACTS] > 0 or t[at.HEAD] != 0, t[at.SPREAD] == 1, t[at.TURNING] == 1
    before, after, change, outside, turning, contact_work = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        for axis in range(3):
            mass = moment_of(b) if axis == 2 else mass_of(b)
            v0, v1 = start[i, axis], end[i, axis]
            dv = v1 - v0
            vw = v0 + w * dv
            before += mass * v0 * v0
            after += mass * v1 * v1
            change += mass * dv * dv
            outside += external[i, axis] * vw
            if touching:
                contact_work += struck[i, axis] * vw
            if driven:
                outside += factor * pattern[i, axis] * vw
            if turns:
                turning += mass * (end[i, axis] - solved[i, axis]) * vw
                if axis == 2:
                    turning -= (weight[i, INERTIA_I] - mass) * solved[i, axis] * vw
    given, arrived, by_other, by_own = contacts(c, t, start, end, w)
    slowed = (w - 0.5) * change
    by_own = min(by_own, slowed)
    # What contacts did that another structure of the group has booked as its own comes from outside.
    outside += given + by_other + (contact_work - arrived)
    ledger[LEDGER_EXTERNAL] += 0.5 * before - ledger[LEDGER_KINETIC] + outside
    ledger[LEDGER_KINETIC] = 0.5 * after
    ledger[LEDGER_CONTACT] += given - arrived + by_other + by_own
    ledger[LEDGER_NUMERICAL] += slowed - by_own - turning


@njit(error_model="numpy")
def contacts(c, t, start, end, w):  # type: ignore[no-untyped-def]
    """The contacts that a structure solved as its own.

    Returns the work that other bodies did on it, how much of it arrived, and the loss in impacts of loose bodies and of
    its own.
    """
    places, touches, ratio = views.places(t), views.touches(t), views.settings(t)[STEP_RATIO]
    given, arrived, by_other, by_own = 0.0, 0.0, 0.0, 0.0
    for k in range(t[at.CONTACTS]):
        place, touch = places[k], touches[k]
        contact = floats(place[WHERE], CONTACT_WORDS)
        loose = place[OWNER_A] == 0 or place[OWNER_B] == 0
        for row in range(2):
            total = contact[CONTACT_TANGENT_IMPULSE] if row == 1 else contact[CONTACT_NORMAL_IMPULSE]
            # Chipmunk scales what it applies of the cached impulse by the ratio of the steps, but not what it keeps.
            impulse = total + (ratio - 1.0) * touch[CACHED + row]
            other0, other1 = touch[OTHER_START + row], other_velocity(c, place, touch, row)
            own0, own1 = own_velocity(c, place, touch, row, start), own_velocity(c, place, touch, row, end)
            given -= impulse * (other0 + w * (other1 - other0))
            arrived += impulse * (own0 + w * (own1 - own0))
            lost = max((w - 0.5) * impulse * (other1 - other0 + own1 - own0), 0.0)
            theirs = min(max((w - 0.5) * impulse * (other1 - other0), 0.0), lost) if loose else 0.0
            by_other += theirs
            by_own += lost - theirs
    return given, arrived, by_other, by_own
