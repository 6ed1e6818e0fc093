"""Stop small runs in every stage: ``python -m benchmarks.stops [--most 2] [--case NAME]`` prints a table."""

import argparse
import json
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from benchmarks.stops import moments, runs
from benchmarks.stops.cases import CASES
from benchmarks.stops.forks import Found

WAYS = {"command": runs.as_command, "Python": runs.in_python}


def _run_here(name: str, way: str, most: int) -> None:
    """In a process of its own: run one case, and print what was found as JSON, the last line."""
    case = next(one for one in CASES if one.name == name)
    with tempfile.TemporaryDirectory(prefix="wct-stops-") as folder:
        found = WAYS[way](case, most, Path(folder))
    missed = set(case.stages) - set(found.stops)
    found.faults += [f"{stage} was never stopped" for stage in sorted(missed)]
    print(json.dumps(vars(found)))  # noqa: T201


def _run(name: str, way: str, most: int) -> Found:
    command = [sys.executable, "-W", "ignore", "-m", "benchmarks.stops", "--here", name, way, str(most)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        told = json.loads(done.stdout.strip().splitlines()[-1])
    except (IndexError, json.JSONDecodeError):
        return Found(faults=[f"the run itself ended with {done.returncode}: {done.stderr[-300:]}"])
    return Found(Counter(told["stops"]), Counter(told["codes"]), told["longest"], told["waited"], told["faults"])


def _row(what: str, found: Found) -> str:
    stages = ", ".join(f"{stage} {count}" for stage, count in sorted(found.stops.items()))
    codes = ", ".join(f"{code}×{count}" for code, count in sorted(found.codes.items()))
    cells = what, str(found.stops.total()), stages, codes, f"{found.longest:.1f}", f"{found.waited:.1f}"
    return f"| {' | '.join(cells)} | {len(found.faults)} |"


def main() -> int:
    """Print a row for each run, and what did not hold; exit code 1 where there is some."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most", type=int, default=2, help="calls of each visit to a stage at which it is stopped")
    parser.add_argument("--case", action="append", choices=[*(one.name for one in CASES), *moments.COMMANDS])
    parser.add_argument("--here", nargs=3, metavar=("NAME", "WAY", "MOST"), help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.here:
        name, way, most = asked.here
        _run_here(name, way, int(most))
        return 0
    print("| run | stops | in | ended with | longest CPU s | longest s | faults |")  # noqa: T201
    print("|---|---:|---|---|---:|---:|---:|")  # noqa: T201
    faults = []
    for name in asked.case or [*(one.name for one in CASES), *moments.COMMANDS]:
        for way in WAYS if name not in moments.COMMANDS else ("moments",):
            found = moments.run(name, 8 * asked.most) if way == "moments" else _run(name, way, asked.most)
            print(_row(f"{name}, {way}", found), flush=True)  # noqa: T201
            faults += [f"{name}, {way}: {fault}" for fault in found.faults]
    print("\n".join(f"- {fault}" for fault in faults))  # noqa: T201
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
