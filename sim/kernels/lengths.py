"""How long the parts of a step are while a blow lasts, and for how long forces act in each.

Implicit Euler damps what a part does not resolve. Where something strikes, short waves run first, and long ones are
left of them: parts begin short, and are a share of the blow's age from then on. A force from outside is known for a
step only, and does not come any faster; a joint that is as good as rigid is not to ring from it. What it sets going is
taken in the longest parts, all alike.

Velocities belong to the middle of the moves that they make (see `energy`). From a move of h₀ to one of h₁ it is
½ (h₀ + h₁), and for so long the forces of the part act that ends with the latter,

    λ = -½ (h₀ + h₁) s(q + h₁ J V).

With h₁ instead, what speeds up while parts grow would gain energy, ½ (h₁ - h₀) times the power that speeds it up. So
that these times sum up to the step's, its last part is as long as the move before its first: the shortest.

The average-acceleration rule keeps energies between the middles of moves. With forces that act for h₁ and then h₂ the
velocities between move bodies for ½ (h₁ + h₂), and no energy is gained or lost, whatever the lengths. After what has
been set going these parts begin as short as after a blow.

Implicit Euler damps what whole steps do not resolve once the blow is over. Where the average-acceleration rule is
wanted for these, too, parts grow to them, by a quarter of the time since the blow was over. The velocities of one part
then lead to where the next one is to begin, see `moves`, without tearing at what that does not resolve; and the little
damping takes such waves out on the way. Of a vibration of twenty steps a period half a per cent of the energy is lost,
where going over at once would cost, or give, up to half of the angle by which it turns in a step, a sixth.

Where bodies turn by φ in a move, they end by a share of φ² from where joints would have them, and the next part puts
that right within its length. After whole steps in which they turn much, parts begin longer.
"""

import math

import numpy as np

from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.layout import AFTER_IMPULSES, BLOW_AGE, MOVE, OVER_AT, SHORTEST, UNDAMPED, WANTED_BETA
from sim.memory import kernel

# Lengths of parts [s], and of the blow's age.
_LEAST, LONGEST_PART, _OF_AGE = 0.05e-3, 0.5e-3, 0.05
# Shortest part where the average-acceleration rule is wanted for all steps [s]; of the time since its blow was over.
_LEAST_WANTED, _OF_TIME_AFTER = 0.1e-3, 0.25
# After a move in which bodies turned by this angle, all parts are of the longest [rad].
_TURN = 0.1
_ROUNDING = 1e-6
# Parts of a step, which are longer where that has to be: of steps of a second and more.
_MOST = 2000


@kernel
def note_shortest(head, struck):  # type: ignore[no-untyped-def]
    """Note how long the shortest part of a group's steps is to be from now on; whether it was ``struck``."""
    shortest, c = _LEAST if struck else LONGEST_PART, head
    while c != 0:
        settings = views.settings(views.control(c))
        if struck and settings[WANTED_BETA] != 0.0:
            shortest = LONGEST_PART
        elif not struck and settings[UNDAMPED] == AFTER_IMPULSES:
            shortest = _LEAST if settings[WANTED_BETA] == 0.0 else _LEAST_WANTED
        c = views.control(c)[at.NEXT]
    c = head
    while c != 0:
        t = views.control(c)
        last, settings = views.per_body(t, at.LAST_VELOCITY), views.settings(t)
        for i in range(t[at.MOVING]):
            turn = last[i, 2] * settings[MOVE]
            shortest = max(shortest, min((turn / _TURN) ** 2, 1.0) * LONGEST_PART)
        c = t[at.NEXT]
    c = head
    while c != 0:
        t = views.control(c)
        settings = views.settings(t)
        settings[SHORTEST] = shortest
        if struck:
            settings[UNDAMPED] = 0.0
        c = t[at.NEXT]


@kernel
def shortest_of(settings):  # type: ignore[no-untyped-def]
    """How long the first and the last part of a step are [s]; what joins a group during a blow has noted nothing."""
    return max(settings[SHORTEST], _LEAST)


@kernel
def longest(settings, age):  # type: ignore[no-untyped-def]
    """How long a part may be when the blow is of this ``age`` [s]."""
    after = _OF_TIME_AFTER * (age - settings[OVER_AT]) if settings[OVER_AT] > 0.0 else 0.0
    return max(min(_OF_AGE * age, LONGEST_PART), shortest_of(settings), after)


@kernel
def part_lengths(settings, span):  # type: ignore[no-untyped-def]
    """Lengths of the moves that end the parts of a ``span`` of time, and for how long forces act in each [s]."""
    last = shortest_of(settings)
    if last >= LONGEST_PART or span > _MOST * LONGEST_PART:
        count = min(math.ceil(span / LONGEST_PART - _ROUNDING), _MOST)
        return np.full(count, span / count), np.full(count, span / count)
    rest, reached, count = span - last, 0.0, 0
    moves = np.empty(math.ceil(span / last) + 1)
    while reached < rest:
        moves[count] = min(longest(settings, settings[BLOW_AGE] + reached), LONGEST_PART)
        reached += moves[count]
        count += 1
    # What they go too far by is taken from what they are longer than the shortest; if they are not, from their number.
    more = reached - count * last
    if rest > count * last:
        moves[:count] = last + (moves[:count] - last) * ((rest - count * last) / more)
    else:
        count = max(int(rest / last + _ROUNDING), 1)
        moves[:count] = rest / count
    moves[count] = last
    moves, steps = moves[: count + 1], np.empty(count + 1)
    for i in range(count + 1):
        steps[i] = 0.5 * (moves[i - 1] + moves[i])
    return moves, steps


@kernel
def averaged_lengths(settings, span):  # type: ignore[no-untyped-def]
    """The same for parts by the average-acceleration rule."""
    reached, count = 0.0, 0
    steps = np.empty(math.ceil(span / shortest_of(settings)) + 1)
    while reached < span * (1.0 - _ROUNDING):
        steps[count] = longest(settings, settings[BLOW_AGE] + reached)
        reached += steps[count]
        count += 1
    steps = steps[:count] * (span / reached)
    moves = steps.copy()
    for i in range(count - 1):
        moves[i] = 0.5 * (steps[i] + steps[i + 1])
    return moves, steps
