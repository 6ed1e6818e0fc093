"""The processes of a session: what a job started, and what that started in turn, whatever its parents did.

A process group is not enough, as adapters put each neighbour in a group of its own; nor is the tree of parents, as
orphans leave it. The session stays. Without ``/proc`` (off Linux) only the job's own group is known.
"""

import contextlib
import ctypes
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from wct_plugin.batch.starters import Verdict

if sys.platform != "win32":
    import resource

assert sys.platform != "win32", "no sessions of processes there"

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
# Where in /proc/PID/stat, counted from behind the name.
_STATE, _SESSION, _RESIDENT = 0, 3, 21


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)


def die_with_parent() -> None:
    """Have the kernel kill this process when its parent dies, which may have no time to do it."""
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def adopt_orphans() -> None:
    """Become the parent of every descendant whose own parent ends, so that none is lost sight of."""
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)


def die_first() -> None:
    """Have the kernel choose this process, not whoever started it, when the system runs out of memory."""
    with contextlib.suppress(OSError):  # off Linux
        Path("/proc/self/oom_score_adj").write_text("500")


def _processes() -> Iterator[tuple[int, int, int]]:
    """Process, session and resident pages of every living process."""
    with contextlib.suppress(FileNotFoundError), os.scandir("/proc") as entries:
        for entry in entries:
            if not entry.name.isdigit():
                continue
            try:
                with open(f"/proc/{entry.name}/stat", "rb") as file:
                    fields = file.read().rpartition(b")")[2].split()
            except OSError:  # it has ended meanwhile
                continue
            if fields[_STATE] not in (b"Z", b"X"):
                yield int(entry.name), int(fields[_SESSION]), int(fields[_RESIDENT])


def resident() -> dict[int, int]:
    """Bytes of memory in use per session."""
    page = os.sysconf("SC_PAGE_SIZE")
    found: dict[int, int] = {}
    for _, session, pages in _processes():
        found[session] = found.get(session, 0) + pages * page
    return found


def kill(session: int) -> None:
    """Kill every process of a session; none is left when this returns, unless the kernel holds it back."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(session, signal.SIGKILL)
    for _ in range(50):  # one may have started another in between
        if not _kill_members(session):
            return
        time.sleep(0.005)


def kill_own() -> None:
    """Kill every process of the session that this process leads, and itself last."""
    _kill_members(os.getpid(), but=os.getpid())
    os.killpg(os.getpid(), signal.SIGKILL)


def _kill_members(session: int, but: int | None = None) -> bool:
    """Kill the processes of a session, but for one; whether there were any."""
    members = [process for process, of, _ in _processes() if of == session and process != but]
    for process in members:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)
    return bool(members)


def verdict(stopped: str, status: int, usage: resource.struct_rusage, peak: int = 0) -> Verdict:
    """How a process ended, of what :func:`os.wait4` gave; ``peak`` is what it was seen to use, in bytes."""
    code = os.waitstatus_to_exitcode(status)
    unit = 1 if sys.platform == "darwin" else 1024
    most = max(peak, usage.ru_maxrss * unit)
    return Verdict(stopped, max(-code, 0), max(code, 0), usage.ru_utime + usage.ru_stime, most)
