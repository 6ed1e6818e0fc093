"""The process that forks: it has imported everything once and starts each job as a copy of itself.

Not multiprocessing's forkserver: that one imports the caller's ``__main__`` again in every job, leaves running what a
job started, and outlives nobody but itself. This one gives each job a session of its own, ends the whole session at
the job's end, timeout or memory limit, and ends all of them when whoever started it is gone, for whatever reason.

It runs one thread only, so that a fork copies no lock that is held; the caller's threads wait, each on a socket.

Memory is watched, not limited by ``RLIMIT_AS``: that counts address space, of which OpenBLAS, TBB and fTetWild reserve
gigabytes that they never touch, it holds for each process by itself, and native code that meets it aborts without a
word. The resident memory of a whole session is what fills a machine.
"""

import contextlib
import io
import json
import os
import selectors
import signal
import socket
import sys
import time
import traceback
from dataclasses import asdict, dataclass
from pathlib import Path

from wct_plugin.batch import process_sessions
from wct_plugin.batch.job import Job, perform
from wct_plugin.errors import WctError
from wct_plugin.io.meshio_modules import meshio_module
from wct_plugin.pipeline.provenance import versions
from wct_plugin.pipeline.stage import filter_names, find_filter

assert sys.platform != "win32", "no process can be forked there"

#: Seconds between two looks at the memory; looking never takes more than this share of a core.
_LOOK, _SHARE = 0.05, 0.04


@dataclass
class _Child:
    """A job that runs; its process is also its session."""

    pid: int
    connection: socket.socket  #: closed by the other side: the job is not wanted any more
    deadline: float | None
    memory: int | None
    stopped: str = ""  #: why it was killed by us
    peak: int = 0  #: greatest resident memory seen


class Server:
    """Forks a job per connection that comes in over ``control``, and says on it how the job ended."""

    def __init__(self, control: socket.socket) -> None:
        self._control = control
        self._children: dict[int, _Child] = {}
        self._selector = selectors.DefaultSelector()
        self._next_look = 0.0

    def serve(self) -> None:
        """Serve until the other side of ``control`` is gone."""
        woken, wake = socket.socketpair()
        for end in (woken, wake):
            end.setblocking(False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(wake.fileno(), warn_on_full_buffer=False)
        for one in (signal.SIGINT, signal.SIGTERM):  # whoever sends them to every process means the caller, who ends us
            signal.signal(one, signal.SIG_IGN)
        process_sessions.adopt_orphans()
        self._selector.register(self._control, selectors.EVENT_READ)
        self._selector.register(woken, selectors.EVENT_READ)
        while True:
            for key, _ in self._selector.select(self._patience()):
                if key.fileobj is self._control:
                    _, fds, _, _ = socket.recv_fds(self._control, 1, 1)
                    if not fds:
                        self._end_all()
                        return
                    self._start(socket.socket(fileno=fds[0]))
                elif key.fileobj is woken:
                    woken.recv(4096)
                else:
                    self._stop(key.data, "unwanted")
            self._reap()
            self._watch()

    def _start(self, connection: socket.socket) -> None:
        with connection.makefile("rb") as lines:
            request = json.loads(lines.readline() or b"null")
        if request is None:  # given up already
            connection.close()
            return
        try:
            pid = os.fork()
        except OSError:  # no memory or no room for a process: the other side hears that it came to nothing
            connection.close()
            return
        if pid == 0:
            status = 2
            try:
                connection.close()
                status = self._become(Job(**request["job"]), Path(request["attempt"]))
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(status)
        timeout, memory = request["job"]["timeout"], request["job"]["memory"]
        deadline = None if timeout is None else time.monotonic() + timeout
        child = self._children[pid] = _Child(pid, connection, deadline, memory)
        self._selector.register(connection, selectors.EVENT_READ, child)

    def _become(self, job: Job, attempt: Path) -> int:
        """Be the job: in the new process."""
        os.setsid()
        process_sessions.die_with_parent()
        process_sessions.die_first()
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        self._selector.close()
        for other in (self._control, *(child.connection for child in self._children.values())):
            other.close()
        with open(os.devnull, "rb") as nothing, (attempt / "words").open("ab") as words:
            os.dup2(nothing.fileno(), 0)
            os.dup2(words.fileno(), 1)
            os.dup2(words.fileno(), 2)
        if isinstance(sys.stdout, io.TextIOWrapper):  # what it says last is heard even if it leaves by os._exit
            sys.stdout.reconfigure(line_buffering=True)
        return perform(job, attempt)

    def _patience(self) -> float | None:
        """Seconds until something must be looked at."""
        now = time.monotonic()
        waits = [child.deadline - now for child in self._children.values() if child.deadline and not child.stopped]
        if any(child.memory for child in self._children.values()):
            waits.append(self._next_look - now)
        return max(min(waits), 0.0) if waits else None

    def _watch(self) -> None:
        now = time.monotonic()
        for child in self._children.values():
            if child.deadline and now >= child.deadline and not child.stopped:
                self._stop(child, "timeout")
        if now < self._next_look or not any(child.memory for child in self._children.values()):
            return
        used = process_sessions.resident()
        for child in self._children.values():
            child.peak = max(child.peak, used.get(child.pid, 0))
            if child.memory and child.peak > child.memory and not child.stopped:
                self._stop(child, "memory")
        end = time.monotonic()
        self._next_look = end + max(_LOOK, (end - now) / _SHARE)

    def _stop(self, child: _Child, reason: str) -> None:
        if not child.stopped:
            child.stopped = reason
            self._selector.unregister(child.connection)
        with contextlib.suppress(ProcessLookupError):
            os.kill(child.pid, signal.SIGKILL)  # it may not have made its session yet
        process_sessions.kill(child.pid)

    def _reap(self) -> None:
        """Take note of every process that has ended: jobs, and orphans of theirs."""
        while True:
            try:
                pid, status, usage = os.wait4(-1, os.WNOHANG)
            except ChildProcessError:
                return
            if pid == 0:
                return
            child = self._children.pop(pid, None)
            if child is None:
                continue
            process_sessions.kill(pid)
            if not child.stopped:
                self._selector.unregister(child.connection)
            verdict = process_sessions.verdict(child.stopped, status, usage, child.peak)
            with contextlib.suppress(OSError), child.connection as connection:  # nobody may be listening
                connection.sendall(json.dumps(asdict(verdict)).encode() + b"\n")

    def _end_all(self) -> None:
        for child in self._children.values():
            self._stop(child, "unwanted")


def preload() -> None:
    """Import what jobs need: every filter, and meshio with its formats. No thread may be started here."""
    import scipy.spatial  # noqa: F401

    meshio_module()
    for name in filter_names():
        with contextlib.suppress(WctError):  # a job that needs a broken one says so
            find_filter(name)
    versions()


def main(control: int) -> None:
    """Serve on a socket that the starting process holds the other side of."""
    preload()
    Server(socket.socket(fileno=control)).serve()
