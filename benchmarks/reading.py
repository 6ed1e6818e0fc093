"""CPU time of reading text files, ours beside VTK's and meshio's: ``python -m benchmarks.reading``.

The file is read whole, and what is read is an array of points and one of cells; each reader runs in a process of its
own, whose start and imports do not count.
"""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import Any

import click
import numpy as np
from support.builders import kuhn_cube

from benchmarks import table
from benchmarks.child import NOT_INSTALLED
from benchmarks.run import watch
from wct_plugin.io import read, write
from wct_plugin.mesh import SurfaceMesh

Row = dict[str, Any]

READERS = ("ours", "VTK", "meshio")
_VTK = {".ply": "vtkPLYReader", ".obj": "vtkOBJReader", ".stl": "vtkSTLReader"}
_SURFACES = ("surface.ply", "surface.obj", "surface.off", "surface.stl")
_VOLUMES = ("tets22.msh", "tets41.msh", "tets.mesh")


def torus(cells: int) -> SurfaceMesh:
    """A torus of about so many triangles, its coordinates of single precision as exporters write them."""
    m = max(3, round((cells / 4) ** 0.5))
    i, k = np.divmod(np.arange(2 * m * m), m)
    u, v = np.pi * i / m, 2 * np.pi * k / m
    ring = 2.0 + np.cos(v)
    points = np.column_stack([ring * np.cos(u), ring * np.sin(u), np.sin(v)]).astype(np.float32).astype(np.float64)
    right, up = (i + 1) % (2 * m) * m + k, i * m + (k + 1) % m
    both = (i + 1) % (2 * m) * m + (k + 1) % m
    corners = np.column_stack([i * m + k, right, both, i * m + k, both, up])
    return SurfaceMesh(points, corners.reshape(-1, 3))


def make(folder: Path, cells: int) -> list[Path]:
    """The files, written where they are not there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / name for name in (*_SURFACES, *_VOLUMES)]
    if all(path.exists() for path in paths):
        return paths
    surface = torus(cells)
    rows = [" ".join(f"{value:.9g}" for value in point) for point in surface.points.tolist()]
    faces = [" ".join(map(str, face)) for face in surface.triangles.tolist()]
    head = f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n" + "".join(f"property float {a}\n" for a in "xyz")
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    triples = "\n".join(f"3 {face}" for face in faces)
    paths[0].write_text(head + "\n".join(rows) + "\n" + triples + "\n")
    one_based = "\n".join("f " + " ".join(map(str, face)) for face in (surface.triangles + 1).tolist())
    paths[1].write_text("".join(f"v {row}\n" for row in rows) + one_based + "\n")
    paths[2].write_text(f"OFF\n{len(rows)} {len(faces)} 0\n" + "\n".join(rows) + "\n" + triples + "\n")
    with paths[3].open("w") as file:
        file.write("solid torus\n")
        for face in surface.triangles.tolist():
            corners = "".join(f"   vertex {rows[corner]}\n" for corner in face)
            file.write(f" facet normal 0.57735 0.57735 0.57735\n  outer loop\n{corners}  endloop\n endfacet\n")
        file.write("endsolid torus\n")
    cube = kuhn_cube(max(1, round((cells / 6) ** (1 / 3))))
    write(paths[4], cube, version="2.2")
    write(paths[5], cube, version="4.1")
    write(paths[6], cube)
    return paths


def reader_of(name: str, file: Path) -> Callable[[], Any] | None:
    """What reads the file, ready to go; None where it reads no such file."""
    if name == "ours":
        read(Path(__file__).resolve().parents[1] / "tests/data/channel.msh")  # imports what reading imports
        return lambda: read(file)
    if name == "meshio":
        import meshio

        meshio.Mesh(np.zeros((3, 3)), [("triangle", np.array([[0, 1, 2]]))])
        return lambda: meshio.read(file)
    if file.suffix not in _VTK:
        return None
    import vtk

    source = getattr(vtk, _VTK[file.suffix])()
    source.SetFileName(str(file))

    def run() -> int:
        source.Update()
        return int(source.GetOutput().GetNumberOfCells())

    return run


def measure(name: str, file: Path, result: Path) -> int:
    """Write the CPU seconds of one reader on one file."""
    try:
        run = reader_of(name, file)
    except ImportError:
        return NOT_INSTALLED
    if run is None:
        result.write_text(json.dumps(None))
        return 0
    before = process_time()
    run()
    result.write_text(json.dumps(process_time() - before))
    return 0


def rows_of(paths: list[Path], folder: Path, timeout: float) -> list[Row]:
    """A row per file: the CPU seconds of each reader, and how many times the fastest of the others ours takes."""
    rows = []
    for path in paths:
        row: Row = {"file": path.name, "mb": path.stat().st_size / 1e6}
        for name in READERS:
            result = folder / "seconds.json"
            result.unlink(missing_ok=True)
            command = [sys.executable, "-m", "benchmarks.reading", "--measure", name, str(path.resolve())]
            status = watch([*command, "--result", str(result.resolve())], folder, timeout)
            row[name] = json.loads(result.read_text()) if status == "ok" else status
        others = [row[name] for name in READERS[1:] if isinstance(row[name], float)]
        row["ratio"] = row["ours"] / min(others) if others and isinstance(row["ours"], float) else None
        rows.append(row)
    return rows


def markdown(rows: list[Row], about: dict[str, Any]) -> str:
    """The rows as a table."""
    versions = ", ".join(f"{name} {found}" for name, found in about["packages"].items() if found)
    lines = ["# Reading text files", "", f"CPU seconds; {versions}", ""]
    lines += ["| file | MB | ours | VTK | meshio | ours / fastest |", "| --- | --- | --- | --- | --- | --- |"]
    for row in rows:
        cells = [row["file"], f"{row['mb']:.0f}", *(_shown(row[name]) for name in (*READERS, "ratio"))]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _shown(value: Any) -> str:
    return f"{value:.2f}" if isinstance(value, float) else str(value or "–")


@click.command()
@click.option("--cells", default=1_000_000, show_default=True, help="Triangles, and tets.")
@click.option("--timeout", default=300.0, show_default=True, help="Seconds per reader and file.")
@click.option("--out", default=Path("build/bench"), type=click.Path(path_type=Path), show_default=True)
@click.option("--measure", "only", nargs=2, hidden=True)
@click.option("--result", type=click.Path(path_type=Path), hidden=True)
def main(cells: int, timeout: float, out: Path, only: tuple[str, str] | None, result: Path) -> None:
    """Read large text files by each reader; write reading.md and reading.json."""
    if only:
        sys.exit(measure(only[0], Path(only[1]), result))
    paths = make(out / f"reading{cells}", cells)
    about = table.machine(["wct_plugin", "numpy", "vtk", "meshio"])
    rows = rows_of(paths, out, timeout)
    (out / "reading.json").write_text(json.dumps({"about": about, "rows": rows}, indent=2))
    (out / "reading.md").write_text(markdown(rows, about))
    click.echo(markdown(rows, about))


if __name__ == "__main__":
    main()
