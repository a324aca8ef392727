"""Where a study is computed: on this machine's cores, or on a Dask cluster; both are `concurrent.futures` executors."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass

from capacity import InputError

_CONNECTING = "10s"


@dataclass(frozen=True)
class Workers:
    """Workers for hire.

    Attributes
    ----------
    hire : callable
        Makes an executor.
    number : int
        Tasks that they work on at a time.
    killed : tuple of exception types
        What the future of a task raises that killed one worker after the other, where the executor itself goes on.
    """

    hire: Callable[[], Executor]
    number: int
    killed: tuple[type[Exception], ...] = ()


@contextmanager
def workers(where: str) -> Iterator[Workers]:
    """What ``--executor`` names: ``"local"``, ``"local:3"`` or ``"dask://HOST:PORT"``.

    Raises
    ------
    InputError
        When it names nothing of the kind, Dask is not installed, or nobody answers at the address.
    """
    kind, _, rest = where.partition(":")
    if kind == "local" and (not rest or (rest.isdecimal() and int(rest) > 0)):
        number = int(rest) if rest else cores()
        yield Workers(lambda: local_processes(number), number)
    elif kind == "dask" and rest.startswith("//") and rest[2:]:
        with _dask(rest[2:]) as cluster:
            yield cluster
    else:
        raise InputError("--executor", f'"{where}" is no executor', 'write "local", "local:4" or "dask://HOST:PORT"')


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def local_processes(number: int) -> Executor:
    """Processes of this machine, started afresh: threads and a solver's memory do not survive a fork."""
    # Ctrl-C reaches the whole process group; it is the study's own process that stops the work.
    ignoring = (signal.SIGINT, signal.SIG_IGN)
    return _Processes(number, multiprocessing.get_context("spawn"), signal.signal, ignoring)


class _Processes(ProcessPoolExecutor):
    """Shut down, waits for nothing but what is being worked on.

    Ctrl-C in the middle of `submit` leaves a task that nobody has in hand and no process is told of.
    """

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = True) -> None:
        super().shutdown(wait, cancel_futures=cancel_futures)


@contextmanager
def _dask(address: str) -> Iterator[Workers]:
    try:
        from distributed import Client, KilledWorker
    except ImportError as error:
        raise InputError("--executor", "Dask is not installed", 'pip install "ductile-joints[dask]"') from error
    try:
        client = Client(f"tcp://{address}", timeout=_CONNECTING, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(
            "--executor", f'no Dask scheduler answers at "{address}"', "start `dask scheduler` and its workers"
        ) from error
    with client:
        # Not pure: a task is not to be answered from another study's memory.
        yield Workers(lambda: client.get_executor(pure=False), max(1, sum(client.nthreads().values())), (KilledWorker,))
