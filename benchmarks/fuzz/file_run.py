"""Many cases of mutated files, read by a child after the other; one that dies or hangs is a finding of its case."""

import signal
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.fuzz import children, file_case, seed_files
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
    ended = children.listen(
        "file", (seeds, seed, first, last), first, SILENCE, findings, lambda found: _note(places, seed, found, findings)
    )
    if ended.code == 0:
        return last
    fault = f"said nothing for {SILENCE:g} s" if ended.silent else _ended(ended.code)
    _note(places, seed, {"number": ended.number, "file": "", "faults": [fault], "said": ""}, findings)
    return ended.number + 1


def _ended(code: int) -> str:
    return f"the process died of {signal.Signals(-code).name}" if code < 0 else f"the process ended with {code}"


def _note(places: list[Path], seed: int, found: dict[str, Any], findings: Findings) -> None:
    with tempfile.TemporaryDirectory(prefix="wct-fuzz-") as name:
        path = file_case.make(places, seed, found["number"], Path(name))
        finding = Finding(
            "file", seed, found["number"], found["file"] or path.name, tuple(found["faults"]), found["said"]
        )
        findings.add(finding, Path(name))
