"""Random cases for so many minutes, or one case once more: ``python -m benchmarks.fuzz --case file:1:1283``."""

import sys
import tempfile
import time
from pathlib import Path

import click

from benchmarks.fuzz import command_child, command_run, file_case, file_run, seed_files, tie_case, tie_run
from benchmarks.fuzz.findings import Findings

#: Of the time, the share that each kind gets: mutated files are many in it, and commands few.
SHARES = {"file": 0.3, "command": 0.6, "tie": 0.1}
_MOST = 10_000_000


@click.command()
@click.option("--minutes", default=30.0, show_default=True, help="How long, in all.")
@click.option("--seed", default=0, show_default=True, help="Of all cases.")
@click.option("--kind", type=click.Choice(list(SHARES)), help="Cases of this kind only.")
@click.option("--cases", default=_MOST, help="How many of each kind, at most.")
@click.option("--case", "case", metavar="KIND:SEED:NUMBER", help="One case only, whose files are kept and shown.")
@click.option("--out", default=Path("build/fuzz"), type=click.Path(path_type=Path), show_default=True)
def main(minutes: float, seed: int, kind: str | None, cases: int, case: str | None, out: Path) -> None:
    """Run random cases; findings are kept below OUT, and the exit code is 1 where there are some."""
    if case is not None:
        sys.exit(_again(case, out))
    findings = Findings(out / "findings")
    for one in SHARES if kind is None else [kind]:
        seconds = 60 * minutes * (SHARES[one] if kind is None else 1)
        match one:
            case "file":
                _files(seed, cases, seconds, out, findings)
            case "command":
                command_run.run(seed, 0, cases, seconds, findings)
            case _:
                tie_run.run(seed, cases, seconds, findings)
    click.echo("\n".join(findings.lines()))
    sys.exit(bool(findings.found))


def _files(seed: int, cases: int, seconds: float, out: Path, findings: Findings) -> None:
    end, first = time.monotonic() + seconds, 0
    while time.monotonic() < end and first < cases:
        file_run.run(out / "seeds", seed, first, min(cases, first + file_run.CHUNK), findings)
        first += file_run.CHUNK


def _again(case: str, out: Path) -> int:
    """Run one case here and now, its files in a folder that stays; gives the exit code."""
    kind, seed, number = case.split(":")
    place = Path(tempfile.mkdtemp(prefix=f"wct-fuzz-{case.replace(':', '-')}-"))
    if kind == "file":
        path = file_case.make(seed_files.made(out / "seeds"), int(seed), int(number), place)
        outcome = file_case.read_and_judge(path)
        click.echo(f"{path}\n{outcome.what}: {outcome.said}")
        faults = list(outcome.faults)
    elif kind == "tie":
        points, tets = tie_case.make(int(seed), int(number))
        click.echo(f"points = {points.tolist()}\ntets = {tets.tolist()}")
        faults = tie_case.judged(points, tets)
    else:
        made, ran, faults = command_child.whole(int(seed), int(number), place)
        click.echo(
            f"{place}\nwct {' '.join(made.arguments)}\n{ran.text}exit code {ran.code}, {ran.cpu:.1f} s of CPU time"
        )
    click.echo("\n".join(f"fault: {fault}" for fault in faults) or "no fault")
    return bool(faults)


if __name__ == "__main__":
    main()
