"""Jobs as fresh processes, where a fork cannot be had: slower by what Python and NumPy take to start, else the same.

The caller holds the other end of a job's standard input. That it closes says, on every system, that the caller is gone,
whatever it died of; the job then ends, with what it has started.
"""

import contextlib
import io
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

from wct_plugin.batch.job import Job, perform
from wct_plugin.batch.starters import LostError, UnwantedError, Verdict, environment

_REQUEST = "job.json"
_LOOK = 0.05  #: seconds between two looks at whether a job has ended
_START = """\
import json, sys
sys.path[:] = json.loads(sys.argv[1])  # where our own modules come from
from wct_plugin.batch.spawning import main
sys.exit(main(sys.argv[2]))
"""
if sys.platform == "win32":
    _NEW_GROUP = subprocess.CREATE_NEW_PROCESS_GROUP
else:
    from wct_plugin.batch import process_sessions

    _NEW_GROUP = 0


class Spawner:
    """Starts a Python for each job; ``jobs`` is how many are to run at once."""

    def __init__(self, jobs: int = 1) -> None:
        self._jobs = jobs
        self._closed = threading.Event()

    def run(self, job: Job, attempt: Path, wanted: Callable[[], bool]) -> Verdict:
        """Do ``job`` in the folder ``attempt`` and wait for its end, asking now and then whether it is still wanted."""
        if self._closed.is_set():
            raise UnwantedError(f"{job.source}: given up")
        command = [sys.executable, "-P", "-c", _START, json.dumps(sys.path), str(attempt)]
        try:
            (attempt / _REQUEST).write_text(json.dumps(asdict(job)), encoding="utf-8")
            with (attempt / "words").open("ab") as words:
                process = subprocess.Popen(
                    command,
                    env=environment(self._jobs),
                    stdin=subprocess.PIPE,
                    stdout=words,
                    stderr=words,
                    creationflags=_NEW_GROUP,  # Ctrl-C in the terminal is for us alone
                    start_new_session=True,  # the same elsewhere
                )
        except OSError as error:
            raise LostError(f"no process could be started for the job: {error.strerror or error}") from error
        with process:
            try:
                return self._outcome(process, job, wanted)
            finally:
                _end(process)

    def close(self) -> None:
        """End every job."""
        self._closed.set()

    def _outcome(self, process: "subprocess.Popen[bytes]", job: Job, wanted: Callable[[], bool]) -> Verdict:
        deadline = None if job.timeout is None else time.monotonic() + job.timeout
        asked = time.monotonic()
        while (verdict := _verdict(process)) is None:
            now = time.monotonic()
            if deadline is not None and now >= deadline:
                return Verdict("timeout", 0, 0)
            if now - asked > 1:
                asked = now
                if not wanted():
                    raise UnwantedError(f"{job.source}: given up")
            if self._closed.wait(_LOOK):
                raise UnwantedError(f"{job.source}: given up")
        return verdict


def _verdict(process: "subprocess.Popen[bytes]") -> Verdict | None:
    """How the process has ended; None while it runs."""
    if sys.platform == "win32":
        code = process.poll()
        return None if code is None else Verdict("", 0, code)
    else:  # noqa: RET505  # mypy would look at what follows on Windows too
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if not ended:
            return None
        process.returncode = os.waitstatus_to_exitcode(status)
        return process_sessions.verdict("", status, usage)


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End the process and what it has started; its standard input is closed by whoever waits for it."""
    if sys.platform == "win32":
        if process.poll() is None:
            subprocess.run(["taskkill", "/F", "/T", "/PID", str(process.pid)], capture_output=True)
    else:
        process_sessions.kill(process.pid)
    if process.returncode is None:
        with contextlib.suppress(OSError):
            process.kill()


def main(attempt: str) -> int:
    """Be the job of this folder, in the new process; gives its exit code."""
    threading.Thread(target=_end_with_caller, daemon=True).start()
    if sys.platform != "win32":
        process_sessions.die_first()
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if isinstance(sys.stdout, io.TextIOWrapper):  # what it says last is heard even if it leaves by os._exit
        sys.stdout.reconfigure(line_buffering=True)
    job = Job(**json.loads(Path(attempt, _REQUEST).read_text(encoding="utf-8")))
    return perform(job, Path(attempt))


def _end_with_caller() -> None:
    while os.read(0, 1):
        pass
    if sys.platform != "win32":
        process_sessions.kill_own()
    os._exit(1)
