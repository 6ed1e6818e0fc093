"""The TetGen of the Python package ``tetgen``, made to look like the program: its arguments, its files.

``python -m wct_plugin.adapters.tetgen_wheel BYTES SWITCHES surface.poly`` runs in the folder of ``surface.poly``. BYTES
is what TetGen may take beside Python, 0 for no limit. Its native code may end the process, as the program does.
"""

import os
import sys
from pathlib import Path

import numpy as np

from wct_plugin.types import Floats, Ints

if sys.platform == "linux":
    import resource

#: Where TetGen lists the facets that it left out, as they cross others; the last column is the facet's marker.
_SKIPPED = Path("tetgen-tmpfile_skipped.face")


def _limit(size: int) -> None:
    """Let this process take so many bytes of address space beside what it has."""
    if sys.platform == "linux":
        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (taken + size, taken + size))


def _surface(path: str) -> tuple[Floats, Ints, Ints]:
    """Points, triangles and markers of the file as :mod:`wct_plugin.adapters.tetgen` writes it."""
    lines = Path(path).read_text().splitlines()
    count, facets = int(lines[0].split()[0]), int(lines[int(lines[0].split()[0]) + 1].split()[0])
    points = np.loadtxt(lines[1 : count + 1], ndmin=2)[:, 1:4]
    body = lines[count + 2 : count + 2 + 2 * facets]
    markers = np.loadtxt(body[0::2], dtype=np.int64, ndmin=2)[:, 2]
    return np.ascontiguousarray(points), np.loadtxt(body[1::2], dtype=np.int64, ndmin=2)[:, 1:4], markers


def _write(path: Path, *columns: Floats | Ints) -> None:
    """A file of TetGen's, each row with its number; all digits of a float are kept."""
    rows = np.column_stack([np.arange(len(columns[0])), *columns]).astype(float)
    with path.open("w") as file:
        file.write(f"{len(rows)}\n")
        np.savetxt(file, rows, fmt="%.17g")


def main(memory: str, switches: str, path: str) -> tuple[int, str, object]:
    """Do what the program would; gives its exit code, what it would print, and TetGen's object.

    Where facets cross, TetGen writes beyond its arrays, and the end of its object then ends the process: what is to be
    printed must have been by then.
    """
    from tetgen import TetGen

    points, triangles, markers = _surface(path)
    looking = "d" in switches
    if looking:  # for faults, which are then named by their triangle
        markers = np.arange(1, len(triangles) + 1)
    if int(memory):
        _limit(int(memory))
    filled = TetGen(points, triangles.astype(np.int32), markers.astype(np.int32))
    try:
        nodes, tets, regions, marked = filled.tetrahedralize(switches=switches.removeprefix("-"))
    except MemoryError:
        return 1, "Out of memory\n", filled
    except RuntimeError as error:
        if _SKIPPED.exists():
            skipped = np.loadtxt(_SKIPPED, skiprows=1, dtype=int, ndmin=2)[:, -1]
            return 0 if looking else 1, f"Skipped facets {' '.join(map(str, skipped))}\n", filled
        if looking and "Failed to tetrahedralize" in str(error):  # as it must: it was not asked to
            return 0, "", filled
        if type(error) is not RuntimeError:  # its own for no tets
            return 0, "", filled
        return 1, f"{error}\n", filled
    stem = path.removesuffix(".poly")
    _write(Path(f"{stem}.1.node"), nodes)
    _write(Path(f"{stem}.1.ele"), tets, regions)
    _write(Path(f"{stem}.1.face"), filled.trifaces, marked)
    return 0, "", filled


if __name__ == "__main__":
    code, said, filled = main(*sys.argv[1:])
    sys.stdout.write(said)
    sys.stdout.flush()
    os._exit(code)  # with the object as it is
