"""Where along a push the load is quoted: legs from one turning point to the next, with points closer where it bends."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np


def even_legs(stops: Sequence[float], points: int) -> list[np.ndarray]:
    """Displacements [m] from 0 through ``stops``, each leg in ``points`` equal steps and without its start."""
    return [np.linspace(a, b, points + 1)[1:] for a, b in itertools.pairwise((0.0, *stops))]


def resolved_legs(stops: Sequence[float], legs: Sequence[np.ndarray], load: np.ndarray) -> list[np.ndarray]:
    """Legs with points closer where the curve bends, where a first path got through them all.

    Parameters
    ----------
    stops : sequence of float
        Turning points, the last of which is the end [m].
    legs : sequence of (k,) float
        Displacements of the first path [m].
    load : (n,) float
        Its loads, the first at displacement 0; fewer than the legs ask for where it stopped.
    """
    resolved: list[np.ndarray] = []
    first = 0
    for start, leg in zip((0.0, *stops), legs, strict=False):
        along = load[first : first + len(leg) + 1]
        first += len(leg)
        if len(along) <= len(leg):
            resolved.append(leg)
            continue
        sign = np.sign(leg[-1] - start)
        resolved.append(start + sign * _resolved(sign * (np.append(start, leg) - start), along)[1:])
        resolved[-1][-1] = leg[-1]
    return resolved


def with_events(leg: np.ndarray, events: Sequence[float]) -> np.ndarray:
    """``leg`` with points at ``events`` [m] and halfway between them, so that each is alone on a straight piece."""
    at = np.unique(events)
    found = np.unique(np.concatenate([leg, at, 0.5 * (at[1:] + at[:-1])]))
    return np.asarray(found[(found > 0.0) & (found <= leg[-1])])


def _resolved(distance: np.ndarray, load: np.ndarray) -> np.ndarray:
    """As many distances again, closer where the curve bends, so that straight lines between them follow it.

    The error of a chord is h² |F''| / 8, so steps go with |F''|^(-1/2); half of the points are spread evenly.
    """
    bend = np.abs(np.gradient(np.gradient(load, distance), distance))
    density = np.sqrt(np.convolve(bend, np.full(5, 0.2), mode="same"))
    density = density / np.trapezoid(density, distance) + 1.0 / distance[-1]
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(distance)
    share = np.append(0.0, np.cumsum(steps))
    resolved: np.ndarray = np.interp(np.linspace(0.0, share[-1], len(distance)), share, distance)
    return resolved
