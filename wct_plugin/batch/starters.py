"""What starts a job in a process of its own, by a fork or afresh, and says how that ended."""

import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from wct_plugin.batch.job import Job
from wct_plugin.errors import WctError

#: What tells numerical libraries how many threads to use; values that are set already are the user's.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class UnwantedError(WctError):
    """The job was given up by whoever ordered it."""


class LostError(WctError):
    """No process could be started, or the one that starts them is gone."""


@dataclass(frozen=True)
class Verdict:
    """How a job's process ended."""

    stopped: str  #: timeout, memory, or empty where it ended by itself
    signal: int
    exit_code: int
    cpu_seconds: float | None = None  #: None where the system does not tell
    peak_bytes: int | None = None


class Starter(Protocol):
    """Starts jobs, for any number of threads."""

    def run(self, job: Job, attempt: Path, wanted: Callable[[], bool]) -> Verdict:
        """Do ``job`` in the folder ``attempt`` and wait for its end, asking now and then whether it is still wanted."""

    def close(self) -> None:
        """End every job."""


def forks() -> bool:
    """Whether jobs are forked: Windows cannot, and on macOS a copy of a process with threads may hang."""
    return sys.platform not in ("win32", "darwin")


def cores() -> int:
    """How many cores this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def environment(jobs: int) -> dict[str, str]:
    """Ours, in which numerical libraries get their share of the cores for so many jobs at once."""
    share = str(max(1, cores() // jobs))
    return {**dict.fromkeys(_THREADS, share), **os.environ}
