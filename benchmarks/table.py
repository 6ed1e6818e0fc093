"""The rows as markdown and JSON."""

import json
import os
import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from benchmarks.peers import MESHER

Row = dict[str, Any]

#: Key of a row, head of its column, how a value is printed.
_COLUMNS = (
    ("3wc", "3WC %", ".2f"),
    ("2wc", "2WC %", ".2f"),
    ("cwc", "CWC %", ".2f"),
    ("min_height", "min h/R", ".3f"),
    ("min_dihedral", "dihedral min", ".1f"),
    ("max_dihedral", "max", ".1f"),
    ("radius_over_edge", "max R/l", ".2f"),
    ("tets", "tets", "d"),
    ("deviation", "deviation / diagonal", ".1e"),
    ("volume_change", "volume", "+.2%"),
    ("cpu", "CPU s", ".2f"),
    ("ms_per_tet", "ms / tet", ".2f"),
    ("cpu_ratio", "CPU / fTetWild", ".2f"),
    ("memory", "peak MB", ".0f"),
    ("memory_above", "above start MB", ".0f"),
    ("load", "load", ".1f"),
)
_MEANS = ("3wc", "2wc", "cwc", "cpu", "ms_per_tet", "cpu_ratio", "memory_above")


def machine(packages: Iterable[str]) -> dict[str, Any]:
    """What it ran on, and the version of each package, None where it is not installed."""
    return {
        "cores": os.cpu_count(),
        "processor": platform.machine(),
        "system": platform.system(),
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in packages},
    }


def markdown(rows: list[Row], about: dict[str, Any]) -> str:
    """One table per mesh, then the means per tool over all meshes it finished."""
    versions = ", ".join(f"{name} {found}" for name, found in about["packages"].items() if found)
    lines = [
        "# Well-centering side by side",
        "",
        f"{about['system']} {about['processor']}, {about['cores']} cores, Python {about['python']}; {versions}.",
        "CPU seconds and memory are the tool's alone, its children included, Python's start and the imports not.",
        "Deviation is two-sided, from the surface of the mesh's name where one was given, else from the input's own",
        "boundary. Load is the machine's average over the last minute when the tool started.",
        "fTetWild fills that surface at about the input's count of tets, in the same run.",
    ]
    rows = beside_mesher(rows)
    for mesh in dict.fromkeys(row["mesh"] for row in rows):
        lines += ["", f"## {mesh}", "", *_table([row for row in rows if row["mesh"] == mesh])]
    return "\n".join([*lines, "", "## Means", "", *_means(rows), ""])


def beside_mesher(rows: list[Row]) -> list[Row]:
    """The rows, those with a CPU time also with its ratio to fTetWild's on the same mesh, if that finished."""
    mesher = {row["mesh"]: row["cpu"] for row in rows if row["tool"] == MESHER.name and row["status"] == "ok"}
    return [
        row | {"cpu_ratio": row["cpu"] / mesher[row["mesh"]]} if "cpu" in row and row["mesh"] in mesher else row
        for row in rows
    ]


def write(rows: list[Row], about: dict[str, Any], folder: Path) -> None:
    """``bench.md`` and ``bench.json`` in ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "bench.md").write_text(markdown(rows, about))
    (folder / "bench.json").write_text(json.dumps({"machine": about, "rows": beside_mesher(rows)}, indent=1) + "\n")


def note(row: Row) -> str:
    """What a reader should know of a row: why there is no mesh, or what is wrong with it."""
    if row["status"] != "ok":
        return str(row["status"])
    notes = [f"{row['inverted']} inverted"] if row["inverted"] else []
    return ", ".join(notes + ([] if row["encloses"] else ["tets overlap or leave gaps"]))


def show(value: float | None, form: str) -> str:
    """A value in a cell, a dash where there is none."""
    return "-" if value is None else format(value, form)


def line(cells: Iterable[str]) -> str:
    """A row of a markdown table."""
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"


def _table(rows: list[Row]) -> list[str]:
    head = ["tool", *(title for _, title, _ in _COLUMNS), "note"]
    lines = [line(head), line(["---"] * len(head))]
    for row in rows:
        cells = [show(row.get(key), form) for key, _, form in _COLUMNS]
        lines.append(line([row["tool"], *cells, note(row)]))
    return lines


def _means(rows: list[Row]) -> list[str]:
    forms = {key: (title, form) for key, title, form in _COLUMNS}
    lines = [line(["tool", "meshes", "tets / input", *(forms[key][0] for key in _MEANS)])]
    lines.append(line(["---"] * (3 + len(_MEANS))))
    before = {row["mesh"]: row["tets"] for row in rows if row["tool"] == "input"}
    for tool in dict.fromkeys(row["tool"] for row in rows):
        own = [row for row in rows if row["tool"] == tool]
        done = [row for row in own if "tets" in row]
        cells = [tool, f"{len(done)} of {len(own)}"]
        if done:
            cells.append(f"{sum(row['tets'] / before[row['mesh']] for row in done) / len(done):.2f}")
            cells += [show(_mean([row.get(key) for row in done]), forms[key][1]) for key in _MEANS]
        else:
            cells += ["-"] * (1 + len(_MEANS))
        lines.append(line(cells))
    return lines


def _mean(values: list[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known else None


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
