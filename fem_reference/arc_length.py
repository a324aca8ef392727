"""Paths that neither a displacement nor a load can lead along: the arc-length method.

E. Riks, An incremental approach to the solution of snapping and buckling problems, Int. J. Solids Struct. 15 (1979).
From a point (d, λ) with the tangent t = K⁻¹ p, the next lies where the plane at a distance s along t, and normal to it,
meets the path:

    F_int(d + Δd) = W + (λ + Δλ) p,   t · Δd / |t| = s.

Lengths are those of displacements alone, so it passes limit points, where Δλ changes its sign, and snap-back, where
the displacement of the pushed node does. The sense of t is that in which the last step went.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_reference.paths import NotConverged, State, Trace

#: Steps in which the pushed node would come to its end if the path were straight, and the most that are taken.
_STEPS, _MOST_STEPS = 100, 3000
_SMALLEST_CUT = 2.0**-12


def follow_arc(
    state: State, points: Trace, distance: float, watch: Callable[[float], None] = lambda share: None
) -> None:
    """Extend ``points`` from ``state`` until the displacement under control is ``distance`` [m] for the first time.

    Raises
    ------
    NotConverged
        When the smallest step finds no equilibrium, or the path is too long.
    """
    frame, free = state.frame, state.solver.free
    moves = np.zeros(frame.size)
    for axis in (0, 1):
        moves[frame.dofs_of(axis)] = 1.0
    start = state.position
    last = state.control * np.sign(distance)
    length, share = 0.0, 1.0
    for _ in range(_MOST_STEPS):
        tangent = np.zeros(frame.size)
        response = state.response
        tangent[free] = state.solver.solve(response.matrices, response.springs, frame.pattern[free])[:, 0]
        size = np.sqrt(float(moves @ tangent**2))
        sense = np.sign(float((moves * tangent) @ last)) or 1.0
        direction = sense * tangent / size
        if not length:
            length = abs(distance / float(state.control @ direction)) / _STEPS
        before = state.displacement
        while True:
            state.slope = (direction, sense / size)
            normal = moves * direction
            if state.step_to(float(normal @ before) + share * length, normal):
                break
            share *= 0.5
            if share < _SMALLEST_CUT:
                raise NotConverged(f"no equilibrium beyond a displacement of {state.position - start:.6g} m")
        share = min(1.0, 2.0 * share)
        last = state.displacement - before
        state.record(points, start)
        way = (state.position - start) / distance
        watch(min(max(way, 0.0), 1.0))
        if way >= 1.0:
            return
    raise NotConverged(f"the path is longer than {_MOST_STEPS} steps")
