"""A recording as text that a page can carry: a description in JSON, and its arrays packed small.

Every channel (one coordinate of one body, one force of one joint …) becomes 16-bit integers over its own range, so it
is resolved to 1/65534 of that. Integers are stored as differences along time, low bytes first and high bytes after
all of them, deflated, in base64.
"""

from __future__ import annotations

import base64
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sim.recorded import Outline, RecordedJoint, Recording

#: Stands for a value that is not there.
ABSENT = -32768
_LARGEST = 32767
# Share of a joint's capacity below which a force is rounding.
_ROUNDING = 1e-9
# A body that moves further between two samples than this many times what its speeds allow was put elsewhere.
_JUMP = 3.0


@dataclass(frozen=True)
class ReferenceShape:
    """Shape of the finite-element reference, to lay over a recording.

    Attributes
    ----------
    lines : tuple of (n, 2) or (times, n, 2) float
        Points along the members [m], at one moment or at several.
    time : (times,) float, optional
        Those moments [s].
    label : str
        What the shape is.
    """

    lines: tuple[np.ndarray, ...]
    time: np.ndarray | None = None
    label: str = "finite-element reference"


@dataclass
class Packer:
    """Arrays of 16-bit integers, one after the other; `describe` says where each lies and what it stands for."""

    arrays: list[np.ndarray] = field(default_factory=list)
    layout: dict[str, dict[str, Any]] = field(default_factory=dict)

    def add(self, name: str, values: np.ndarray, centred: bool = False) -> None:
        """Pack ``values``, (length, channels), each channel over its own range, or around 0 to keep zeros exact."""
        values = np.asarray(values, dtype=float)
        there = np.isfinite(values)
        some = there.any(axis=0)
        low = np.where(some, np.where(there, values, math.inf).min(axis=0, initial=math.inf), 0.0)
        high = np.where(some, np.where(there, values, -math.inf).max(axis=0, initial=-math.inf), 0.0)
        offset = np.zeros(values.shape[1]) if centred else 0.5 * (low + high)
        reach = np.maximum(high - offset, offset - low)
        step = np.where(reach > 0.0, reach / _LARGEST, 1.0)
        scaled = np.where(there, np.round((np.where(there, values, 0.0) - offset) / step), ABSENT)
        self.layout[name] = {
            "first": sum(array.size for array in self.arrays),
            "length": values.shape[0],
            "offset": offset.tolist(),
            "step": step.tolist(),
        }
        self.arrays.append(scaled.T.astype(np.int16))

    def text(self) -> str:
        """All arrays, packed."""
        with_start = [np.diff(array, axis=1, prepend=np.int16(0)).ravel() for array in self.arrays]
        pairs = np.concatenate(with_start).astype("<i2").view(np.uint8).reshape(-1, 2)
        return base64.b64encode(zlib.compress(pairs.T.tobytes(), 6)).decode("ascii")


def payload(recording: Recording, reference: ReferenceShape | None = None) -> dict[str, Any]:
    """What the page's script reads; JSON can say all of it."""
    times, packer = len(recording.time), Packer()
    packer.add("pose", recording.pose.reshape(times, -1))
    packer.add("force", _felt(recording.force, recording.joints).reshape(times, -1), centred=True)
    packer.add("used", recording.capacity_used, centred=True)
    contacts = recording.contacts
    packer.add("touching", np.diff(contacts.start).reshape(-1, 1))
    packer.add("contact", np.hstack([contacts.point, contacts.force]))
    if recording.energy:
        packer.add("energy", np.column_stack(list(recording.energy.values())), centred=True)
    return {
        "title": recording.title,
        "time": [_rounded(t) for t in recording.time],
        "settings": recording.settings,
        "bodies": [
            {"kind": body.kind, "inStructure": body.in_structure, "outlines": list(map(_outline, body.outlines))}
            for body in recording.bodies
        ],
        "joints": [
            _joint(joint, peak, broken)
            for joint, peak, broken in zip(
                recording.joints, _felt(recording.peak, recording.joints), recording.broken.T, strict=True
            )
        ],
        "jumps": _jumps(recording),
        "energy": list(recording.energy),
        "reference": None if reference is None else _reference(reference),
        "layout": packer.layout,
        "data": packer.text(),
    }


def _felt(force: np.ndarray, joints: Sequence[RecordedJoint]) -> np.ndarray:
    """``force`` (…, joints, 3), but 0 where it is rounding beside the joint's capacity: its curve would be of noise."""
    maxima = np.array([joint.maxima for joint in joints]).reshape(-1, 3)
    least = np.where(np.isfinite(maxima), _ROUNDING * maxima, 0.0)
    felt: np.ndarray = np.where(np.abs(force) < least, 0.0, force)
    return felt


def _outline(outline: Outline) -> dict[str, Any]:
    return {"kind": outline.kind, "points": _points(outline.points), "radius": _rounded(outline.radius)}


def _joint(joint: RecordedJoint, peak: np.ndarray, broken: np.ndarray) -> dict[str, Any]:
    return {
        "label": joint.label,
        "bodies": joint.bodies,
        "anchors": _points(joint.anchors),
        "rest": joint.rest,
        "turn": joint.turn,
        "maxima": [_rounded(value) if math.isfinite(value) else None for value in joint.maxima],
        "peak": [_rounded(value) for value in peak],
        "brokenFrom": int(broken.argmax()) if broken.any() else None,
    }


def _jumps(recording: Recording) -> list[tuple[int, int]]:
    """Body and sample where a body was put elsewhere, so that nothing is drawn on the way."""
    if len(recording.time) < 2:
        return []
    way = np.hypot(*np.moveaxis(np.diff(recording.pose[:, :, :2], axis=0), 2, 0))
    speed = np.hypot(*np.moveaxis(recording.velocity, 2, 0))
    possible = np.maximum(speed[1:], speed[:-1]) * np.diff(recording.time)[:, None]
    extent = np.nanmax(np.ptp(recording.pose[:, :, :2], axis=0), initial=0.0)
    found = np.argwhere(way > _JUMP * possible + 0.01 * extent)
    return [(int(body), int(k) + 1) for k, body in found]


def _reference(reference: ReferenceShape) -> dict[str, Any]:
    time = reference.time
    # One moment is a course of one.
    lines = [line[None] if line.ndim == 2 else line for line in reference.lines]
    return {
        "label": reference.label,
        "time": None if time is None else [_rounded(t) for t in time],
        "lines": [[_points(moment) for moment in line] for line in lines],
    }


def _points(points: np.ndarray) -> list[list[float]]:
    return [[_rounded(x), _rounded(y)] for x, y in points.tolist()]


def _rounded(value: float) -> float:
    """``value`` with nine significant digits, which keeps the text short."""
    return float(f"{value:.9g}")
