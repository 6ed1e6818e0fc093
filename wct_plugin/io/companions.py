"""The files that a file names: only those beside or below it are opened, whatever it asks for."""

import os
from pathlib import Path

from wct_plugin.errors import InputError


def companion(file: Path, name: str) -> Path:
    """The file of this name as ``file`` means it. Raises :class:`InputError` where it lies elsewhere or is none."""
    folder = Path(os.path.abspath(file.parent))
    path = Path(os.path.normpath(folder / name.replace("\\", "/")))
    if not path.is_relative_to(folder):
        raise InputError(f"names the file {name!r}, which lies elsewhere; allowed are files beside or below it")
    if not path.is_file():
        raise InputError(f"names the file {name!r}, but there is no such file")
    return path
