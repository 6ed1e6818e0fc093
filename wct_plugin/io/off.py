"""OFF surfaces, read here: meshio takes one header layout only and waits for ever on a file that ends in it."""

import re
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io import vtk_cells
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import columns_of_rows, lists_of_rows, next_rows, shown, whole_number
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.types import Floats, Ints


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """Vertices and faces; colours and normals are left.

    Raises :class:`InputError`, without the file's name, for a malformed or short file.
    """
    text = path.read_bytes()
    text = re.sub(rb"#[^\r\n]*", b"", text) if b"#" in text else text
    if b"\n" not in text:
        text = text.replace(b"\r", b"\n")
    # The letters announce texture, colours and normals per vertex; the counts may stand in the same line.
    head = re.match(rb"\s*[STCN]*OFF(?:[^\S\n]*\n)?\s*(\d+)\s+(\d+)[^\n]*(?:\n|$)", text)
    if not head:
        first = (text[:200].split(None, 1) or [b""])[0]
        if re.fullmatch(rb"[STCN]*OFF", first):
            raise InputError("has no line with its numbers of vertices and faces")
        raise InputError(f"begins with {shown(first)}; expected 'OFF'")
    vertices, faces = (whole_number(head[k], "the count") for k in (1, 2))
    points, at = _points(text, head.end(), vertices)
    sizes, corners = _corners(text, at, faces)
    blocks, _ = vtk_cells.faces(sizes, corners, {})
    return RawMesh(points, blocks), []


def write(path: Path, surface: SurfaceMesh) -> None:
    """Vertices and triangles, every digit kept."""
    with path.open("w") as file:
        file.write(f"OFF\n{len(surface.points)} {len(surface.triangles)} 0\n")
        file.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in surface.points.tolist())
        file.writelines(f"3 {a} {b} {c}\n" for a, b, c in surface.triangles.tolist())


def _points(text: bytes, at: int, count: int) -> tuple[Floats, int]:
    """The vertices, a line for each from a place on, and the place behind them."""
    values, widths, end = next_rows(text, np.float64, at, count)
    _check("vertex", count, np.full(len(widths), 3), widths)
    return columns_of_rows(values, widths, 0, 3).reshape(-1, 3), end


def _corners(text: bytes, at: int, count: int) -> tuple[Ints, Ints]:
    """How many corners each face has, and all corners."""
    try:
        values, widths, _ = next_rows(text, np.int64, at, count)
    except InputError:  # colours may be fractions
        reals, widths, _ = next_rows(text, np.float64, at, count)
        values = np.where(np.abs(reals) < 2.0**31, reals, -1).astype(np.int64)  # what is no corner is no point
    sizes = columns_of_rows(values, widths, 0, 1).reshape(-1)
    if (sizes < 0).any():
        raise InputError(f"face {np.flatnonzero(sizes < 0)[0]} of {count} has no good number of corners")
    _check("face", count, 1 + np.minimum(sizes, len(values)), widths)
    return sizes, lists_of_rows(values, widths, np.ones_like(sizes), sizes)


def _check(kind: str, count: int, needed: Ints, widths: Ints) -> None:
    """Name the first row that has fewer numbers than it needs, or the first that is not there."""
    short = np.flatnonzero(widths < needed)
    if len(short):
        row = short[0]
        raise InputError(f"{kind} {row} of {count} has {widths[row]} numbers; expected {needed[row]}")
    if len(widths) < count:
        least = 3 if kind == "vertex" else 4
        raise InputError(f"ends within {kind} {len(widths)} of {count}; expected {least} numbers for each")
