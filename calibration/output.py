"""Files of a run, written all or none."""

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from capacity import InputError


def prepare_folder(folder: Path) -> None:
    """Check that ``folder`` can be written to, before any long work is done.

    Raises
    ------
    InputError
        When it cannot.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("-o", f'"{folder}" is a file', "name a folder")
    nearest = next(parent for parent in (folder, *folder.absolute().parents) if parent.exists())
    try:
        with tempfile.TemporaryFile(dir=nearest):
            pass
    except OSError as error:
        raise InputError("-o", f'"{folder}" cannot be written to', "name a folder of your own") from error


def write_files(folder: Path, files: Mapping[str, str]) -> None:
    """Write ``files`` (name to text) into ``folder``, which is made if need be.

    They are written beside it first and moved in when all are complete.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    staging = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        for name, text in files.items():
            (staging / name).write_text(text, encoding="utf-8")
        folder.mkdir(exist_ok=True)
        for name in files:
            (staging / name).replace(folder / name)
    finally:
        shutil.rmtree(staging)
