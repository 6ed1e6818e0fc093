"""Many cases of commands: a child runs them in forks; where it dies itself, that is a finding too."""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.fuzz import command_case
from benchmarks.fuzz.findings import Finding, Findings


def run(seed: int, first: int, last: int, seconds: float, findings: Findings) -> int:
    """Run the cases ``first`` to ``last`` of a seed for so long; gives the number of the first that was not run."""
    end = time.monotonic() + seconds
    while first < last and time.monotonic() < end:
        first = _child(seed, first, last, end - time.monotonic(), findings)
    return first


def _child(seed: int, first: int, last: int, seconds: float, findings: Findings) -> int:
    command = [
        sys.executable,
        "-W",
        "ignore",
        "-m",
        "benchmarks.fuzz.command_child",
        *map(str, (seed, first, last, seconds)),
    ]
    env = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    child = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=env)
    number, whole = first - 1, False
    assert child.stdout is not None
    for line in child.stdout:
        if line.strip().isdigit():
            number = int(line)
            continue
        found: dict[str, Any] = json.loads(line)
        if "counts" in found:
            whole = True
            findings.counts.update({f"command {what}": count for what, count in found["counts"].items()})
        else:
            _note(seed, found, findings)
    code = child.wait()
    child.stdout.close()
    if number < first:
        raise RuntimeError(f"the child of commands ended with {code} before its first case")
    if not whole:
        _note(seed, {"number": number, "name": "", "faults": [f"the judge ended with {code}"], "said": ""}, findings)
    return number + 1


def _note(seed: int, found: dict[str, Any], findings: Findings) -> None:
    with tempfile.TemporaryDirectory(prefix="wct-fuzz-") as name:
        command_case.make(seed, found["number"], Path(name))
        faults = tuple(found["faults"])
        findings.add(Finding("command", seed, found["number"], found["name"], faults, found["said"]), Path(name))
