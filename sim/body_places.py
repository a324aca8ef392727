"""Where a structure's bodies are put when others take their joints over."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import pymunk

from sim import chipmunk
from sim.kernels import layout as at
from sim.tables import Tables


def carry_along(moved: dict[pymunk.Body, np.ndarray], pairs: Iterable[tuple[pymunk.Body, pymunk.Body]]) -> None:
    """Give dynamic bodies that are joined, in ``pairs``, to what has ``moved`` its velocities where they are.

    Velocities are x, y [m/s] and spin [rad/s], of centres of mass; those of more bodies are added to ``moved``.
    """
    partners: dict[pymunk.Body, list[pymunk.Body]] = {}
    for a, b in pairs:
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    carriers = [body for body in moved if body in partners]
    for carrier in carriers:  # which grow in number
        vx, vy, spin = moved[carrier].tolist()
        for body in partners[carrier]:
            if body not in moved and body.body_type == pymunk.Body.DYNAMIC:
                x, y = _centre(body) - _centre(carrier)
                moved[body] = np.array([vx - spin * y, vy + spin * x, spin])
                carriers.append(body)


def put_forth(bodies: Sequence[pymunk.Body], tables: Tables) -> None:
    """In a step that has begun, put bodies to where their velocities have led them; see `sim.kernels.bodies.arrive`.

    Impulses since the last step are not known any more then.
    """
    step, given = float(tables[at.SETTINGS][at.STEP]), tables[at.START_VELOCITY] - tables[at.LAST_VELOCITY]
    for i, body in enumerate(bodies):
        if body.body_type == pymunk.Body.DYNAMIC and given[i].any():
            x, y, turn = (step * given[i]).tolist()
            body.position += pymunk.Vec2d(x, y)
            body.angle += turn
            tables[at.LAST_FORCE][i] -= np.array([body.mass, body.mass, body.moment]) * given[i] / step


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
