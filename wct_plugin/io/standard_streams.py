"""The name ``-``: a mesh comes from standard input or goes to standard output, by way of a temporary file."""

import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wct_plugin.errors import InputError, OutputError
from wct_plugin.io.formats import Format

STREAM = "-"


class ReaderGoneError(OutputError):
    """Whoever read standard output has read enough, as ``head`` does."""


@contextmanager
def spooled(suffix: str, form: Format) -> Iterator[Path]:
    """A temporary file of this suffix with all of standard input. Raises :class:`InputError` for several files."""
    if form.packed:
        raise InputError(f"{STREAM}: {form.name} has several files; standard input is one")
    if sys.stdin is None:
        raise InputError(f"{STREAM}: standard input is closed")
    with tempfile.TemporaryDirectory(prefix="wct-") as folder:
        file = Path(folder) / f"input{suffix}"
        with file.open("wb") as target:
            shutil.copyfileobj(sys.stdin.buffer, target)
        yield file


@contextmanager
def to_stdout(suffix: str) -> Iterator[Path]:
    """A temporary file of this suffix that goes to standard output if the body succeeds."""
    with tempfile.TemporaryDirectory(prefix="wct-") as folder:
        file = Path(folder) / f"output{suffix}"
        check_stdout()
        yield file
        with file.open("rb") as source, writing_stdout():
            shutil.copyfileobj(source, sys.stdout.buffer)
            sys.stdout.buffer.flush()


def check_stdout() -> None:
    """Raise :class:`OutputError` where there is no standard output to write to."""
    if sys.stdout is None:
        raise OutputError(f"{STREAM}: standard output is closed")


@contextmanager
def writing_stdout() -> Iterator[None]:
    """Within the body standard output that takes no more is an :class:`OutputError`, one of its own if nobody reads."""
    try:
        yield
    except BrokenPipeError as error:
        raise ReaderGoneError(f"{STREAM}: nobody reads standard output any more") from error
    except OSError as error:
        raise OutputError(f"{STREAM}: standard output cannot be written: {error.strerror or error}") from error


def check_target(path: str | Path, form: Format, suffix: str | None) -> None:
    """Raise :class:`OutputError` for a format of several files, which takes the names of the others from the first."""
    if form.companions and str(path) == STREAM:
        raise OutputError(f"{path}: {form.name} has several files; standard output is one")
    if form.companions and suffix is not None:
        raise OutputError(f"{path}: {form.name} has several files, so that the name itself must tell the format")
