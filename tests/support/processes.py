"""Which processes are at work in a folder, by /proc: those of other tests at the same time are not meant."""

import os
import time
from collections.abc import Callable
from pathlib import Path


def working_in(folder: Path) -> list[str]:
    """The command lines of all processes whose working directory is ``folder`` or in it, zombies left out."""
    return list(processes_in(folder).values())


def processes_in(folder: Path) -> dict[int, str]:
    """The same by the processes' numbers, which they have in the order of their start."""
    found = {}
    for process in sorted(Path("/proc").glob("[0-9]*"), key=lambda one: int(one.name)):
        try:
            place = Path(os.readlink(process / "cwd"))
            command = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        except OSError:  # it has ended meanwhile, or belongs to someone else
            continue
        if command and (place == folder or folder in place.parents):
            found[int(process.name)] = command
    return found


def wait_until(true: Callable[[], bool], seconds: float = 20.0) -> None:
    """Wait for something that another process does."""
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.02)


def children(word: str) -> list[int]:
    """Our own child processes whose command line has ``word`` in it."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((process / "stat").read_text().rpartition(")")[2].split()[1])
            command = (process / "cmdline").read_bytes().decode()
        except OSError:  # it has ended meanwhile
            continue
        if parent == os.getpid() and word in command:
            found.append(int(process.name))
    return found
