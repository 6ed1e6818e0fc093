"""What half and double of the core's numbers do to meshes: the table of docs/numbers.md.

``python -m benchmarks.numbers MESH...`` makes a copy of the source in which the numbers of the option structs are asked
of the environment, builds it once, and runs every mesh with each number as it is, halved and doubled. ``--only`` names
those that are to be tried, all others are left.
"""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import sysconfig
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import click

import wct_plugin as wct

_ROOT = Path(__file__).resolve().parents[1]
_WORK = _ROOT / "build" / "numbers"
#: The structs whose numbers are tried, by the headers that hold them.
HEADERS = (
    "domain/sizing.h",
    "sampling/cloud_descent.h",
    "sampling/resample.h",
    "sampling/seeds.h",
    "search/search_energy.h",
)
#: Wall time of a run in seconds, and address space in bytes, after which it is said not to end: some numbers are bounds
#: of loops. Runs as they are take a minute and a gigabyte at most.
_LONGEST = 600.0
_MOST = 16 << 30
_NUMBER = re.compile(
    r"^    (?P<static>static constexpr )?(?P<type>double|int) (?P<name>\w+) = (?P<value>[-+.\de]+);", re.MULTILINE
)
_STRUCT = re.compile(r"^(?:struct|class) (\w+)", re.MULTILINE)

#: Put before every source file: a number, or the share of it that the environment asks for.
_ASKED = """#pragma once
#include <cstdlib>
#include <string_view>
namespace wct_numbers {
template <class Number> Number asked(std::string_view name, Number value) {
    const char *which = std::getenv("WCT_NUMBER"), *share = std::getenv("WCT_SHARE");
    return which && share && name == which ? static_cast<Number>(value * std::atof(share)) : value;
}
}
"""


@dataclass(frozen=True)
class Number:
    """A number of an option struct: ``struct.name``, and its value as it is written."""

    name: str
    value: str


@dataclass(frozen=True)
class Outcome:
    """What one run over a mesh gave."""

    bad: int
    tets: int
    evaluations: int
    seconds: float
    losses: int


def asked_for(header: str) -> tuple[str, list[Number]]:
    """A header whose numbers are asked for as the program starts, and these numbers."""
    numbers = []

    def replaced(found: re.Match[str]) -> str:
        struct = _STRUCT.findall(header[: found.start()])[-1]
        if not struct.endswith(("Form", "Options")) or float(found["value"]) == 0.0:
            return found[0]
        number = Number(f"{struct}.{found['name']}", found["value"])
        numbers.append(number)
        static = "static inline const " if found["static"] else ""
        call = f'::wct_numbers::asked<{found["type"]}>("{number.name}", {found["value"]})'
        return f"    {static}{found['type']} {found['name']} = {call};"

    return _NUMBER.sub(replaced, header), numbers


def _build() -> tuple[Path, list[Number]]:
    """A folder with the package built from the copy, and the numbers that can be asked for."""
    source, site = _WORK / "source", _WORK / "site"
    shutil.rmtree(_WORK, ignore_errors=True)
    ignored = shutil.ignore_patterns(".git", ".venv", "build", "__pycache__", "tests", "docs")
    shutil.copytree(_ROOT, source, ignore=ignored)
    (source / "asked.h").write_text(_ASKED)
    numbers: list[Number] = []
    for name in HEADERS:
        path = source / "cpp" / name
        text, found = asked_for(path.read_text())
        path.write_text(text)
        numbers += found
    flags = f"{os.environ.get('CXXFLAGS', '')} -include {source / 'asked.h'}"
    install = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "-q",
        "--no-deps",
        "--target",
        site,
        source,
    ]
    subprocess.run(install, check=True, env={**os.environ, "CXXFLAGS": flags})
    return site, numbers


def _run(site: Path, mesh: Path, name: str, share: float) -> Outcome:
    """A process of its own, without site and the folder it runs in: both have the modules of the source tree."""
    path = os.pathsep.join(map(str, (site, _ROOT, _ROOT / "tests", sysconfig.get_path("purelib"))))
    environment = {**os.environ, "PYTHONPATH": path, "WCT_NUMBER": name, "WCT_SHARE": str(share)}
    command = [sys.executable, "-S", "-P", "-m", "benchmarks.numbers", "--one", mesh]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True, timeout=_LONGEST)
    return Outcome(**json.loads(done.stdout))


def _one(mesh: Path) -> Outcome:
    warnings.simplefilter("ignore")
    resource.setrlimit(resource.RLIMIT_AS, (_MOST, _MOST))
    given = wct.read(mesh)
    before = time.process_time()
    made, metrics = wct.apply_filter("meshing_well_centered", given)
    seconds = time.process_time() - before
    assert isinstance(made, wct.TetMesh)
    return Outcome(metrics["bad"], len(made.tets), metrics["evaluations"], seconds, len(metrics["losses"]))


def _cells(usual: list[Outcome], others: list[Outcome]) -> Iterator[str]:
    """Bad tets and losses in the end; then tets, evaluations and CPU against what is usual, means over the meshes."""
    yield f"{sum(each.bad for each in others)}, {sum(each.losses for each in others)}"
    for name in ("tets", "evaluations", "seconds"):
        ratios = [getattr(other, name) / getattr(one, name) for one, other in zip(usual, others, strict=True)]
        yield f"{sum(ratios) / len(ratios):.2f}"


@click.command()
@click.argument("given", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--only", multiple=True, metavar="STRUCT.NAME", help="Try this number; may be repeated. Without: all.")
@click.option("--one", is_flag=True, hidden=True)
def main(given: tuple[Path, ...], only: tuple[str, ...], one: bool) -> None:
    """Write build/numbers.md."""
    if one:
        click.echo(json.dumps(vars(_one(given[0]))))
        return
    site, numbers = _build()
    if unknown := set(only) - {number.name for number in numbers}:
        raise click.BadParameter(f"no such number: {', '.join(sorted(unknown))}", param_hint="--only")
    usual = [_run(site, mesh, "", 1.0) for mesh in given]
    table = _ROOT / "build" / "numbers.md"
    head = [
        "number",
        "value",
        *(f"{share}: {what}" for share in ("half", "double") for what in ("bad, losses", "tets", "evaluations", "CPU")),
    ]
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    lines.append(f"| as they are | | {' | '.join(_cells(usual, usual))} | | | | |")
    for number in numbers:
        if only and number.name not in only:
            continue
        cells = [number.name, number.value]
        for share in (0.5, 2.0):
            try:
                cells += _cells(usual, [_run(site, mesh, number.name, share) for mesh in given])
            except subprocess.CalledProcessError as error:
                cells += [error.stderr.strip().splitlines()[-1], "", "", ""]
            except subprocess.TimeoutExpired:
                cells += [f"no end in {_LONGEST:g} s", "", "", ""]
        lines.append(f"| {' | '.join(cells)} |")
        click.echo(lines[-1])
        table.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
