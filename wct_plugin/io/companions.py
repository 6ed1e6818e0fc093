"""The files that a file names: only those beside or below it are opened, whatever it asks for."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from types import MappingProxyType

from wct_plugin.errors import InputError

_NONE: Mapping[Path, Path] = MappingProxyType({})
_STAND_FOR: ContextVar[Mapping[Path, Path]] = ContextVar("files that stand for others", default=_NONE)


@contextmanager
def standing_for(temporary: Path, file: Path) -> Iterator[None]:
    """Within the body a temporary file has its companions where another is, whose content it has."""
    token = _STAND_FOR.set({**_STAND_FOR.get(), temporary: file})
    try:
        yield
    finally:
        _STAND_FOR.reset(token)


def folder_of(file: Path) -> Path:
    """The folder in which the files lie that a file names."""
    return Path(os.path.abspath(_STAND_FOR.get().get(file, file).parent))


def companion(file: Path, name: str) -> Path:
    """The file of this name as ``file`` means it. Raises :class:`InputError` where it lies elsewhere or is none."""
    folder = folder_of(file)
    path = Path(os.path.normpath(folder / name.replace("\\", "/")))
    if not path.is_relative_to(folder):
        raise InputError(f"names the file {name!r}, which lies elsewhere; allowed are files beside or below it")
    if not path.is_file():
        raise InputError(f"names the file {name!r}, but there is no such file")
    return path
