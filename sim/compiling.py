"""Compiled once for a machine, kept on disk, and the first time in two processes at once.

Compiling is nearly all of what a first run takes, and Numba does it in one thread. So the caller compiles one half of
what is needed while another process compiles the other half into the cache. Whatever goes wrong there only costs time:
what is not in the cache when the caller needs it, it compiles itself.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

from numba import cfunc

from sim.memory import LAW_SIGNATURE

# Set in the environment of a process that compiles for another one: it starts no more of them.
_HELPING = "DUCTILE_JOINTS_COMPILING_AHEAD"
#: How much longer than its own half the caller waits for the other one, and what it waits at least [s].
_PATIENCE, _AT_LEAST = 3.0, 60.0


def compiled(signature: Any, function: Callable[..., None], **options: Any) -> Any:
    """Numba's C function of ``function``, from the cache if it is there.

    Numba keeps it beside the source, or where that cannot be written, in the user's cache folder, or in
    ``NUMBA_CACHE_DIR``.
    """
    try:
        return cfunc(signature, cache=True, **options)(function)
    except RuntimeError as error:
        if "cannot cache" not in str(error):
            raise
        warnings.warn(
            "no folder can be written to keep compiled functions in, so every run compiles them; set NUMBA_CACHE_DIR",
            stacklevel=2,
        )
        return cfunc(signature, **options)(function)


class LawFunction:
    """One of the two functions of a law, compiled when it is first needed; as a law's attribute, its address."""

    def __init__(self, function: Callable[..., None]) -> None:
        self.__doc__ = function.__doc__
        self._function = function

    @cached_property
    def compiled(self) -> Any:
        """Numba's C function."""
        return compiled(LAW_SIGNATURE, self._function, error_model="numpy")

    def __get__(self, law: object, kind: type | None = None) -> int:
        return int(self.compiled.address)


def law_function(function: Callable[[int, int, int, int], None]) -> LawFunction:
    """Make ``function(parameters, state, deformation, out)``, all of them addresses, one that the solver can call."""
    return LawFunction(function)


class Ahead:
    """Another process that runs ``statement``, which compiles something into the cache; none where that is no use."""

    def __init__(self, statement: str) -> None:
        self._start = time.monotonic()
        self._process: subprocess.Popen[bytes] | None = None
        if _HELPING in os.environ or _cores() < 2 or not _is_python(sys.executable):
            return
        environment = os.environ | {_HELPING: "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        with contextlib.suppress(OSError):
            self._process = subprocess.Popen(
                [sys.executable, "-c", statement],
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )

    def wait(self) -> None:
        """Wait until it has ended, well or not; one that takes far too long is ended."""
        if self._process is None:
            return
        try:
            self._process.wait(max(_AT_LEAST, _PATIENCE * (time.monotonic() - self._start)))
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def _cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _is_python(executable: str | None) -> bool:
    """Whether it is an interpreter, and not a program that has one in it and would start itself again."""
    return bool(executable) and Path(executable or "").stem.startswith("python") and not hasattr(sys, "frozen")
