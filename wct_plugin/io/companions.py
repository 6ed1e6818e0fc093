"""The files that a file names: only those beside or below it are opened, whatever it asks, and no pipe or device."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from types import MappingProxyType

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit

_NONE: Mapping[Path, Path] = MappingProxyType({})
_STAND_FOR: ContextVar[Mapping[Path, Path]] = ContextVar("files that stand for others", default=_NONE)
_OPENED: ContextVar[dict[Path, None] | None] = ContextVar("files that were read", default=None)


@contextmanager
def standing_for(temporary: Path, file: Path) -> Iterator[None]:
    """Within the body a temporary file has its companions where another is, whose content it has."""
    token = _STAND_FOR.set({**_STAND_FOR.get(), temporary: file})
    try:
        yield
    finally:
        _STAND_FOR.reset(token)


@contextmanager
def noting_opened() -> Iterator[dict[Path, None]]:
    """Note every file that the body reads, for who must say which they were; in their order."""
    noted: dict[Path, None] = {}
    token = _OPENED.set(noted)
    try:
        yield noted
    finally:
        _OPENED.reset(token)


def note_opened(path: Path) -> None:
    """Say that a file is read."""
    read_limit.opened(path)
    if (noted := _OPENED.get()) is not None:
        noted[Path(os.path.abspath(path))] = None


def folder_of(file: Path) -> Path:
    """The folder in which the files lie that a file names."""
    return Path(os.path.abspath(_STAND_FOR.get().get(file, file).parent))


def companion(file: Path, name: str) -> Path:
    """The file of this name as ``file`` means it. Raises :class:`InputError` where it lies elsewhere or is none."""
    expect_name(name, f"names the file {name!r}")
    folder = folder_of(file)
    path = Path(os.path.normpath(folder / name.replace("\\", "/")))
    if not path.is_relative_to(folder):
        raise InputError(f"names the file {name!r}, which lies elsewhere; allowed are files beside or below it")
    return checked(file, path, f"names the file {name!r}")


def expect_name(name: str, said: str) -> None:
    """Raise :class:`InputError`, which begins with what is ``said`` of it, for a name that no file can have."""
    if "\0" in name:
        raise InputError(f"{said}, which is no name of a file")


def checked(file: Path, path: Path, said: str) -> Path:
    """A path beside or below ``file``, found to be a plain file there, by way of links too.

    Where ``file`` is itself a link, beside what it leads to is as good. Raises :class:`InputError` that begins with
    what is ``said`` of it.
    """
    if not path.exists():
        raise InputError(f"{said}, but there is no such file")
    given, real = _STAND_FOR.get().get(file, file), path.resolve()
    roots = (folder_of(file).resolve(), given.resolve().parent, file.resolve().parent)
    if not any(real.is_relative_to(root) for root in roots):
        raise InputError(f"{said}, a link that leads elsewhere; allowed are files beside or below it")
    if not real.is_file():
        raise InputError(f"{said}, which is no file")
    note_opened(path)
    return path
