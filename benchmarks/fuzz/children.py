"""Children that run cases one after the other: what they tell, until they end, die, or say nothing for too long."""

import json
import os
import selectors
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.fuzz.findings import Findings


@dataclass(frozen=True)
class Ended:
    """How a child has ended."""

    number: int  #: of the last case that it began
    whole: bool  #: whether it came to the end of its cases
    code: int  #: exit code; that of a signal is negative
    silent: bool  #: whether it was ended, as it said nothing for too long


def listen(
    kind: str,
    arguments: Sequence[object],
    first: int,
    silence: float | None,
    findings: Findings,
    note: Callable[[dict[str, Any]], None],
) -> Ended:
    """Run the child of a kind of cases, of which the ``first`` is its own, and hear what it tells.

    Before each case it prints the number, after it a line of JSON where there is a fault, which is handed to ``note``,
    and at the end how many cases there were of which outcome. Raises :class:`RuntimeError` where it ends before it
    begins.
    """
    command = [sys.executable, "-W", "ignore", "-m", f"benchmarks.fuzz.{kind}_child", *map(str, arguments)]
    env = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    number, whole, silent = first - 1, False, False
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=env) as child:
        for line in _lines(child, silence):
            if line is None:
                silent = True
                child.kill()
                break
            if line.strip().isdigit():
                number = int(line)
                continue
            found: dict[str, Any] = json.loads(line)
            if "counts" in found:
                whole = True
                findings.counts.update({f"{kind} {what}": count for what, count in found["counts"].items()})
            else:
                note(found)
        code = child.wait()
    if number < first:
        raise RuntimeError(f"the child of {kind} cases ended with {code} before its first case")
    return Ended(number, whole, code, silent)


def _lines(child: "subprocess.Popen[bytes]", silence: float | None) -> Iterator[str | None]:
    """The lines that a child prints until it ends, or None where it is silent for so long."""
    assert child.stdout is not None
    left = b""
    with selectors.DefaultSelector() as waiting:
        waiting.register(child.stdout, selectors.EVENT_READ)
        while True:
            if not waiting.select(silence):
                yield None
                return
            more = os.read(child.stdout.fileno(), 1 << 16)
            if not more:
                return
            *whole, left = (left + more).split(b"\n")
            yield from (line.decode() for line in whole)
