"""What changed between two calibrations."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from capacity.errors import InputError

#: Parts of a calibration that are compared, with what they are called.
_PARTS = {
    "scene": "scene",
    "capacity": "capacity",
    "model": "model",
    "errors": "errors",
    "speed": "speed",
    "target_error": "target",
    "target_met": "target",
    "versions": "versions",
}
#: Curves and costs of a model, which the errors and the speed stand for.
_NOT_COMPARED = ("model.displacement", "model.load", "model.seconds", "model.newton_steps")
#: Numbers that differ by less, as a share, are the same.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Change:
    """A value that is not the same in both; None where one has none."""

    part: str
    name: str
    before: Any
    after: Any

    @property
    def ratio(self) -> float | None:
        """After over before, of numbers."""
        if not (_is_number(self.before) and _is_number(self.after)) or self.before == 0.0:
            return None
        return float(self.after) / float(self.before)


@dataclass(frozen=True)
class Comparison:
    """What changed.

    Attributes
    ----------
    changes : tuple of Change
    grown : tuple of Change
        Errors that grew past the tolerance, or are not given any more.
    tolerance : float
        Share of what the errors are shares of [-].
    """

    changes: tuple[Change, ...]
    grown: tuple[Change, ...]
    tolerance: float

    def plain(self) -> dict[str, Any]:
        """As one object for JSON."""
        return {
            "tolerance": self.tolerance,
            "grown": [change.name for change in self.grown],
            "changes": [
                {"part": change.part, "name": change.name, "before": change.before, "after": change.after}
                for change in self.changes
            ],
        }


def read_calibration(path: Path) -> dict[str, Any]:
    """The object that ``ductile calibrate`` wrote to ``calibration.json``.

    Raises
    ------
    InputError
        When there is no such file, or it is something else.
    """
    cure = "name a calibration.json that `ductile calibrate` wrote"
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(path), "no such file" if not path.exists() else "cannot be read", cure) from error
    except ValueError as error:
        raise InputError(str(path), "is not JSON", cure) from error
    wanted = ("capacity", "model", "errors", "speed")
    if not isinstance(whole, dict) or not all(isinstance(whole.get(key), dict) for key in wanted):
        raise InputError(str(path), "is not a calibration", cure)
    return whole


def compare_calibrations(before: Mapping[str, Any], after: Mapping[str, Any], tolerance: float) -> Comparison:
    """Compare two objects that `read_calibration` gave; errors count by their size, without sign."""
    changes: list[Change] = []
    for part in _PARTS:
        one, other = dict(_leaves(part, before.get(part))), dict(_leaves(part, after.get(part)))
        changes.extend(
            Change(_PARTS[part], name, one.get(name), other.get(name))
            for name in dict.fromkeys([*one, *other])
            if name not in _NOT_COMPARED and not _same(one.get(name), other.get(name))
        )
    grown = [change for change in changes if change.part == "errors" and _grew(change, tolerance)]
    return Comparison(tuple(changes), tuple(grown), tolerance)


def _leaves(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """All values under ``value``, each with its dotted name; lists are compared whole."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(f"{name}.{key}", item)
    elif value is not None:
        yield name, value


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _same(one: Any, other: Any) -> bool:
    if _is_number(one) and _is_number(other):
        return math.isclose(one, other, rel_tol=_ROUNDING)
    return bool(one == other)


def _grew(change: Change, tolerance: float) -> bool:
    if not _is_number(change.before):
        return False
    # A comparison with nan is false: an error that is no number has grown.
    return not (_is_number(change.after) and abs(change.after) - abs(change.before) <= tolerance)
