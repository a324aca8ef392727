"""No energy from nowhere: what closes the ledger's numerical dissipation from below.

Directions of forces are those of a step's start, and a joint's force may turn round from one step to the next while the
move between was made against the old one. The numerical dissipation shows what that creates: where bodies turn by an
angle φ in a step under compression, a share of φ² of the energy, and where a yielding joint is thrown back, up to the
plastic work of its last move. Taking out overlap may give energy, too; what contacts give beyond what they took is
booked with it. Four things keep it from being negative in implicit Euler, one after the other:

- work from outside counts along the mean velocity of the step, and not along moves of other lengths;
- a contact's impulse that also balances joints within the step has lost no more in an impact than there was, and
  damping has taken no more;
- what the step has created is taken out of the motion of the bodies relative to each other again: velocities go towards
  those of the structure moving as a rigid body, or towards rest if it is held, which leaves both momenta of a free
  structure as they are;
- where there is too little motion for that, as after a step that did not converge, plastic work is not booked until
  dissipation has caught up with it.

The average-acceleration rule neither dissipates nor creates where the step resolves the motion, and its numerical entry
goes up and down a little. Pieces that turn by a radian in a step make it create ever more energy. So where any turns by
more than a quarter of that, steps are taken by implicit Euler, and also once a tenth of the ledger's largest entry has
been created, until that is gone; a step that would create more than a tenth of the most that outer forces had done by
then has the rest taken out as above. Parts by it after impulses are kept from creating any, as implicit Euler is.
"""

import math

from sim.chipmunk import BODY_WORDS, SPIN, VX, X, Y
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bodies import load_velocities
from sim.kernels.inertia import as_rigid_body, mass_of, moment_of
from sim.kernels.layout import (
    AFTER_IMPULSES,
    BEFORE,
    BETA,
    BLOW,
    BLOW_AGE,
    DELTA,
    LARGEST,
    LEDGER_CONTACT,
    LEDGER_EXTERNAL,
    LEDGER_KINETIC,
    LEDGER_NUMERICAL,
    LEDGER_OWED,
    LEDGER_PLASTIC,
    LEDGER_VISCOUS,
    UNDAMPED,
    WANTED_BETA,
    WANTED_DELTA,
    WHOLE_STEP,
)
from sim.kernels.lengths import LONGEST_PART
from sim.kernels.resolved import is_slow
from sim.memory import floats, inlined, kernel

# β of the average-acceleration rule.
_AVERAGE = 0.25
# Shares of the ledger's largest entry: what is rounding, and what the average-acceleration rule may create; and by how
# much bodies may turn in its steps [rad].
_ROUNDING, _BOUND, _TURN = 1e-13, 0.1, 0.25


@inlined
def choose_scheme(t, turn):  # type: ignore[no-untyped-def]
    """Time integration of a step or its parts, in which no body is to turn by more than ``turn``.

    That is the wanted one, or implicit Euler where the average-acceleration rule would fail; and that rule in place of
    implicit Euler while a blow lasts that is not to be damped, in steps or parts no longer than the longest of them.
    """
    settings, ledger = views.settings(t), views.ledger(t)
    beta, delta = settings[WANTED_BETA], settings[WANTED_DELTA]
    if beta == 0.0:
        short = t[at.PARTS] > 1 or (settings[BLOW] > 0.0 and settings[WHOLE_STEP] <= LONGEST_PART)
        if settings[UNDAMPED] > 0.0 and short and t[at.CONTACTS] == 0 and turn <= _TURN and may_swing(t):
            # What is set going at once begins with a jump, by which joints that yield would be left strained.
            beta, delta = _AVERAGE, 1.0 - settings[UNDAMPED] if settings[BLOW_AGE] > 0.0 else 0.0
    else:
        largest = max(ledger[LEDGER_KINETIC], abs(ledger[LEDGER_EXTERNAL]))
        least = -_BOUND * largest if settings[BETA] != 0.0 else 0.0
        if ledger[LEDGER_NUMERICAL] < least or turn > _TURN:
            beta, delta = 0.0, 1.0
        elif followed_in_parts(t) and settings[BLOW_AGE] > 0.0:
            delta = max(delta, 1.0 - settings[UNDAMPED])
    settings[BETA], settings[DELTA] = beta, delta


@inlined
def followed_in_parts(t):  # type: ignore[no-untyped-def]
    """Whether parts are taken by the average-acceleration rule, which is wanted, after impulses."""
    settings = views.settings(t)
    return t[at.PARTS] > 1 and settings[BLOW] > 0.0 and settings[UNDAMPED] == AFTER_IMPULSES


@kernel
def may_swing(t):  # type: ignore[no-untyped-def]
    """Whether what came suddenly is to be followed without damping; after forces, once what is stiff has settled."""
    settings = views.settings(t)
    if settings[UNDAMPED] == AFTER_IMPULSES:
        return True
    if settings[BLOW_AGE] == 0.0:
        return False
    return settings[BETA] != 0.0 or settings[BEFORE + BETA] != 0.0 or is_slow(t)


@kernel
def choose_for_part(t, h):  # type: ignore[no-untyped-def]
    """Time integration of a part of length ``h`` that begins with the start velocities; whether it is averaged."""
    start, spin = views.per_body(t, at.START_VELOCITY), 0.0
    for i in range(t[at.MOVING]):
        spin = max(spin, abs(start[i, 2]))
    choose_scheme(t, h * spin)
    return views.settings(t)[BETA] != 0.0


@inlined
def close_from_below(t, contact, viscous, numerical, less):  # type: ignore[no-untyped-def]
    """Keep numerical dissipation from being negative; the ledger's entries as they were before this step [J].

    Work from outside that was booked ``less`` for moves of other lengths is booked where it is needed.
    """
    ledger = views.ledger(t)
    if ledger[LEDGER_CONTACT] < 0.0:
        ledger[LEDGER_NUMERICAL] += ledger[LEDGER_CONTACT]
        ledger[LEDGER_CONTACT] = 0.0
    settings = views.settings(t)
    # Where the average-acceleration rule is wanted, its own entry goes up and down; what a step that is longer than the
    # last one has created is taken back as soon as it moves.
    least = min(numerical, 0.0) if settings[WANTED_BETA] != 0.0 else 0.0
    if settings[BETA] != 0.0 and settings[WANTED_BETA] != 0.0 and not followed_in_parts(t):
        settings[LARGEST] = max(settings[LARGEST], abs(ledger[LEDGER_EXTERNAL]))
        least = min(least, -_BOUND * settings[LARGEST])
    given = max(min(least - ledger[LEDGER_NUMERICAL], less), 0.0)
    ledger[LEDGER_EXTERNAL] += given
    ledger[LEDGER_NUMERICAL] += given
    if ledger[LEDGER_NUMERICAL] >= least:
        paid = min(ledger[LEDGER_OWED], max(ledger[LEDGER_NUMERICAL], 0.0))
        ledger[LEDGER_OWED] -= paid
        ledger[LEDGER_PLASTIC] += paid
        ledger[LEDGER_NUMERICAL] -= paid
        return
    move_between(ledger, LEDGER_CONTACT, ledger[LEDGER_CONTACT] - contact, least)
    move_between(ledger, LEDGER_VISCOUS, ledger[LEDGER_VISCOUS] - viscous, least)
    largest = max(ledger[LEDGER_KINETIC], abs(ledger[LEDGER_EXTERNAL]))
    take_out(t, min(-_ROUNDING * largest, least) - ledger[LEDGER_NUMERICAL])
    ledger[LEDGER_OWED] += move_between(ledger, LEDGER_PLASTIC, ledger[LEDGER_PLASTIC], least)


@inlined
def move_between(ledger, entry, most, least):  # type: ignore[no-untyped-def]
    """Move what numerical dissipation lacks to its ``least`` from an ``entry``, at the ``most``; returns how much."""
    moved = max(min(least - ledger[LEDGER_NUMERICAL], most), 0.0)
    ledger[entry] -= moved
    ledger[LEDGER_NUMERICAL] += moved
    return moved


@kernel
def take_out(t, energy):  # type: ignore[no-untyped-def]
    """Take ``energy`` [J] out of the relative motion of a structure's bodies, as far as there is any."""
    if energy <= 0.0:
        return
    body_at, moving, velocity = views.body_at(t), t[at.MOVING], views.per_body(t, at.SOLUTION)
    load_velocities(body_at, velocity)
    frame, inner = rigid_motion(t, velocity), 0.0
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        u, v, w = relative_velocity(body_at[i], velocity[i], frame)
        inner += 0.5 * (mass_of(b) * (u * u + v * v) + moment_of(b) * w * w)
    taken = min(energy, inner)
    if taken > 0.0:
        less = 1.0 - math.sqrt(1.0 - taken / inner)
        for i in range(moving):
            b = floats(body_at[i], BODY_WORDS)
            u, v, w = relative_velocity(body_at[i], velocity[i], frame)
            b[VX] -= less * u
            b[VX + 1] -= less * v
            b[SPIN] -= less * w
        ledger = views.ledger(t)
        ledger[LEDGER_KINETIC] -= taken
        ledger[LEDGER_NUMERICAL] += taken
    for i in range(moving, t[at.BODIES]):
        for axis in range(3):
            velocity[i, axis] = 0.0


@kernel
def rigid_motion(t, velocity):  # type: ignore[no-untyped-def]
    """The rigid motion with a structure's momenta at velocities (bodies, 3): its centre, its velocity and its spin.

    Rest, if something holds it.
    """
    vx, vy, turn = 0.0, 0.0, 0.0
    if t[at.FREE] == 0:
        return 0.0, 0.0, vx, vy, turn
    body_at, moving = views.body_at(t), t[at.MOVING]
    mass, x, y, inertia = as_rigid_body(t)
    for i in range(moving):
        m = mass_of(floats(body_at[i], BODY_WORDS))
        vx, vy = vx + m * velocity[i, 0], vy + m * velocity[i, 1]
    vx, vy = vx / mass, vy / mass
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        m, dx, dy = mass_of(b), b[X] - x, b[X + 1] - y
        turn += moment_of(b) * velocity[i, 2] + m * (dx * (velocity[i, 1] - vy) - dy * (velocity[i, 0] - vx))
    return x, y, vx, vy, turn / inertia


@kernel
def relative_velocity(body, velocity, frame):  # type: ignore[no-untyped-def]
    """A body's ``velocity`` and spin relative to a `rigid_motion`."""
    x, y, vx, vy, turn = frame
    b = floats(body, BODY_WORDS)
    return velocity[0] - vx + turn * (b[Y] - y), velocity[1] - vy - turn * (b[X] - x), velocity[2] - turn
