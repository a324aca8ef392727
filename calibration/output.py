"""Files of a run, written all or none."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from rich.console import Console

from capacity.errors import InputError


class OutputFolder:
    """Where a command writes its files.

    Parameters
    ----------
    path : Path
        Made when it is written to.

    Raises
    ------
    InputError
        When ``path`` cannot be written to: known before any long work is done.
    """

    def __init__(self, path: Path) -> None:
        if path.exists() and not path.is_dir():
            raise InputError("-o", f'"{path}" is a file', "name a folder")
        nearest = next(parent for parent in (path, *path.absolute().parents) if parent.exists())
        try:
            with tempfile.TemporaryFile(dir=nearest):
                pass
        except OSError as error:
            raise InputError("-o", f'"{path}" cannot be written to', "name a folder of your own") from error
        self.path = path
        self.written: list[str] = []

    @classmethod
    def of_scene(cls, scene: str, path: Path | None) -> OutputFolder:
        """``path``, or else out/SCENE."""
        return cls(path or Path("out") / Path(scene).stem)

    def write(self, files: Mapping[str, str | bytes]) -> None:
        """Write ``files`` (name to text or bytes) into the folder.

        They are written beside it first and moved in when all are complete: a run that is stopped leaves none of them
        half-written.
        """
        self.path.parent.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=f".{self.path.name}-", dir=self.path.parent))
        try:
            for name, content in files.items():
                data = content if isinstance(content, bytes) else content.encode()
                (staging / name).write_bytes(data)
            self.path.mkdir(exist_ok=True)
            for name in files:
                (staging / name).replace(self.path / name)
                self.written.append(name)
        finally:
            shutil.rmtree(staging)

    def announce(self, console: Console) -> None:
        """Say on ``console`` what was written and where."""
        console.print(f"Written to {self.path}: {', '.join(self.written)}", soft_wrap=True)
