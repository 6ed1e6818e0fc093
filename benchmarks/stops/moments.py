"""Stops at moments all over the life of a process: while it imports, reads, measures, writes, or runs others."""

import json
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.fuzz.judge import result, said
from benchmarks.fuzz.random_mesh import Made
from benchmarks.stops.cases import cube
from benchmarks.stops.forks import Found

_WCT = Path(sys.executable).with_name("wct")
_REPORTS = ["--json", "out.json", "--html", "out.html"]
#: Arguments of wct, in a folder with meshes in.vtu and part0.vtu to part2.vtu and a pipeline.
COMMANDS = {
    "report": ["report", "in.vtu", "--exact", *_REPORTS],
    "optimize": ["optimize", "in.vtu", "out.vtu", "--goal", "3wc", *_REPORTS],
    "run": ["run", "chain.json", "in.vtu", "out.vtu", "out.html"],
    "batch": ["batch", "chain.json", "part*.vtu", "-o", "out", "--jobs", "1"],
}
_KINDS: dict[str, Sequence[signal.Signals]] = {
    "SIGINT": (signal.SIGINT,), "SIGTERM": (signal.SIGTERM,), "SIGINT, SIGTERM": (signal.SIGINT, signal.SIGTERM),
}  # fmt: skip


def run(name: str, count: int) -> Found:
    """Stop a command at ``count`` moments, evenly over the time that it takes, by each kind."""
    found = Found()
    with tempfile.TemporaryDirectory(prefix="wct-stops-") as folder:
        _prepare(Path(folder) / "whole")
        start = time.monotonic()
        _stopped(COMMANDS[name], Path(folder) / "whole", None, ())
        whole = time.monotonic() - start
        for kind, signals in _KINDS.items():
            for k in range(count):
                after = (k + 0.5) / count * whole
                place = Path(folder) / f"{kind}{k}"
                _prepare(place)
                inputs = {path.name for path in place.iterdir()}
                code, text, seconds = _stopped(COMMANDS[name], place, after, signals)
                found.stops["moments"] += 1
                found.codes[f"{kind}: {code}"] += 1
                found.waited = max(found.waited, seconds)
                faults = _faults(name, code, text, place, inputs)
                if name == "batch" and len(signals) > 1:  # a second one while it tidies up: the next batch does that
                    faults = [fault for fault in faults if fault != ".wct-batch is left"]
                found.faults += [f"{kind} at {after:.2f} s: {fault}" for fault in faults]
    return found


def _prepare(place: Path) -> None:
    place.mkdir()
    for file in ("in.vtu", "part0.vtu", "part1.vtu", "part2.vtu"):
        points, tets = cube(3)
        Made("", points, tets, np.ones(len(tets), dtype=np.int64)).write(place / file)
    (place / "chain.json").write_text(json.dumps([{"type": "filters.meshing_well_centered", "goal": "delaunay"}]))


def _stopped(
    arguments: Sequence[str], place: Path, after: float | None, signals: Sequence[signal.Signals]
) -> tuple[int, str, float]:
    """Start a command, send it signals after some seconds; exit code, what it said, and the seconds it still took."""
    process = subprocess.Popen(
        [_WCT, *arguments], cwd=place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    if after is not None:
        try:
            process.wait(after)
        except subprocess.TimeoutExpired:
            for one in signals:
                process.send_signal(one)
    start = time.monotonic()
    text, _ = process.communicate(timeout=120)
    return process.returncode, text, time.monotonic() - start


def _faults(name: str, code: int, text: str, place: Path, inputs: set[str]) -> list[str]:
    left = {path.name for path in place.iterdir()} - inputs
    hidden = [one.name for one in place.rglob(".*")]
    faults = [f"{one} is left" for one in sorted(hidden)]
    if code < 0 and "wct_plugin" not in text:  # Python itself was not there yet, or all was done
        return faults
    faults += said.faults_of_output(text)
    lines = [line for line in text.splitlines() if line.startswith("error: ")]
    if code == 2 and (len(lines) != 1 or not lines[0].startswith("error: interrupted; ")):
        faults.append(f"exit code 2, and it says {lines}")
    if code == 2 and name != "batch":
        told = set(lines[0].rpartition("written before: ")[2].split(", ")) if lines and "before" in lines[0] else set()
        if told != left:
            faults.append(f"it says {lines[0]!r}, and {sorted(left)} is written")
    if code not in (0, 1, 2):
        faults.append(f"the exit code is {code}: {text[-200:]}")
    for path in (place / one for one in left if one.endswith(".json")):
        json.loads(path.read_text())
    for path in place.rglob("*.vtu"):
        if path.name not in inputs or path.parent != place:
            faults += result.faults_of_mesh(result.load(path))
    return faults
