"""What a study sweeps, read from the command line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from calibration.study.points import Choices
from capacity import InputError
from capacity.units import positive
from sim import RULES

_T = TypeVar("_T")


def read_choices(
    rules: str | None, joints: str | None, laws: str | None, dt: str | None, iterations: str | None, stock: bool
) -> Choices:
    """The default choices, with those that are given in their place; each several, separated by commas.

    Raises
    ------
    InputError
        When one names nothing that there is.
    """
    choices = Choices()
    if rules is not None:
        choices = replace(choices, rules=_several(rules, lambda text: _one_of(text, tuple(RULES), "--rules")))
    if laws is not None:
        choices = replace(choices, laws=_several(laws, lambda text: _one_of(text, choices.laws, "--laws")))
    if joints is not None:
        given = _several(joints, lambda text: _whole(text, 2, "--joints"))
        choices = replace(choices, joints=given, stock_joints=given)
    if dt is not None:
        choices = replace(choices, dt=_several(dt, lambda text: positive(text, "time", "--dt")))
    if iterations is not None:
        given = _several(iterations, lambda text: _whole(text, 1, "--iterations"))
        choices = replace(choices, iterations=given, stock_iterations=given)
    return choices if stock else replace(choices, stock=())


def _several(text: str, read: Callable[[str], _T]) -> tuple[_T, ...]:
    return tuple(dict.fromkeys(read(part.strip()) for part in text.split(",")))


def _one_of(text: str, known: Sequence[str], place: str) -> str:
    if text not in known:
        raise InputError(place, f'there is no "{text}"', f"choose from {', '.join(known)}")
    return text


def _whole(text: str, least: int, place: str) -> int:
    if not text.isdecimal() or int(text) < least:
        raise InputError(place, f'"{text}" is no whole number from {least}', 'write numbers such as "3, 5, 8"')
    return int(text)
