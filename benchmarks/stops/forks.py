"""Forks at the calls of a progress callback: each child is stopped there, and goes on to its end."""

import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

#: Seconds after which a child that does not end is ended.
_HUNG = 120
#: How often a stage is visited, at most: it comes again with each new start.
_VISITS = 3


@dataclass(frozen=True)
class Ended:
    """How a child ended."""

    code: int  #: exit code; that of a signal is negative
    text: str  #: what it printed since it was stopped
    seconds: float
    cpu: float


@dataclass
class Found:
    """What came of the stops of one run."""

    stops: Counter[str] = field(default_factory=Counter)  #: by stage
    codes: Counter[str] = field(default_factory=Counter)  #: by kind of stop and exit code
    longest: float = 0.0  #: CPU seconds from the stop to the end of the process
    waited: float = 0.0  #: the same by the clock
    faults: list[str] = field(default_factory=list)


class Forks:
    """At some calls of each stage, the first, second, fourth, ..., a child for each kind of stop."""

    def __init__(
        self, kinds: Sequence[str], most: int, folder: Path, judge: Callable[[str, str, Ended], list[str]]
    ) -> None:
        self.found = Found()
        self._kinds, self._most, self._folder, self._judge = kinds, most, folder, judge
        self._calls: Counter[str] = Counter()
        self._visits: Counter[str] = Counter()
        self._stage = ""
        self._stopped = False  # in a child

    def at(self, stage: str) -> str:
        """In a child the kind of stop that it is for; in the parent, which has judged the children, nothing."""
        if self._stopped:
            return ""
        name = stage.partition(",")[0]
        if name != self._stage:
            self._stage = name
            self._visits[name] += 1
        key = f"{name} {min(self._visits[name], _VISITS)}"
        self._calls[key] += 1
        calls = self._calls[key]
        if calls & (calls - 1) or calls.bit_length() > self._most:
            return ""
        for kind in self._kinds:
            if self._child(kind, name):
                self._stopped = True
                return kind
        return ""

    def _child(self, kind: str, stage: str) -> bool:
        """Fork; in the parent, wait and judge. Gives whether this is the child."""
        sys.stdout.flush()
        sys.stderr.flush()
        beside = Path(tempfile.mkdtemp(prefix="wct-stops-"))
        _link(self._folder, beside / "before")
        start = time.monotonic()
        child = os.fork()
        if child == 0:
            _print_into(beside / "printed")
            return True
        _, status, usage = os.wait4(child, 0)
        seconds, cpu = time.monotonic() - start, usage.ru_utime + usage.ru_stime
        text = (beside / "printed").read_text(errors="replace")
        self._note(kind, stage, Ended(os.waitstatus_to_exitcode(status), text, seconds, cpu))
        _restore(self._folder, beside / "before")
        shutil.rmtree(beside)
        return False

    def _note(self, kind: str, stage: str, ended: Ended) -> None:
        found = self.found
        found.stops[stage] += 1
        found.codes[f"{kind}: {ended.code}"] += 1
        found.longest, found.waited = max(found.longest, ended.cpu), max(found.waited, ended.seconds)
        try:
            faults = self._judge(kind, stage, ended)
        except Exception as error:
            faults = [f"what is left cannot be judged: {type(error).__name__}: {error}"]
        found.faults += [f"{kind} in {stage}, call {self._calls.total()}: {fault}" for fault in faults]


def _link(folder: Path, there: Path) -> None:
    """A folder's files under other names: what replaces one of them later leaves it there."""
    there.mkdir()
    for path in folder.iterdir():
        os.link(path, there / path.name)


def _restore(folder: Path, before: Path) -> None:
    """Let a folder have the same files again, not only such: outputs are known by what they are on the disk."""
    for path in folder.iterdir():
        kept = before / path.name
        if path.is_dir():
            shutil.rmtree(path)
        elif not kept.exists() or not kept.samefile(path):
            path.unlink()
    for kept in before.iterdir():
        if not (folder / kept.name).exists():
            os.link(kept, folder / kept.name)


def _print_into(path: Path) -> None:
    """In the child: what it prints goes into a file, and it ends some time."""
    printed = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.alarm(_HUNG)
