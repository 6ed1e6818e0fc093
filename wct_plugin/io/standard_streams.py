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


@contextmanager
def spooled(suffix: str, form: Format) -> Iterator[Path]:
    """A temporary file of this suffix with all of standard input. Raises :class:`InputError` for several files."""
    if form.packed:
        raise InputError(f"{STREAM}: {form.name} has several files; standard input is one")
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
        yield file
        with file.open("rb") as source:
            shutil.copyfileobj(source, sys.stdout.buffer)
        sys.stdout.buffer.flush()


def check_target(path: str | Path, form: Format, suffix: str | None) -> None:
    """Raise :class:`OutputError` for a format of several files, which takes the names of the others from the first."""
    if form.companions and str(path) == STREAM:
        raise OutputError(f"{path}: {form.name} has several files; standard output is one")
    if form.companions and suffix is not None:
        raise OutputError(f"{path}: {form.name} has several files, so that the name itself must tell the format")
