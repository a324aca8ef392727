"""How far velocities have carried bodies when a step begins.

Chipmunk moves bodies at the start of a step, with its length h and the velocities with which the last one ended, whose
length h' was another one, maybe. Implicit Euler found forces for q + h' V, and plastic flow; carried on to q + h V
instead, joints yield once more, or are thrown back. A step that is r times as short as the last one would start with
r - 1 times its velocities, in stiff joints. The average-acceleration rule keeps energies between the middles of moves:
the one that begins at the middle of the last move lies ½ h V behind where the bodies are to be. So they are to be moved

    by h' V in implicit Euler, and by ½ (h + h') V in the average-acceleration rule,

and where it was h V, the rest is made up for; of a structure that nothing holds, in the motion of its bodies relative
to their centre of mass, which leaves its angular momentum alone; and nothing while something touches it, for that would
be left behind. Only to the end of the last part where the second-order scheme comes from parts after a blow by contact:
what moves so soon after it is faster than whole steps resolve, and half a whole step of it tears stiff joints open.

And where a step by implicit Euler follows one by the average-acceleration rule, which is wanted, what moves faster than
these steps resolve goes back to the middle of its last move. There it has the energy that the ledger knows; half a move
further on it would have (ωh)²/4 times as much as moves.
"""

import math

import numpy as np

from sim.chipmunk import BODY_WORDS, SPIN, VX, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.bodies import move, store_velocities
from sim.kernels.guard import relative_velocity, rigid_motion
from sim.kernels.inertia import mass_of, moment_of
from sim.kernels.kinematics import prepare
from sim.kernels.layout import BEFORE, BETA, LEDGER_KINETIC, MOMENT, MOVE, UNDAMPED, UNEVEN
from sim.kernels.resolved import loss_of_joints
from sim.memory import floats, inlined, kernel

# Over the step: what is rounding.
_SAME = 1e-9
# (ωh)² of what a step does not resolve.
_FAST = 1.0


@inlined
def carry(t, h, last_move, moved, touching):  # type: ignore[no-untyped-def]
    """Have bodies that have ``moved`` for so long moved as far as they should be, and note how long that is."""
    settings = views.settings(t)
    if t[at.CARRYING] == 1:
        clear(views.per_body(t, at.CARRIED))
        t[at.CARRYING] = 0
    settings[MOVE] = moved
    if last_move > 0.0 and abs(h - last_move) > _SAME * h:
        settings[UNEVEN] = 1.0
    as_it_was = settings[BETA] == 0.0 or (settings[UNDAMPED] == 0.0 and t[at.AFTER_PARTS] == 1)
    rest = (last_move if as_it_was else 0.5 * (last_move + h)) - moved
    if last_move == 0.0 or abs(rest) <= _SAME * h or touching or t[at.CONTACTS] != 0:
        return
    last = views.per_body(t, at.LAST_VELOCITY)
    for i in range(t[at.MOVING], t[at.BODIES]):
        if last[i, 0] != 0.0 or last[i, 1] != 0.0 or last[i, 2] != 0.0:
            return
    t[at.CARRYING] = 1
    carried = views.per_body(t, at.CARRIED)
    for i in range(t[at.MOVING]):
        for axis in range(3):
            carried[i, axis] = rest * last[i, axis]
    shift_all(t, carried)
    settings[MOVE] = last_move if as_it_was else h


@kernel
def come_back(t):  # type: ignore[no-untyped-def]
    """Have bodies come back to the middle of their last move, if they swing faster than such moves resolve."""
    settings, last = views.settings(t), views.per_body(t, at.LAST_VELOCITY)
    if loss_of_joints(t, last) <= _FAST * views.ledger(t)[LEDGER_KINETIC]:
        return
    carried, way = views.per_body(t, at.CARRIED), np.empty((t[at.MOVING], 3))
    for i in range(t[at.MOVING]):
        for axis in range(3):
            way[i, axis] = -0.5 * settings[MOVE] * last[i, axis]
    shift_all(t, way)
    for i in range(t[at.MOVING]):
        for axis in range(3):
            carried[i, axis] += way[i, axis]
    t[at.CARRYING], settings[MOVE] = 1, 0.0
    prepare(t)


@kernel
def carry_on(t, time):  # type: ignore[no-untyped-def]
    """Have the last velocities move the bodies for so much longer."""
    last, way = views.per_body(t, at.LAST_VELOCITY), np.empty((t[at.MOVING], 3))
    for i in range(t[at.MOVING]):
        for axis in range(3):
            way[i, axis] = time * last[i, axis]
    shift_all(t, way)


@kernel
def go_with_support(t, time):  # type: ignore[no-untyped-def]
    """Move the bodies for so long as the first support that moves takes them along, by which no joint is deformed."""
    body_at = views.body_at(t)
    for k in range(t[at.MOVING], t[at.BODIES]):
        s = floats(body_at[k], BODY_WORDS)
        if s[VX] != 0.0 or s[VX + 1] != 0.0 or s[SPIN] != 0.0:
            for i in range(t[at.MOVING]):
                b = floats(body_at[i], BODY_WORDS)
                u, v = s[VX] - s[SPIN] * (b[X + 1] - s[X + 1]), s[VX + 1] + s[SPIN] * (b[X] - s[X])
                move(body_at[i], time * u, time * v, time * s[SPIN])
            return


@kernel
def shift_all(t, way):  # type: ignore[no-untyped-def]
    """Move the bodies by their ``way``, which becomes one that leaves the centre of what nothing holds where it is.

    Its angular momentum stays, too, where bodies have been given other velocities than those they are moved by.
    """
    body_at, start, gained = views.body_at(t), views.per_body(t, at.START_VELOCITY), 0.0
    x, y, u, v, _ = rigid_motion(t, way)
    frame = x, y, u, v, 0.0
    for i in range(t[at.MOVING]):
        way[i, 0], way[i, 1], way[i, 2] = relative_velocity(body_at[i], way[i], frame)
        move(body_at[i], way[i, 0], way[i, 1], way[i, 2])
        gained += mass_of(floats(body_at[i], BODY_WORDS)) * (way[i, 0] * start[i, 1] - way[i, 1] * start[i, 0])
    if t[at.FREE] == 1 and gained != 0.0:
        turn_all(t, -gained)


@kernel
def turn_all(t, moment):  # type: ignore[no-untyped-def]
    """Give what nothing holds an angular momentum as a rigid body, by which no joint is deformed."""
    body_at, start, velocity = views.body_at(t), views.per_body(t, at.START_VELOCITY), views.per_body(t, at.VELOCITY)
    cx, cy, _, _, _ = rigid_motion(t, start)
    inertia = 0.0
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        x, y = b[X] - cx, b[X + 1] - cy
        inertia += mass_of(b) * (x * x + y * y) + moment_of(b)
    turn = moment / inertia
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        x, y = b[X] - cx, b[X + 1] - cy
        for of in (start, velocity):
            of[i, 0] -= turn * y
            of[i, 1] += turn * x
            of[i, 2] += turn
    store_velocities(t, start)


@kernel
def turn_back(t):  # type: ignore[no-untyped-def]
    """Give a new structure that nothing holds the angular momentum that its bodies had, once.

    What was joined to others in flight has been put to where they have taken it, which is not on the line of its own
    velocity.
    """
    body_at, start, settings = views.body_at(t), views.per_body(t, at.START_VELOCITY), views.settings(t)
    missing = settings[MOMENT]
    settings[MOMENT], settings[BEFORE + MOMENT] = math.nan, math.nan
    for i in range(t[at.MOVING]):
        b = floats(body_at[i], BODY_WORDS)
        missing -= mass_of(b) * (b[X] * start[i, 1] - b[X + 1] * start[i, 0]) + moment_of(b) * start[i, 2]
    if t[at.FREE] == 1:
        turn_all(t, missing)


@kernel
def way_to_line(x, y, u, v, vx, vy):  # type: ignore[no-untyped-def]
    """The shortest way from x, y to the line on which what is at u, v moves with the velocity vx, vy."""
    speed = math.hypot(vx, vy)
    if speed == 0.0:
        return 0.0, 0.0
    dx, dy = vx / speed, vy / speed
    across = (v - y) * dx - (u - x) * dy
    return -across * dy, across * dx
