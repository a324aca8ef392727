"""The ledger: where the energy that a structure was given has gone.

Velocities change at the start of a move and stay until the next; what is kinetic is reckoned with those of the move, so
all the rest is reckoned as it is, on the average, over the move. With a body's momentum changed in a step by
p = p_ext + p_J + p_c + p_g (from outside, by joints, by contacts, and by the geometric inertia of `inertia`), from V₀
to V₁,

    ΔT = p · V̄,   V̄ = ½ (V₀ + V₁),   summed over the bodies,

exactly, whatever p is made of. Work from outside is p_ext · V̄: a weight's is that of the way from the middle of one
move to the middle of the next. Joints take - p_J · V̄ = - λ · J V̄, of which they store what their elastic energy at
both ends of the move, averaged, has grown by, and dissipate c (J V̄)² h in damping, less where a step is too long for it
(see `commit`), and half the plastic work of this move and of the last. What is left over is numerical dissipation. In
implicit Euler, with q₀, q₁ and q₂ where the last two moves began and ended, it is in every joint

    ½ [s₂ · (q₂ - q₀) - (E₂ - E₀)]  +  ½ (s₂ - s₁) · (plastic flow of the last move)  +  ½ s₂ · (κ₁ - κ₀)  -  p_g · V̄.

The first term is not negative, since elastic energy is convex; it is ¼ k (q₂ - q₀)² for a stiffness k. The second is
negative where a joint is thrown back while it yields. κ is what a joint is stretched by because bodies move straight
while they turn, of second order in the angle turned, and matters where it changes. `guard` sees to it that the sum over
all joints and steps is not negative. In the average-acceleration rule, the elastic energy is that of the deformation
half a step on, where the velocities are, and all terms cancel.

Where implicit Euler's last move was longer or shorter than this step, that is how far forces from outside have gone at
its velocities; between whole steps but for the motion as a rigid body of a structure that nothing holds, which deforms
no joint.

A body that is given another velocity V₀ by a kick ΔV between two steps is moved by it from the next move on only. So
forces from outside have done work along V̄ - ½ ΔV. The kick's own is that along V₀ - ½ ΔV, as if nothing had resisted
it; where energy would come from nowhere, it is that along V̄ - ½ ΔV, too.

A contact's impulse j does the work j v̄ on each of two bodies. What one gives and the other does not get is lost to
contact: - j ½ (v₀ + v₁) with the velocities of one relative to the other, which is the loss in an impact by Kelvin's
formula, and friction. So what a loose body loses is to the last digit what the structure is given.

The elastic energy that a movement without velocity (by hand, or taking out overlap) puts into the joints is external
work and contact work.
"""

from sim.chipmunk import BODY_WORDS, CONTACT_NORMAL_IMPULSE, CONTACT_TANGENT_IMPULSE, CONTACT_WORDS
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import from_column
from sim.kernels.guard import relative_velocity, rigid_motion
from sim.kernels.inertia import moment_of
from sim.kernels.kinematics import impulses, rates
from sim.kernels.layout import (
    B_START,
    BETA,
    BODY_A,
    BODY_B,
    INERTIA_I,
    INERTIA_M,
    LEDGER_CONTACT,
    LEDGER_EXTERNAL,
    LEDGER_KINETIC,
    LEDGER_NUMERICAL,
    MOVE,
    NEXT_MOVE,
    OTHER_START,
    OWNER_A,
    OWNER_B,
    SPREAD_IMPULSE,
    STEP,
    WHERE,
)
from sim.kernels.noted import note_work, row_of
from sim.kernels.rows import other_velocity, own_velocity, velocity_of_b
from sim.memory import floats, inlined, kernel

# Of a step.
_ROUNDING = 1e-9


@inlined
def work_on_held(t, k, velocity, start):  # type: ignore[no-untyped-def]
    """Work that joint k does on bodies which are not dynamic."""
    joint_bodies, impulse = views.joint_bodies(t), views.per_joint(t, at.IMPULSE)
    px, py, on_a, on_b = impulses(views.gradient(t), k, impulse[k, 0], impulse[k, 1], impulse[k, 2])
    total = 0.0
    for side in range(2):
        i = joint_bodies[k, side]
        if i >= t[at.MOVING]:
            sign, moment = (1.0, on_b) if side == 1 else (-1.0, on_a)
            x, y, turn = start[i, 0] + velocity[i, 0], start[i, 1] + velocity[i, 1], start[i, 2] + velocity[i, 2]
            total += 0.5 * (sign * (px * x + py * y) + moment * turn)
    return total


@kernel
def work_of_shifts(t, k, column):  # type: ignore[no-untyped-def]
    """Work on joint k of movements without velocity; ``column`` 0: by contacts, 3: by hand."""
    joint_bodies, gradient, impulse = views.joint_bodies(t), views.gradient(t), views.per_joint(t, at.IMPULSE)
    by = from_column(views.shift(t), column)
    x, y, z = rates(gradient, k, by, joint_bodies[k, 0], by, joint_bodies[k, 1])
    return -(impulse[k, 0] * x + impulse[k, 1] * y + impulse[k, 2] * z) / views.settings(t)[STEP]


@inlined
def close(c, t):  # type: ignore[no-untyped-def]
    """Book what bodies and contacts did in a step; the joints' part is booked by `commit`.

    Returns by how much less work from outside is booked because moves were of other lengths than the step, and because
    kicks are booked as if nothing had resisted them.
    """
    ledger, settings, body_at = views.ledger(t), views.settings(t), views.body_at(t)
    start, end = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.WRITTEN)
    external, struck = views.per_body(t, at.EXTERNAL), views.per_body(t, at.CONTACT_IMPULSE)
    pattern, weight = views.per_body(t, at.PATTERN), views.weight(t)
    solved, factor = views.per_body(t, at.VELOCITY), settings[SPREAD_IMPULSE]
    touching, driven, turns = t[at.CONTACTS] > 0 or t[at.HEAD] != 0, t[at.SPREAD] == 1, t[at.TURNING] == 1
    before, after, outside, turning, contact_work, less = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    last, whole, unmoved, kicks = views.per_body(t, at.LAST_VELOCITY), t[at.PARTS] == 1, 0.0, 0.0
    for i in range(t[at.MOVING]):
        moment = moment_of(floats(body_at[i], BODY_WORDS)) if turns else weight[i, INERTIA_I]
        for axis in range(3):
            mass = moment if axis == 2 else weight[i, INERTIA_M]
            v0, v1 = start[i, axis], end[i, axis]
            mean = 0.5 * (v0 + v1)
            before += mass * v0 * v0
            after += mass * v1 * v1
            outside += external[i, axis] * mean
            if whole and v0 != last[i, axis]:
                kick = v0 - last[i, axis]
                unmoved += 0.5 * external[i, axis] * kick
                kicks += 0.5 * mass * kick * (v1 - v0)
            if touching:
                contact_work += struck[i, axis] * mean
            if driven:
                outside += factor * pattern[i, axis] * mean
            if turns:
                turning += mass * (end[i, axis] - solved[i, axis]) * mean
                if axis == 2:
                    turning -= (weight[i, INERTIA_I] - mass) * solved[i, axis] * mean
    # A kick has not moved any body yet.
    outside -= unmoved
    ledger[LEDGER_NUMERICAL] -= unmoved
    before_step, after_step = 1.0 - settings[MOVE] / settings[STEP], 1.0 - settings[NEXT_MOVE] / settings[STEP]
    if settings[BETA] == 0.0 and (before_step != 0.0 or after_step != 0.0):
        # Velocities carry forces another way than that of a step.
        of_outside, of_contacts = work_at(t, start)
        less, bearing = 0.5 * before_step * of_outside, 0.5 * before_step * of_contacts
        if after_step != 0.0:
            of_outside, of_contacts = work_at(t, end)
            less, bearing = less + 0.5 * after_step * of_outside, bearing + 0.5 * after_step * of_contacts
        even = abs(before_step + after_step) <= _ROUNDING
        if touching and (even or before_step > 0.0):
            # So have contacts that bear; those of a blow, before whose first part bodies moved further, have not. What
            # bodies give and get stays what it is, as far as contacts have lost so much.
            lost = bearing if even else max(min(bearing, 0.0), -ledger[LEDGER_CONTACT])
            ledger[LEDGER_CONTACT] += lost
            ledger[LEDGER_NUMERICAL] -= lost
            less += 0.0 if even else min(bearing, 0.0) - lost
        outside -= less
        ledger[LEDGER_NUMERICAL] -= less
    given, arrived = contacts(c, t, start, end)
    # What contacts did that another structure of the group has booked as its own comes from outside.
    outside += given + (contact_work - arrived)
    ledger[LEDGER_EXTERNAL] += 0.5 * before - ledger[LEDGER_KINETIC] + outside
    ledger[LEDGER_KINETIC] = 0.5 * after
    ledger[LEDGER_NUMERICAL] -= turning
    ledger[LEDGER_CONTACT] += given - arrived
    return less + max(kicks, 0.0)


@kernel
def work_at(t, velocity):  # type: ignore[no-untyped-def]
    """Work that forces from outside, of held bodies among them, and contacts would do at these velocities.

    Between whole steps, at those relative to the motion of the structure as a rigid body, if nothing holds it.
    """
    external, struck = views.per_body(t, at.EXTERNAL), views.per_body(t, at.CONTACT_IMPULSE)
    joint_bodies, moving, of_outside, of_contacts = views.joint_bodies(t), t[at.MOVING], 0.0, 0.0
    body_at, frame = views.body_at(t), (0.0, 0.0, 0.0, 0.0, 0.0)
    if t[at.PARTS] == 1 and t[at.AFTER_PARTS] == 0:
        frame = rigid_motion(t, velocity)
    for i in range(moving):
        u, v, w = relative_velocity(body_at[i], velocity[i], frame)
        of_outside += external[i, 0] * u + external[i, 1] * v + external[i, 2] * w
        of_contacts += struck[i, 0] * u + struck[i, 1] * v + struck[i, 2] * w
    for k in range(t[at.JOINTS]):
        if joint_bodies[k, 0] >= moving or joint_bodies[k, 1] >= moving:
            of_outside -= work_on_held(t, k, velocity, velocity)
    return of_outside, of_contacts


@inlined
def contacts(c, t, start, end):  # type: ignore[no-untyped-def]
    """The contacts that a structure solved as its own: work that other bodies did on it, and how much arrived."""
    places, touches = views.places(t), views.touches(t)
    given, arrived = 0.0, 0.0
    for k in range(t[at.CONTACTS]):
        place, touch = places[k], touches[k]
        contact, loose, of_b = floats(place[WHERE], CONTACT_WORDS), 0.0, 0.0
        neither = place[OWNER_A] == 0 and place[OWNER_B] == 0
        for row in range(2):
            impulse = contact[CONTACT_TANGENT_IMPULSE] if row == 1 else contact[CONTACT_NORMAL_IMPULSE]
            own0, own1 = own_velocity(c, place, touch, row, start), own_velocity(c, place, touch, row, end)
            loose += 0.5 * impulse * (touch[OTHER_START + row] + other_velocity(c, place, touch, row))
            arrived += 0.5 * impulse * (own0 + own1)
            if neither:
                of_b += 0.5 * impulse * (touch[B_START + row] + velocity_of_b(place, touch, row))
        if neither:
            note_work(t, place[BODY_A], loose - of_b, 0.0)
            note_work(t, place[BODY_B], of_b, 0.0)
            note_work(t, place[BODY_B] if row_of(t, place[BODY_A]) == 0 else place[BODY_A], 0.0, -loose)
            continue
        given -= loose
        if loose != 0.0 and (place[OWNER_A] == 0 or place[OWNER_B] == 0):
            note_work(t, place[BODY_A] if place[OWNER_A] == 0 else place[BODY_B], loose, 0.0)
    return given, arrived
