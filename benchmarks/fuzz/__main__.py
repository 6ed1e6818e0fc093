"""Random cases for so many minutes, or one case once more: ``python -m benchmarks.fuzz --case file:1:1283``."""

import sys
import tempfile
import time
from pathlib import Path

import click

from benchmarks.fuzz import command_child, command_run, file_case, file_run, seed_files
from benchmarks.fuzz.findings import Findings

#: Of the time, the share that mutated files get: they are many in it, and commands few.
FILES = 0.35
_MOST = 10_000_000


@click.command()
@click.option("--minutes", default=30.0, show_default=True, help="How long, in all.")
@click.option("--seed", default=0, show_default=True, help="Of all cases.")
@click.option("--kind", type=click.Choice(["file", "command"]), help="Cases of this kind only.")
@click.option("--case", "case", metavar="KIND:SEED:NUMBER", help="One case only, whose files are kept and shown.")
@click.option("--out", default=Path("build/fuzz"), type=click.Path(path_type=Path), show_default=True)
def main(minutes: float, seed: int, kind: str | None, case: str | None, out: Path) -> None:
    """Run random cases; findings are kept below OUT, and the exit code is 1 where there are some."""
    if case is not None:
        sys.exit(_again(case, out))
    findings = Findings(out / "findings")
    if kind != "command":
        _files(seed, 60 * minutes * (FILES if kind is None else 1), out, findings)
    if kind != "file":
        command_run.run(seed, 0, _MOST, 60 * minutes * (1 - FILES if kind is None else 1), findings)
    click.echo("\n".join(findings.lines()))
    sys.exit(bool(findings.found))


def _files(seed: int, seconds: float, out: Path, findings: Findings) -> None:
    end, first = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        file_run.run(out / "seeds", seed, first, first + file_run.CHUNK, findings)
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
    else:
        made, ran, faults = command_child.whole(int(seed), int(number), place)
        click.echo(
            f"{place}\nwct {' '.join(made.arguments)}\n{ran.text}exit code {ran.code}, {ran.cpu:.1f} s of CPU time"
        )
    click.echo("\n".join(f"fault: {fault}" for fault in faults) or "no fault")
    return bool(faults)


if __name__ == "__main__":
    main()
