"""Another program in a process of its own: all of it is ended on timeout or Ctrl-C, the error quotes its last lines."""

import logging
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from wct_plugin.errors import NeighbourError, OptionError

if sys.platform == "linux":
    import resource

#: Seconds for which Python may sleep without looking whether Ctrl-C was pressed.
_LONGEST_NAP = 1.0
#: Bytes of what was printed last that say where a program stands.
_LAST = 4096

_log = logging.getLogger(__name__)


class ChildError(NeighbourError):
    """The program ended with an error code or by a signal; ``output`` is all it printed."""

    def __init__(self, message: str, output: str) -> None:
        super().__init__(message)
        self.output = output


def run(
    command: Sequence[str | Path],
    folder: str | Path,
    timeout: float | None,
    who: str,
    memory: int | None = None,
    advice: str = "",
    heard: Callable[[str], object] | None = None,
) -> str:
    """Run ``command`` in ``folder`` and give what it printed, stdout and stderr together.

    Parameters
    ----------
    command : sequence of str or Path
        The program, to be found on the PATH, and its arguments; it reads nothing.
    folder : str or Path
        Its working directory.
    timeout : float or None
        Seconds after which it is ended, with every process it started; None waits for ever.
    who : str
        Its name, the first word of every message.
    memory : int or None
        Bytes of address space it may take; None is no limit. Only Linux can do that.
    advice : str
        What would make it faster, for the message of a timeout.
    heard : callable, optional
        Called about every second with the last of what it printed so far; nothing, on systems where that is not known.

    Raises
    ------
    ChildError
        For an exit code other than 0 and for a crash.
    NeighbourError
        If it was ended after ``timeout``, or cannot be started.
    OptionError
        For a memory limit where the system has none.
    """
    if memory is not None and sys.platform != "linux":
        raise OptionError(f"{who}'s memory cannot be limited on {sys.platform}; leave the limit out")
    _log.debug("%s: %s", who, " ".join(map(str, command)))
    try:
        # A process group of its own, so that what the program starts is ended with it.
        child = subprocess.Popen(
            [*_dying_with_us(), *map(str, command)],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            process_group=0,
        )
    except OSError as error:
        raise NeighbourError(f"{who} cannot be started: {error.strerror or error}") from error
    with child:
        try:
            if memory is not None and sys.platform == "linux":
                resource.prlimit(child.pid, resource.RLIMIT_AS, (memory, memory))
            said = _output(child, timeout, heard)
        except subprocess.TimeoutExpired as error:
            _end(child)
            hint = f"; {advice}" if advice else ""
            raise NeighbourError(f"{who} was stopped after {timeout:g} s, its timeout{hint}") from error
        except BaseException:  # Ctrl-C does not reach native code, nor another process group
            _end(child)
            raise
    output = said.decode(errors="replace")
    if child.returncode < 0:
        raise ChildError(f"{who} crashed with {signal.Signals(-child.returncode).name}{last_words(output)}", output)
    if child.returncode:
        raise ChildError(f"{who} failed with exit code {child.returncode}{last_words(output)}", output)
    return output


def _dying_with_us() -> list[str]:
    """What to put before a command so that a kill of our own process, which we cannot answer, ends it too."""
    setpriv = shutil.which("setpriv") if sys.platform == "linux" else None  # of util-linux, like prlimit and mount
    return [setpriv, "--pdeathsig", "KILL"] if setpriv else []


def _output(
    child: "subprocess.Popen[bytes]", timeout: float | None, heard: Callable[[str], object] | None = None
) -> bytes:
    """All that it prints until it ends; :class:`subprocess.TimeoutExpired` if that takes longer than ``timeout``.

    A Ctrl-C just before Python blocks is noticed only when it wakes up: so it does now and then.
    """
    end = math.inf if timeout is None else time.monotonic() + timeout
    while True:
        left = end - time.monotonic()
        try:
            return child.communicate(timeout=max(0.0, min(_LONGEST_NAP, left)))[0]
        except subprocess.TimeoutExpired as error:
            if left <= _LONGEST_NAP:
                raise
            if heard is not None:
                heard((error.output or b"")[-_LAST:].decode(errors="replace"))


def _end(child: subprocess.Popen[bytes]) -> None:
    if child.returncode is not None:
        return
    if sys.platform == "win32":
        child.kill()
    else:
        os.killpg(child.pid, signal.SIGKILL)
    child.wait()


def last_words(output: str, lines: int = 2) -> str:
    """The last lines that are not empty, as the end of a message; nothing if there are none."""
    printed = [" ".join(line.split()) for line in output.splitlines()]
    said = " | ".join([line for line in printed if line][-lines:])
    return f"; it last said: {said[-300:]}" if said else ""
