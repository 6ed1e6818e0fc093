"""CPU time and memory as a mesh of one shape gets finer, fTetWild's beside ours: ``python -m benchmarks.growth``.

Each mesh stays near its own facets, so that every size is as hard as the others: near one sphere at one tolerance the
coarse ones, whose edges the tolerance cuts short, would be hard and the fine ones easy.
"""

import json
import sys
from itertools import groupby
from math import log
from pathlib import Path
from typing import Any

import click
from support.builders import ball, jittered_cube

import wct_plugin as wct
from benchmarks import table
from benchmarks.judge import row_of
from benchmarks.ours import MESHING
from benchmarks.peers import MESHER
from benchmarks.run import run

Row = dict[str, Any]

#: What makes the shape from a number of cells, and about how many tets come out per cell.
_SHAPES = {"ball": (ball, 28.0), "cube": (jittered_cube, 7.0)}
_SIZES = (10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
_FACTOR = 300_000 // _SIZES[0]
#: The mesher's last size: beyond, it takes minutes to hours.
_MESHED = 300_000
#: Where other tools are run beside the two, and which: those that mesh, and the remesher, once each.
_BESIDE = 100_000
_OTHERS = ("TetGen -pYq1.2/12 -a", "gmsh Delaunay", "gmsh HXT", "Netgen from boundary", "mmg3d -optim")
_COLUMNS = (
    ("tets", "tets", "d"),
    ("cpu", "CPU s", ".2f"),
    ("wall", "wall s", ".2f"),
    ("ms_per_tet", "ms / tet", ".3f"),
    ("memory_above", "above start MB", ".1f"),
    ("kb_per_tet", "kB / tet", ".2f"),
    ("3wc", "3WC %", ".2f"),
    ("cwc", "CWC %", ".2f"),
    ("deviation", "deviation / diagonal", ".1e"),
    ("load", "load", ".1f"),
)


@click.command()
@click.option("--most", default=1_000_000, show_default=True, help="Stop at about so many tets.")
@click.option("--timeout", default=3600.0, show_default=True, help="Seconds per tool and size.")
@click.option("--out", default=Path("build/bench"), type=click.Path(path_type=Path), show_default=True)
def main(most: int, timeout: float, out: Path) -> None:
    """Run both tools on a ball and a cube in growing resolution; write growth.md, growth.json and growth.png.

    The mesher stops at 300 thousand tets. At 100 thousand tets five other tools run beside them.
    """
    if most < _SIZES[0]:
        raise click.UsageError(f"--most is {most}; the smallest size is {_SIZES[0]}")
    folder = out / "growth"
    folder.mkdir(parents=True, exist_ok=True)
    about = table.machine(["wct_plugin", MESHER.package])
    rows: list[Row] = []
    for size in (size for size in _SIZES if size <= most):
        for shape, (make, tets_per_cell) in _SHAPES.items():
            mesh = make(round((size / tets_per_cell) ** (1 / 3)))
            file = folder / f"{shape}{size}.vtu"
            wct.write(file, mesh)
            mesher = (MESHER.name,) if size <= _MESHED else ()
            for tool in (*mesher, MESHING.name, *(_OTHERS if size == _BESIDE else ())):
                click.echo(f"{file.stem}: {tool} ... ", nl=False, err=True)
                outcome = run(tool, file, None, timeout)
                rows.append({"shape": shape, **row_of(file.stem, tool, outcome, mesh, mesh.boundary_surface())})
                click.echo(rows[-1]["status"], err=True)
                (out / "growth.json").write_text(json.dumps({"machine": about, "rows": rows}, indent=1) + "\n")
                (out / "growth.md").write_text(markdown(rows, about))
    plotted = plot(rows, out / "growth.png")
    click.echo(markdown(rows, about))
    click.echo(f"wrote growth.md, growth.json{' and growth.png' if plotted else ''} in {out}", err=True)


def summary(rows: list[Row]) -> list[str]:
    """A line per shape and tool: the cost per tet at the largest finished size, and how time grew up to it."""
    lines = []
    for name, own in _finished(rows).items():
        first, last = own[0], own[-1]
        cost = f"{last['ms_per_tet']:.2f} ms and {last['kb_per_tet']:.2f} kB per tet at {last['tets']} tets"
        if last["tets"] <= first["tets"]:
            lines.append(f"{name}: {cost}")
            continue
        grown = last["tets"] / first["tets"]
        power = log(last["cpu"] / first["cpu"]) / log(grown)
        line = f"{name}: {cost}; over a factor {grown:.1f} in tets CPU time grows as tets^{power:.2f}"
        # The counts are only about those asked for; a shorter curve says little of a longer one.
        lines.append(f"{line}: t(300 k) / t(10 k) = {_FACTOR**power:.1f}" if grown > 0.7 * _FACTOR else line)
    return lines


def markdown(rows: list[Row], about: dict[str, Any]) -> str:
    """The summary, then a row per run."""
    head = ["mesh", "tool", *(title for _, title, _ in _COLUMNS), "note"]
    lines = [
        "# Growth",
        "",
        f"{about['system']} {about['processor']}, {about['cores']} cores, Python {about['python']}.",
        "Two shapes in growing resolution, each mesh near its own facets and in a process of its own. CPU seconds and",
        "memory are the tool's alone; per tet means per tet that comes out.",
        "",
        *(f"- {line}" for line in summary(rows)),
        "",
        table.line(head),
        table.line(["---"] * len(head)),
    ]
    for row in rows:
        cells = [table.show(row.get(key), form) for key, _, form in _COLUMNS]
        lines.append(table.line([row["mesh"], row["tool"], *cells, table.note(row)]))
    beside = [row for row in rows if row["mesh"].endswith(str(_BESIDE)) and "ms_per_tet" in row]
    lines += ["", "CPU seconds per million tets that come out, and how many of them are well-centered:", ""]
    lines += [table.line(["mesh", "tool", "CPU s", "3WC %", "CWC %"]), table.line(["---"] * 5)]
    for row in sorted(beside, key=lambda row: (row["shape"], row["ms_per_tet"])):
        cells = [f"{1e3 * row['ms_per_tet']:.1f}", f"{row['3wc']:.1f}", f"{row['cwc']:.1f}"]
        lines.append(table.line([row["shape"], row["tool"], *cells]))
    return "\n".join([*lines, ""])


def plot(rows: list[Row], file: Path) -> bool:
    """CPU seconds and kilobytes per tet over tets; False where matplotlib is not installed."""
    try:
        import matplotlib
    except ImportError:
        return False
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (time, memory) = pyplot.subplots(1, 2, figsize=(10, 4.5), layout="constrained")
    for name, own in _finished(rows).items():
        tets = [row["tets"] for row in own]
        time.loglog(tets, [row["cpu"] for row in own], "o-", label=name)
        memory.loglog(tets, [row["kb_per_tet"] for row in own], "o-", label=name)
    if time.lines:
        ends = time.get_xlim()
        time.loglog(ends, [1e-3 * end for end in ends], "k:", label="1 ms, 2 kB per tet")
        memory.loglog(ends, [2.0, 2.0], "k:")
        for axes in (time, memory):
            axes.set_xlim(ends)
        figure.legend(*time.get_legend_handles_labels(), loc="outside lower center", ncols=5, fontsize="small")
    time.set(xlabel="tets out", ylabel="CPU s")
    memory.set(xlabel="tets out", ylabel="peak memory above start, kB per tet")
    figure.savefig(file, dpi=120)
    pyplot.close(figure)
    return True


def _finished(rows: list[Row]) -> dict[str, list[Row]]:
    """The rows of each shape and tool that have a mesh and its cost, by count of tets."""
    done = sorted(
        (row for row in rows if "ms_per_tet" in row and row["tool"] not in _OTHERS),
        key=lambda row: (_curve(row), row["tets"]),
    )
    return {name: list(own) for name, own in groupby(done, key=_curve)}


def _curve(row: Row) -> str:
    return f"{row['shape']}, {row['tool']}"


if __name__ == "__main__":
    sys.exit(main())
