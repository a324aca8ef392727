"""How far velocities have carried bodies when a step begins.

Chipmunk moves bodies at the start of a step, with its length h and the velocities with which the last one ended, whose
length h' was another one, maybe. Implicit Euler found forces for q + h' V, and plastic flow; carried on to q + h V
instead, joints yield once more, or are thrown back. A step that is r times as short as the last one would start with
r - 1 times its velocities, in stiff joints. The average-acceleration rule keeps energies between the middles of moves:
the one that begins at the middle of the last move lies ½ h V behind where the bodies are to be. So they are to be moved

    by h' V in implicit Euler, and by ½ (h + h') V in the average-acceleration rule,

and where it was h V, the rest is made up for; of a structure that nothing holds, in the motion of its bodies relative
to their centre of mass, which leaves its angular momentum alone; and nothing while something touches it, for that would
be left behind. Nothing either where the second-order scheme comes from the parts of a step (`parts.py`): what moves so
soon after a blow is faster than whole steps resolve, and half a whole step of it tears stiff joints open.
"""

import math

import numpy as np

from sim.chipmunk import BODY_WORDS, X
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.bare import clear
from sim.kernels.bodies import move
from sim.kernels.guard import relative_velocity, rigid_motion
from sim.kernels.inertia import mass_of
from sim.kernels.layout import BETA, MOVE, UNEVEN, WANTED_BETA
from sim.memory import floats, inlined, kernel

# Over the step: what is rounding.
_SAME = 1e-9


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
    implicit = settings[BETA] == 0.0
    rest = (last_move if implicit else 0.5 * (last_move + h)) - moved
    if last_move == 0.0 or abs(rest) <= _SAME * h or touching or t[at.CONTACTS] != 0:
        return
    if settings[WANTED_BETA] != 0.0 and not implicit and t[at.AFTER_PARTS] == 1:
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
    settings[MOVE] = last_move if implicit else h


@kernel
def carry_on(t, time):  # type: ignore[no-untyped-def]
    """Have the last velocities move the bodies for so much longer."""
    last, way = views.per_body(t, at.LAST_VELOCITY), np.empty((t[at.MOVING], 3))
    for i in range(t[at.MOVING]):
        for axis in range(3):
            way[i, axis] = time * last[i, axis]
    shift_all(t, way)


@kernel
def shift_all(t, way):  # type: ignore[no-untyped-def]
    """Move the bodies by their ``way``, which becomes one that leaves the centre of what nothing holds where it is."""
    body_at = views.body_at(t)
    x, y, u, v, _ = rigid_motion(t, way)
    frame = x, y, u, v, 0.0
    for i in range(t[at.MOVING]):
        way[i, 0], way[i, 1], way[i, 2] = relative_velocity(body_at[i], way[i], frame)
        move(body_at[i], way[i, 0], way[i, 1], way[i, 2])


@kernel
def keep_moment(t, places):  # type: ignore[no-untyped-def]
    """Have a free structure's bodies the same angular momentum at ``places`` as where they are, with their velocities.

    Places are shifted for it, all alike so that their centre of mass is on the line along which it moves, and each
    across its body's velocity u relative to that centre, by λ |u|, which leaves the centre where it is. With D how far
    bodies are from their ``places``, λ = Σ m D×u / Σ m u²; by Cauchy's inequality the shifts are no more than D, in the
    root of the mean square weighed by mass.
    """
    body_at, moving, velocity = views.body_at(t), t[at.MOVING], views.per_body(t, at.LAST_VELOCITY)
    cx, cy, vx, vy, _ = rigid_motion(t, velocity)
    missing, square, mass, x, y = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(moving):
        b = floats(body_at[i], BODY_WORDS)
        u, v, m = velocity[i, 0] - vx, velocity[i, 1] - vy, mass_of(b)
        missing += m * ((b[X] - places[i, 0]) * v - (b[X + 1] - places[i, 1]) * u)
        square += m * (u * u + v * v)
        mass, x, y = mass + m, x + m * places[i, 0], y + m * places[i, 1]
    share = missing / square if square > 0.0 else 0.0
    x, y = way_to_line(x / mass, y / mass, cx, cy, vx, vy)
    for i in range(moving):
        places[i, 0] += x + share * (velocity[i, 1] - vy)
        places[i, 1] += y - share * (velocity[i, 0] - vx)


@kernel
def way_to_line(x, y, u, v, vx, vy):  # type: ignore[no-untyped-def]
    """The shortest way from x, y to the line on which what is at u, v moves with the velocity vx, vy."""
    speed = math.hypot(vx, vy)
    if speed == 0.0:
        return 0.0, 0.0
    dx, dy = vx / speed, vy / speed
    across = (v - y) * dx - (u - x) * dy
    return -across * dy, across * dx
