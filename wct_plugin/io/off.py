"""OFF surfaces, read here: meshio takes one header layout only and waits for ever on a file that ends in it."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io import vtk_cells
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.mesh import SurfaceMesh


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """Vertices and faces; colours and normals are left.

    Raises :class:`InputError`, without the file's name, for a malformed or short file.
    """
    with path.open(encoding="utf-8", errors="strict") as file:
        rows = (words for line in file if (words := line.partition("#")[0].split()))
        head = next(rows, [""])
        if not re.fullmatch("[STCN]*OFF", head[0]):  # the letters announce texture, colours and normals per vertex
            raise InputError(f"begins with {head[0][:20]!r}; expected 'OFF'")
        counts = head[1:] or next(rows, [])
        if len(counts) < 2 or not all(count.isdigit() for count in counts[:2]):
            raise InputError("has no line with its numbers of vertices and faces")
        points = [_numbers(rows, "vertex", k, int(counts[0]))[:3] for k in range(int(counts[0]))]
        sizes, faces = [], []
        for k in range(int(counts[1])):
            row = _numbers(rows, "face", k, int(counts[1]))
            sizes.append(int(row[0]))
            corners = row[1 : 1 + sizes[-1]]
            if len(corners) != sizes[-1]:
                raise InputError(f"face {k} of {counts[1]} has {len(corners)} corners but announces {sizes[-1]}")
            faces += [int(corner) for corner in corners]
    blocks, _ = vtk_cells.faces(np.array(sizes, dtype=np.int64), np.array(faces, dtype=np.int64), {})
    return RawMesh(np.array(points).reshape(-1, 3), blocks), []


def write(path: Path, surface: SurfaceMesh) -> None:
    """Vertices and triangles, every digit kept."""
    with path.open("w") as file:
        file.write(f"OFF\n{len(surface.points)} {len(surface.triangles)} 0\n")
        file.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in surface.points.tolist())
        file.writelines(f"3 {a} {b} {c}\n" for a, b, c in surface.triangles.tolist())


def _numbers(rows: Iterator[list[str]], kind: str, number: int, count: int) -> list[float]:
    words = next(rows, [])
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    needed = 3 if kind == "vertex" else 4
    if len(values) < needed:
        raise InputError(f"{kind} {number} of {count} is {' '.join(words)[:60]!r}; expected {needed} numbers")
    return values
