"""Many cases of commands: a child runs them in forks; where it dies itself, that is a finding too."""

import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.fuzz import children, command_case
from benchmarks.fuzz.findings import Finding, Findings


def run(seed: int, first: int, last: int, seconds: float, findings: Findings) -> int:
    """Run the cases ``first`` to ``last`` of a seed for so long; gives the number of the first that was not run."""
    end = time.monotonic() + seconds
    while first < last and time.monotonic() < end:
        first = _child(seed, first, last, end - time.monotonic(), findings)
    return first


def _child(seed: int, first: int, last: int, seconds: float, findings: Findings) -> int:
    """Run cases in one child; gives the number of the next one to run. Each case has a limit of its own."""
    ended = children.listen(
        "command", (seed, first, last, seconds), first, None, findings, lambda found: _note(seed, found, findings)
    )
    if not ended.whole:
        fault = f"the judge ended with {ended.code}"
        _note(seed, {"number": ended.number, "name": "", "faults": [fault], "said": ""}, findings)
    return ended.number + 1


def _note(seed: int, found: dict[str, Any], findings: Findings) -> None:
    with tempfile.TemporaryDirectory(prefix="wct-fuzz-") as name:
        command_case.make(seed, found["number"], Path(name))
        faults = tuple(found["faults"])
        findings.add(Finding("command", seed, found["number"], found["name"], faults, found["said"]), Path(name))
