"""Where a structure's bodies are put when others take their joints over."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import pymunk

from sim import chipmunk
from sim.kernels import layout as at
from sim.tables import Tables


def carry_along(
    moved: dict[pymunk.Body, np.ndarray],
    aside: dict[pymunk.Body, np.ndarray],
    pairs: Iterable[tuple[pymunk.Body, pymunk.Body]],
) -> None:
    """Give dynamic bodies that are joined, in ``pairs``, to what has ``moved`` its velocities where they are.

    Velocities are x, y [m/s] and spin [rad/s], of centres of mass; those of more bodies are added to ``moved``. What
    was led ``aside`` of that, by x, y [m] and an angle [rad], has taken them along.
    """
    partners: dict[pymunk.Body, list[pymunk.Body]] = {}
    for a, b in pairs:
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    carriers = [body for body in moved if body in partners]
    for carrier in carriers:  # which grow in number
        for body in partners[carrier]:
            if body not in moved and body.body_type == pymunk.Body.DYNAMIC:
                arm = _centre(body) - _centre(carrier)
                moved[body] = _carried(moved[carrier], arm)
                if carrier in aside:
                    aside[body] = _carried(aside[carrier], arm)
                    x, y, turn = aside[body].tolist()
                    body.position += pymunk.Vec2d(x, y)
                    body.angle += turn
                carriers.append(body)


def _carried(motion: np.ndarray, arm: pymunk.Vec2d) -> np.ndarray:
    """What a rigid motion x, y and turn of a point is at the end of an ``arm`` [m] from it."""
    x, y, turn = motion.tolist()
    return np.array([x - turn * arm.y, y + turn * arm.x, turn])


def led_aside(tables: Tables) -> np.ndarray:
    """By how much the last step leads bodies past where their velocities do, if it was taken in parts, (bodies, 3)."""
    aside = np.zeros_like(tables[at.LAST_POSITION])
    if tables.control[at.PARTS] > 1:
        moving = slice(int(tables.control[at.MOVING]))
        aside[moving] = tables[at.LAST_POSITION][moving] - tables[at.BEGUN_AT][moving]
    return aside


def put_even(bodies: Sequence[pymunk.Body], tables: Tables) -> float:
    """After a step in parts, put bodies to where velocities alone lead on; see `sim.kernels.parts.close_step`.

    Returns in how long from then on they are where the last part began [s].
    """
    settings = tables[at.SETTINGS]
    if tables.control[at.PARTS] > 1:
        tables[at.BEGUN_AT][:] = tables[at.LAST_POSITION]
        for i, body in enumerate(bodies):
            if body.body_type == pymunk.Body.DYNAMIC:
                x, y, angle = tables[at.LAST_POSITION][i].tolist()
                body.position, body.angle = (x, y), angle
                chipmunk.push_apart(body, tables[at.SHIFT][i, :3])
    return float(settings[at.WHOLE_STEP] - settings[at.NEXT_MOVE])


def _centre(body: pymunk.Body) -> pymunk.Vec2d:
    return body.local_to_world(body.center_of_gravity)
