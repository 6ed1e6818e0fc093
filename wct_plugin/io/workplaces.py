"""Hidden folders beside a target in which its files are written before they get their names.

A folder is locked while it is in use, and the lock goes with the process: so the next writer of the same name finds
what a killed one left behind and takes it away.
"""

import os
import secrets
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path

if sys.platform != "win32":
    import fcntl


@contextmanager
def workplace(parent: Path, name: str) -> Iterator[Path]:
    """A new hidden folder in ``parent`` for the target ``name``, which is gone afterwards with all that is in it."""
    prefix = f".{name}.wct-"
    work: Path | None = None
    held = None
    try:
        with _locked(parent, wait=True) as alone:
            if alone:
                for old in parent.glob(f"{escape(prefix)}????????"):
                    with _locked(old, wait=False) as unused:
                        if unused:
                            shutil.rmtree(old, ignore_errors=True)
            while work is None or work.exists():  # named before it is there: whatever interrupts, it is taken away
                work = parent / f"{prefix}{secrets.token_hex(4)}"
            work.mkdir(mode=0o700)
            held = _hold(work, wait=True)
        yield work
    finally:
        # What is raised here is the body's own exception, which matters more than a rest that cannot be removed.
        if work is not None:
            shutil.rmtree(work, ignore_errors=True)
        if held is not None:
            os.close(held)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Let one writer at a time give files their names in a folder, so that files that belong together stay so."""
    with _locked(folder, wait=True):
        yield


@contextmanager
def _locked(folder: Path, *, wait: bool) -> Iterator[bool]:
    """Whether the folder could be locked; within the body it is."""
    held = _hold(folder, wait=wait)
    try:
        yield held is not None
    finally:
        if held is not None:
            os.close(held)


def _hold(folder: Path, *, wait: bool) -> int | None:
    """A handle of the folder that nobody else has; None where another has it, or the system cannot lock folders."""
    if sys.platform != "win32":
        with suppress(OSError):
            handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
            except OSError:
                os.close(handle)
            except BaseException:
                os.close(handle)
                raise
            else:
                return handle
    return None
