"""A bounce gives back no more energy than there is.

Restitution asks for a relative velocity after an impact, whatever stands behind the surfaces. Where that is a stiff or
strong structure which moves itself, the move of the next step then strains it by more energy than the impact brought:
the contact's impulse j does the work j·v₁ over that move, of which implicit Euler spends

    ½ ΔV·M ΔV + ½ h² (J V)·D (J V)

(see `energy`), and what is above that comes from nowhere. So where a bounce would create energy, less of it is asked
for. Without any bounce j·v₁ is not positive, and nothing is created.
"""

from sim.chipmunk import BODY_WORDS, CONTACT_NORMAL_IMPULSE, CONTACT_TANGENT_IMPULSE, CONTACT_WORDS
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.kinematics import rates
from sim.kernels.layout import (
    BETA,
    NEXT_MOVE,
    OTHER_START,
    OWNER_A,
    OWNER_B,
    STEP,
    TANGENT,
    WANTED,
    WHERE,
)
from sim.kernels.rows import other_velocity, own_velocity
from sim.memory import floats, kernel

#: Times that a bounce is halved before none is asked for.
MOST_HALVINGS = 6
# A bounce off what does not give spends all that it takes.
_ROUNDING = 1e-12


@kernel
def bounces(head):  # type: ignore[no-untyped-def]
    """Whether any contact of a group in implicit Euler asks for a bounce."""
    c = head
    while c != 0:
        t = views.control(c)
        touches = views.touches(t)
        for k in range(t[at.CONTACTS]):
            if touches[k, WANTED] > 0.0 and views.settings(t)[BETA] == 0.0:
                return True
        c = t[at.NEXT]
    return False


@kernel
def creates_energy(head):  # type: ignore[no-untyped-def]
    """Whether the contacts of a group do more work over the next move than the step spends."""
    work, spent, c = 0.0, 0.0, head
    while c != 0:
        t = views.control(c)
        spent += spent_by(t)
        velocity, places, touches = views.per_body(t, at.VELOCITY), views.places(t), views.touches(t)
        for k in range(t[at.CONTACTS]):
            place, touch = places[k], touches[k]
            contact = floats(place[WHERE], CONTACT_WORDS)
            # Below 0: neither body is a structure's.
            other = place[OWNER_A] + place[OWNER_B] - c
            for row in range(2):
                impulse = contact[CONTACT_TANGENT_IMPULSE] if row == 1 else contact[CONTACT_NORMAL_IMPULSE]
                relative = own_velocity(c, place, touch, row, velocity)
                if other <= 0:
                    theirs = other_velocity(c, place, touch, row)
                    spent += 0.5 * impulse * (theirs - touch[OTHER_START + row])
                    relative += theirs
                elif other != c:
                    others = views.per_body(views.control(other), at.VELOCITY)
                    relative += own_velocity(other, place, touch, row, others)
                work += impulse * relative
        c = t[at.NEXT]
    return work > (1.0 + _ROUNDING) * spent


@kernel
def spent_by(t):  # type: ignore[no-untyped-def]
    """What implicit Euler dissipates in a structure's bodies, and in its joints as they yield now [J]."""
    body_at, joint_bodies, gradient = views.body_at(t), views.joint_bodies(t), views.gradient(t)
    start, velocity = views.per_body(t, at.START_VELOCITY), views.per_body(t, at.VELOCITY)
    response, settings, total = views.response(t), views.settings(t), 0.0
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        x, y, w = velocity[i, 0] - start[i, 0], velocity[i, 1] - start[i, 1], velocity[i, 2] - start[i, 2]
        total += mass_of(b) * (x * x + y * y) + moment_of(b) * w * w
    factor = settings[STEP] * settings[NEXT_MOVE]
    for k in range(t[at.JOINTS]):
        u, v, w = rates(gradient, k, velocity, joint_bodies[k, 0], velocity, joint_bodies[k, 1])
        d = response[k]
        total += factor * (d[TANGENT] * u * u + d[TANGENT + 3] * v * v + d[TANGENT + 5] * w * w)
        total += factor * 2.0 * (d[TANGENT + 1] * u * v + d[TANGENT + 2] * u * w + d[TANGENT + 4] * v * w)
    return 0.5 * total


@kernel
def bounce_less(head, share):  # type: ignore[no-untyped-def]
    """Ask for a ``share`` of the bounces of a group."""
    c = head
    while c != 0:
        t = views.control(c)
        touches = views.touches(t)
        for k in range(t[at.CONTACTS]):
            touches[k, WANTED] = min(touches[k, WANTED], share * touches[k, WANTED])
        c = t[at.NEXT]
