"""The functions that Chipmunk calls for each joint; the first joint of a structure that it comes to acts for all.

Numba keys its cache by a function's own code. What these functions call lies in other files, so a digest of those
files is made part of them.
"""

import hashlib
import math
from pathlib import Path
from typing import Any

import numpy as np
from numba import cfunc, types

from sim.chipmunk import CONTROL
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.step import begin, finish, solve
from sim.memory import integers


def _digest() -> str:
    """Digest of all source that goes into the callbacks."""
    here = Path(__file__).parent
    files = sorted([*here.glob("*.py"), here.parent / "memory.py", here.parent / "chipmunk.py"])
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _compile(digest: str) -> tuple[Any, ...]:
    """The C functions; ``digest`` makes Numba's cache of them depend on the source of what they call."""
    step = types.void(types.int64, types.float64)

    @cfunc(step, cache=True)
    def pre_step(constraint, h):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        t = views.control(c)
        if t[at.LEADER] == 0:
            t[at.LEADER] = constraint
            begin(c, h)

    @cfunc(step, cache=True)
    def apply_cached_impulse(constraint, ratio):  # type: ignore[no-untyped-def]
        # Nothing: the first solve of a step starts from the cached impulses by itself.
        digest  # noqa: B018

    @cfunc(step, cache=True)
    def apply_impulse(constraint, h):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        if views.control(c)[at.LEADER] == constraint:
            solve(c)

    @cfunc(types.float64(types.int64), cache=True)
    def get_impulse(constraint):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        own = integers(constraint, CONTROL + 2)
        t = views.control(own[CONTROL])
        p = views.per_joint(t, at.IMPULSE)[own[CONTROL + 1]]
        return math.hypot(p[0], p[1])

    @cfunc(types.void(types.int64, types.int64), cache=True)
    def after_step(constraint, space):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        t = views.control(c)
        if t[at.LEADER] == constraint:
            t[at.LEADER] = 0
            finish(c)

    return pre_step, apply_cached_impulse, apply_impulse, get_impulse, after_step


_COMPILED = _compile(_digest())
#: Chipmunk's table of functions for a constraint.
FUNCTIONS = np.array([function.address for function in _COMPILED[:4]], dtype=np.int64)
AFTER_STEP = _COMPILED[4].address
