"""Wavefront OBJ, geometry only, read here: meshio fails where texture coordinates and vertices differ in number."""

from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io import vtk_cells
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.mesh import SurfaceMesh


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """Vertices and faces; normals, texture coordinates and materials are of no use to a mesher.

    Raises :class:`InputError`, without the file's name, for a malformed line.
    """
    points: list[list[float]] = []
    sizes: list[int] = []
    faces: list[int] = []
    with path.open(encoding="utf-8", errors="strict") as file:
        for number, line in enumerate(file, start=1):
            words = line.split()
            if not words or words[0] not in ("v", "f"):
                continue
            try:
                if words[0] == "v":
                    points.append([float(word) for word in words[1:4]])
                    good = len(points[-1]) == 3
                else:
                    corners = [int(word.split("/")[0]) for word in words[1:]]
                    good = 0 not in corners
            except ValueError:
                good = False
            if not good:
                raise InputError(f"line {number} is {line.strip()[:60]!r}; expected 'v x y z' or 'f a b c'")
            if words[0] == "f":
                sizes.append(len(corners))
                # Negative numbers count back from the last vertex so far.
                faces += [corner - 1 if corner > 0 else len(points) + corner for corner in corners]
    blocks, _ = vtk_cells.faces(np.array(sizes, dtype=np.int64), np.array(faces, dtype=np.int64), {})
    return RawMesh(np.array(points).reshape(-1, 3), blocks), []


def write(path: Path, surface: SurfaceMesh) -> None:
    """Vertices and triangles, every digit kept."""
    with path.open("w") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in surface.points.tolist())
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in (surface.triangles + 1).tolist())
