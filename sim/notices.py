"""How the kernels tell a structure that something happened in a step: a C function with the structure's key."""

from __future__ import annotations

import ctypes
import itertools
from typing import Protocol
from weakref import WeakValueDictionary


class Listener(Protocol):
    """What can be told."""

    def told(self) -> None:
        """Something happened in a step that the space has not left yet."""


_listeners: WeakValueDictionary[int, Listener] = WeakValueDictionary()
_keys = itertools.count(1)


def listen(listener: Listener) -> tuple[int, int]:
    """Address of the function for the kernels to call, and the key to call it with; the listener may be forgotten."""
    key = next(_keys)
    _listeners[key] = listener
    return int(ctypes.cast(_notice, ctypes.c_void_p).value or 0), key


def _tell(key: int) -> None:
    _listeners[key].told()


_notice = ctypes.CFUNCTYPE(None, ctypes.c_int64)(_tell)
