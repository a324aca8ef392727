"""Results kept on disk by the content that they come from."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import platformdirs

from scene import Scene

#: What a reference's answer follows from.
REFERENCE_CODE = ("capacity", "scene", "fem_reference")


def content_key(scene: Scene, *settings: object, packages: Sequence[str] = REFERENCE_CODE) -> str:
    """A digest of ``scene``, ``settings`` and the ``packages`` that answer; whatever changes an answer changes it."""
    digest = hashlib.sha256(repr((scene, settings)).encode())
    for member in scene.members.values():
        for material, fibres in member.section.fibres_by_material(24, member.material):
            digest.update(fibres.y.tobytes() + fibres.area.tobytes())
            digest.update(repr(sorted(vars(material).items())).encode())
    if scene.meshed is not None:
        digest.update(repr(scene.meshed.material and sorted(vars(scene.meshed.material).items())).encode())
        mesh = Path(scene.meshed.mesh or "")
        digest.update(mesh.read_bytes() if mesh.is_file() else b"")
    for package in packages:
        spec = importlib.util.find_spec(package)
        for folder in (spec.submodule_search_locations if spec else None) or ():
            for path in sorted(Path(folder).rglob("*.py")):
                digest.update(path.read_bytes())
    return digest.hexdigest()


def cache_file(key: str) -> Path:
    """Where the result of ``key`` is kept."""
    return platformdirs.user_cache_path("ductile-joints") / "reference" / f"{key}.json"


def recall(key: str) -> dict[str, Any] | None:
    """The result kept under ``key``, if there is one that can be read."""
    try:
        kept: dict[str, Any] = json.loads(cache_file(key).read_text(encoding="utf-8"))
    except (OSError, ValueError):  # none, or one that another program has spoilt: it is computed anew
        return None
    return kept


def keep(key: str, result: dict[str, Any]) -> None:
    """Keep ``result`` under ``key``, whole or not at all; a folder that cannot be written to keeps nothing."""
    file = cache_file(key)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent)
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            json.dump(result, stream)
        Path(name).replace(file)
    except OSError:
        return
