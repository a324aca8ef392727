"""The functions that Chipmunk calls for each joint; the first joint of a structure that it comes to acts for all.

Numba keys its cache by a function's own code. What these functions call lies in other files, so a digest of those
files is made part of them.
"""

import hashlib
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import types

from sim.chipmunk import CLASS_BYTES, CONSTRAINT_CLASS, CONTROL, POST_SOLVE
from sim.compiling import Ahead, compiled
from sim.kernels import layout as at
from sim.kernels import views
from sim.kernels.idle import bring_back, leave_out
from sim.kernels.noted import is_known
from sim.kernels.step import begin, finish, solve
from sim.memory import call_notice, call_post_solve, integers

#: Where the last of the functions is among the others.
AFTER_STEP = 8
_STEP = types.void(types.int64, types.float64)


class Callbacks(NamedTuple):
    """Addresses of what Chipmunk calls."""

    #: Of preStep, applyCachedImpulse, applyImpulse and getImpulse; of joints that leave a step to another one, then of
    #: the one that acts for all; and of what is called for that one when the step's impulses are final.
    functions: np.ndarray
    #: What owns the code that they point to.
    owners: tuple[Any, ...]


@cache
def compiled_callbacks() -> Callbacks:
    """The functions, compiled when first needed: those of a step's beginning and end here, the solve beside them."""
    impulse = get_impulse()
    # The smallest of them tells whether the others are in the cache, too.
    ahead = None if impulse.cache_hits else Ahead(f"from {__name__} import apply_impulse; apply_impulse()")
    before, cached, alone, after = pre_step(), apply_cached_impulse(), leave_out_idle(), after_step()
    if ahead is not None:
        ahead.wait()
    apply = apply_impulse()
    tables = [before, cached, cached, impulse, before, alone, apply, impulse, after]
    functions = np.array([function.address for function in tables], dtype=np.int64)
    return Callbacks(functions, (before, cached, alone, apply, impulse, after))


@cache
def _digest() -> str:
    """Digest of all source that goes into the callbacks."""
    here = Path(__file__).parent
    files = sorted(
        [*here.glob("*.py"), here.parent / "memory.py", here.parent / "chipmunk.py", here.parent / "stock.py"]
    )
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _with_digest(signature: Any) -> Callable[[Callable[[str], Callable[..., Any]]], Callable[[], Any]]:
    """Compile what a function makes of the digest."""
    return lambda make: lambda: compiled(signature, make(_digest()))


@_with_digest(_STEP)
def pre_step(digest: str) -> Callable[..., None]:
    """The step begins."""

    def pre_step(constraint, h):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        if c == 0:
            return  # it has no structure: Python could not make one, and will say so
        t = views.control(c)
        if t[at.LEADER] != 0:
            t[at.CALLED] += 1
        else:
            if not is_known(t, constraint):
                # Python looks through the space, and may give the joint to another structure.
                t[at.NOTES] = 0
                call_notice(t[at.NOTICE], t[at.KEY])
                c = integers(constraint, CONTROL + 1)[CONTROL]
                if c == 0:
                    return
                t = views.control(c)
            t[at.LEADER], t[at.CALLED] = constraint, 1
            own, tables = integers(constraint, CONTROL), integers(t[at.OWN_CLASS], AFTER_STEP + 1)
            t[at.THEIR_POST_SOLVE] = own[POST_SOLVE] if own[POST_SOLVE] != tables[AFTER_STEP] else 0
            own[CONSTRAINT_CLASS], own[POST_SOLVE] = t[at.OWN_CLASS] + CLASS_BYTES, tables[AFTER_STEP]
            begin(c, h)

    return pre_step


@_with_digest(_STEP)
def apply_cached_impulse(digest: str) -> Callable[..., None]:
    """Nothing: the first solve of a step starts from the cached impulses by itself, and one joint solves for all."""

    def apply_cached_impulse(constraint, ratio):  # type: ignore[no-untyped-def]
        digest  # noqa: B018

    return apply_cached_impulse


@_with_digest(_STEP)
def leave_out_idle(digest: str) -> Callable[..., None]:
    """Before the first iteration, of the joint that acts for all: most of the others are not called any more."""

    def leave_out_idle(constraint, ratio):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        if c != 0:
            leave_out(views.control(c), constraint)

    return leave_out_idle


@_with_digest(_STEP)
def apply_impulse(digest: str) -> Callable[..., None]:
    """One of the solver's iterations."""

    def apply_impulse(constraint, h):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        if c == 0:
            return
        t = views.control(c)
        # One that nothing but its joints moves is solved once.
        if t[at.LEADER] == constraint and (t[at.ALONE] == 0 or t[at.FRESH] == 1):
            solve(c)

    return apply_impulse


@_with_digest(types.float64(types.int64))
def get_impulse(digest: str) -> Callable[..., float]:
    """Size of the impulse of N and Q in the last step."""

    def get_impulse(constraint):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        own = integers(constraint, CONTROL + 2)
        if own[CONTROL] == 0:
            return 0.0
        t = views.control(own[CONTROL])
        p = views.per_joint(t, at.IMPULSE)[own[CONTROL + 1]]
        settings = views.settings(t)
        # That of the last part, for all of them.
        whole = settings[at.WHOLE_STEP] / settings[at.STEP] if settings[at.STEP] > 0.0 else 1.0
        return whole * math.hypot(p[0], p[1])

    return get_impulse


@_with_digest(types.void(types.int64, types.int64))
def after_step(digest: str) -> Callable[..., None]:
    """The step's impulses are final."""

    def after_step(constraint, space):  # type: ignore[no-untyped-def]
        digest  # noqa: B018
        c = integers(constraint, CONTROL + 1)[CONTROL]
        if c != 0 and views.control(c)[at.LEADER] == constraint:
            t = views.control(c)
            t[at.LEADER] = 0
            bring_back(t, constraint)
            own = integers(constraint, CONTROL)
            own[CONSTRAINT_CLASS], own[POST_SOLVE] = t[at.OWN_CLASS], t[at.THEIR_POST_SOLVE]
            finish(c)
            if own[POST_SOLVE] != 0:
                call_post_solve(own[POST_SOLVE], constraint, space)

    return after_step
