"""A job in a process of its own, and its record however that ended; the caller's side of the process that forks."""

import array
import contextlib
import json
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from types import TracebackType

from wct_plugin.adapters import child_process
from wct_plugin.batch import starters
from wct_plugin.batch.job import RECORD, Job, Record, failure
from wct_plugin.batch.spawning import Spawner
from wct_plugin.batch.starters import LostError, Starter, UnwantedError, Verdict, environment

#: A send to someone who is gone is an error, not our death by SIGPIPE: gmsh, once started, sets that signal back.
_NO_SIGNAL = getattr(socket, "MSG_NOSIGNAL", 0)


class ForkServer:
    """Starts the process that forks when it is first needed, and again should it be lost. For any number of threads.

    ``jobs`` is how many are to run at once: numerical libraries get that share of the cores.
    """

    def __init__(self, jobs: int = 1) -> None:
        self._jobs = jobs
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._closed = False

    def __enter__(self) -> "ForkServer":
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def run(self, job: Job, attempt: Path, wanted: Callable[[], bool]) -> Verdict:
        """Do ``job`` in the folder ``attempt`` and wait for its end, asking now and then whether it is still wanted."""
        mine, theirs = socket.socketpair()
        with mine:
            try:
                with theirs, self._lock:
                    self._send(theirs)
                mine.sendall(json.dumps({"job": asdict(job), "attempt": str(attempt)}).encode() + b"\n", _NO_SIGNAL)
                mine.settimeout(1.0)
                said = b""
                while not said.endswith(b"\n"):
                    try:
                        part = mine.recv(4096)
                    except TimeoutError:
                        if not wanted():
                            raise UnwantedError(f"{job.source}: given up") from None
                        continue
                    if not part:
                        raise ConnectionResetError
                    said += part
            except ConnectionError as error:
                if self._closed:
                    raise UnwantedError(f"{job.source}: given up") from error
                raise LostError(f"no process could be started for the job{self._last_words()}") from error
        return Verdict(**json.loads(said))

    def close(self) -> None:
        """End every job and the process that forks."""
        with self._lock:
            self._closed = True
            self._disconnect()

    def _send(self, connection: socket.socket) -> None:
        """Hand over the other end of a job's connection; :func:`socket.send_fds` of Python 3.11 drops the flag."""
        for again in (True, False):
            try:
                if sys.platform != "win32":  # which does not come here
                    handle = (socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", [connection.fileno()]))
                    self._connected().sendmsg([b"j"], [handle], _NO_SIGNAL)
                return
            except BrokenPipeError:  # a process that ends hangs up some time before: poll() does not see it yet
                if not again:
                    raise
                self._disconnect()

    def _connected(self) -> socket.socket:
        if self._closed:
            raise ConnectionResetError
        if self._process is not None and self._process.poll() is not None:
            self._disconnect()
        if self._control is None:
            self._start()
        assert self._control is not None
        return self._control

    def _start(self) -> None:
        """Start the process that forks; where that cannot be, all is as before, and the next job tries again."""
        start = "import json, sys; sys.path[:] = json.loads(sys.argv[2])"  # where our own modules come from
        start += "; from wct_plugin.batch.fork_server import main; main(int(sys.argv[1]))"
        with contextlib.ExitStack() as unless_started:
            try:
                mine, theirs = map(unless_started.enter_context, socket.socketpair())
                words = unless_started.enter_context(tempfile.TemporaryFile())
                process = subprocess.Popen(
                    [sys.executable, "-P", "-c", start, str(theirs.fileno()), json.dumps(sys.path)],
                    pass_fds=[theirs.fileno()],
                    env=environment(self._jobs),
                    stdin=subprocess.DEVNULL,
                    stdout=words,
                    stderr=words,
                    start_new_session=True,  # Ctrl-C in the terminal is for us alone
                )
            except OSError as error:
                raise LostError(f"no process could be started for the job: {error.strerror or error}") from error
            unless_started.pop_all()
        theirs.close()
        self._control, self._process, self._words = mine, process, words

    def _disconnect(self) -> None:
        if self._control is None or self._process is None:
            return
        self._control.close()
        self._control = None
        try:
            self._process.wait(20)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._words.close()

    def _last_words(self) -> str:
        with self._lock:
            if self._words.closed:
                return ""
            self._words.seek(0)
            return child_process.last_words(self._words.read().decode(errors="replace"), lines=1)


def starter(jobs: int = 1) -> Starter:
    """What starts jobs on this system, so many at once."""
    return ForkServer(jobs) if starters.forks() else Spawner(jobs)


@cache
def _worker_starter() -> Starter:
    """The one of a process that others send jobs to; it ends with the process."""
    return starter()


def run_isolated(job: Job, by: Starter | None = None) -> tuple[Record, str]:
    """Do a job in a process of its own: its record, and the folder of the attempt with the outputs in it.

    Whatever the process does, there is a record. Raises :class:`UnwantedError` if the job's folder of work goes away.
    """
    by = by or _worker_starter()
    start = time.perf_counter()
    for again in (True, False):
        try:
            attempt = Path(tempfile.mkdtemp(dir=job.work, prefix=f"{job.name}."))
        except FileNotFoundError as error:
            raise UnwantedError(f"{job.source}: given up") from error
        try:
            verdict = by.run(job, attempt, attempt.exists)
            break
        except LostError as error:
            if not again:
                return failure(job, str(error), _since(start)), str(attempt)
        shutil.rmtree(attempt, ignore_errors=True)
    if (made := read_record(attempt)) is not None:
        return _measured(made, verdict), str(attempt)
    if not attempt.exists():
        raise UnwantedError(f"{job.source}: given up")
    record = failure(job, _cause(job, verdict, attempt), _since(start))
    return _measured(record, verdict), str(attempt)


def _measured(record: Record, verdict: Verdict) -> Record:
    seconds = None if verdict.cpu_seconds is None else round(verdict.cpu_seconds, 3)
    return replace(record, cpu_seconds=seconds, peak_bytes=verdict.peak_bytes)


def read_record(attempt: Path) -> Record | None:
    """What an attempt left behind when it was finished; None if it was not."""
    try:
        return Record.from_json((attempt / RECORD).read_bytes())
    except (OSError, ValueError):
        return None


def _since(start: float) -> float:
    return round(time.perf_counter() - start, 3)


def _cause(job: Job, verdict: Verdict, attempt: Path) -> str:
    """Why there is no record, in one line."""
    if verdict.stopped == "timeout":
        return f"was stopped after {job.timeout:g} s, its timeout"
    if verdict.stopped == "memory" and job.memory and verdict.peak_bytes:
        return f"was stopped when it used {_mega(verdict.peak_bytes)} MB of memory; its limit is {_mega(job.memory)} MB"
    words = ""
    with contextlib.suppress(OSError):
        words = (attempt / "words").read_text("utf-8", errors="replace")
    said = child_process.last_words(words, lines=1)
    if verdict.signal and signal.Signals(verdict.signal).name == "SIGKILL":  # which Windows does not know
        return "was killed, most likely because the system ran out of memory"
    if verdict.signal:
        return f"crashed with {signal.Signals(verdict.signal).name}{said}"
    return f"ended without a result, exit code {verdict.exit_code}{said}"


def _mega(size: int) -> int:
    return round(size / (1 << 20))
