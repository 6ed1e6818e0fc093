"""Many cases of mutated files, read by a child after the other; one that dies or hangs is a finding of its case."""

import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.fuzz import file_case, seed_files
from benchmarks.fuzz.findings import Finding, Findings

#: Cases of one child, and wall seconds after which one that says nothing is taken for hung.
CHUNK, SILENCE = 4000, 60.0


def run(seeds: Path, seed: int, first: int, last: int, findings: Findings) -> None:
    """Run the cases ``first`` to ``last`` of a seed; findings are added to what there is."""
    places = seed_files.made(seeds)
    while first < last:
        first = _child(seeds, places, seed, first, min(last, first + CHUNK), findings)


def _child(seeds: Path, places: list[Path], seed: int, first: int, last: int, findings: Findings) -> int:
    """Run cases in one child; gives the number of the next one to run."""
    command = [
        sys.executable,
        "-W",
        "ignore",
        "-m",
        "benchmarks.fuzz.file_child",
        str(seeds),
        *map(str, (seed, first, last)),
    ]
    env = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=env)
    number, told, silent = first - 1, _Lines(child), False
    while (line := told.next()) is not None:
        if line.isdigit():
            number = int(line)
            continue
        found: dict[str, Any] = json.loads(line)
        if "counts" in found:
            findings.counts.update({f"file {what}": count for what, count in found["counts"].items()})
        else:
            _note(places, seed, found, findings)
    silent = told.silent
    if silent:
        child.kill()
    code = child.wait()
    assert child.stdout is not None
    child.stdout.close()
    if code == 0:
        return last
    if number < first:
        raise RuntimeError(f"the child of file cases ended with {code} before its first case")
    fault = f"said nothing for {SILENCE:g} s" if silent else _ended(code)
    _note(places, seed, {"number": number, "file": "", "faults": [fault], "said": ""}, findings)
    return number + 1


def _ended(code: int) -> str:
    return f"the process died of {signal.Signals(-code).name}" if code < 0 else f"the process ended with {code}"


def _note(places: list[Path], seed: int, found: dict[str, Any], findings: Findings) -> None:
    with tempfile.TemporaryDirectory(prefix="wct-fuzz-") as name:
        path = file_case.make(places, seed, found["number"], Path(name))
        finding = Finding(
            "file", seed, found["number"], found["file"] or path.name, tuple(found["faults"]), found["said"]
        )
        findings.add(finding, Path(name))


class _Lines:
    """The lines that a child prints, until it ends or is silent for too long."""

    def __init__(self, child: "subprocess.Popen[bytes]") -> None:
        assert child.stdout is not None
        self._fd, self._left, self.silent = child.stdout.fileno(), b"", False
        self._waiting = selectors.DefaultSelector()
        self._waiting.register(self._fd, selectors.EVENT_READ)

    def next(self) -> str | None:
        """The next line; None at the end."""
        while b"\n" not in self._left:
            if not self._waiting.select(SILENCE):
                self.silent = True
                return None
            more = os.read(self._fd, 1 << 16)
            if not more:
                return None
            self._left += more
        line, _, self._left = self._left.partition(b"\n")
        return line.decode()
