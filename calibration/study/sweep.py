"""Working through the points of a study: nothing is computed twice, and nothing lost when a process dies."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from typing import Any

from calibration.study.executors import Workers
from calibration.study.journal import Journal
from calibration.study.points import Point

#: Tasks in hand for each worker: one at work, one waiting.
_IN_HAND = 2
#: How often a point that ends with its process's death is tried by itself before it counts as failed.
_TRIES = 2
_DIED = {"failure": "its process died"}

Measure = Callable[[Point], dict[str, Any]]
Watch = Callable[[Point], None]


def sweep(points: Mapping[str, Point], measure: Measure, workers: Workers, journal: Journal, watch: Watch) -> None:
    """Measure all ``points`` (by key) that ``journal`` does not have, and keep each result as it comes.

    When the executor breaks, another is hired. What was in hand then is suspected of having killed it, and tried again
    one by one; what kills its process by itself is kept as a failure.

    Parameters
    ----------
    points : mapping of str to Point
    measure : callable
        Sent to the workers with a point; must be picklable.
    workers : Workers
    journal : Journal
    watch : callable
        Told of each point that is done.
    """
    todo = deque((key, point) for key, point in points.items() if key not in journal.results)
    while todo:
        for key, point in _work_off(todo, measure, workers, journal, watch):
            journal.keep(key, point, _alone(point, measure, workers))
            watch(point)


def _work_off(
    todo: deque[tuple[str, Point]], measure: Measure, workers: Workers, journal: Journal, watch: Watch
) -> list[tuple[str, Point]]:
    """Work ``todo`` off until it is empty or the executor breaks; returns what was in hand when it broke."""
    executor = workers.hire()
    in_hand: dict[Future[dict[str, Any]], tuple[str, Point]] = {}
    try:
        while todo or in_hand:
            while todo and len(in_hand) < _IN_HAND * workers.number:
                in_hand[executor.submit(measure, todo[0][1])] = todo[0]
                todo.popleft()
            for future in wait(in_hand, return_when=FIRST_COMPLETED).done:
                try:
                    result = future.result()
                except workers.killed:
                    result = _DIED
                key, point = in_hand.pop(future)
                journal.keep(key, point, result)
                watch(point)
    except BrokenExecutor:
        return list(in_hand.values())
    finally:
        for future in in_hand:
            future.cancel()
        executor.shutdown()
    return []


def _alone(point: Point, measure: Measure, workers: Workers) -> dict[str, Any]:
    for _ in range(_TRIES):
        executor = workers.hire()
        try:
            return executor.submit(measure, point).result()
        except BrokenExecutor:
            continue
        finally:
            executor.shutdown()
    return _DIED
