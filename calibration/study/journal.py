"""Results of a study on disk, one JSON line each, kept by the content that they come from.

A line is written whole and flushed before the next begins; a study that is stopped leaves at most its last line torn,
which is cut off when the file is opened again.
"""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from calibration import comparable_push, errors
from calibration.result_cache import REFERENCE_CODE, content_key
from calibration.study import hard_cases, measure
from calibration.study.points import Point
from capacity import InputError
from scene import Scene

NAME = "study.jsonl"


def point_keys(scene: Scene, points: Sequence[Point]) -> dict[str, Point]:
    """Each point under a digest of itself, the scene and the code that answers."""
    measuring = [inspect.getsource(module) for module in (measure, hard_cases, errors, comparable_push)]
    content = content_key(scene, measuring, packages=(*REFERENCE_CODE, "sim", "calibration.engines"))
    return {hashlib.sha256(f"{content} {point!r}".encode()).hexdigest()[:24]: point for point in points}


class Journal:
    """The file ``study.jsonl`` in ``folder``, which is made when something is written.

    Raises
    ------
    InputError
        When a line of it, other than a torn last one, is no result.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME
        self.results: dict[str, dict[str, Any]] = {}
        if self.path.exists():
            self._read()

    def _read(self) -> None:
        whole = self.path.read_bytes()
        end = whole.rfind(b"\n") + 1
        if end < len(whole):
            with self.path.open("r+b") as stream:
                stream.truncate(end)
        for number, line in enumerate(whole[:end].splitlines(), 1):
            try:
                entry = json.loads(line)
                self.results[entry["key"]] = entry["result"]
            except (ValueError, KeyError, TypeError) as error:
                raise InputError(
                    f"{self.path}, line {number}", "is no result of a study", "delete the line, or the file"
                ) from error

    def keep(self, key: str, point: Point, result: dict[str, Any]) -> None:
        """Add a result; it is on disk when this returns."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({"key": key, "point": point.plain(), "result": result}) + "\n")
        self.results[key] = result
