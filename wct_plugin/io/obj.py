"""Wavefront OBJ, geometry only, read here: meshio fails where texture coordinates and vertices differ in number."""

import re
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io import vtk_cells
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import columns_of_rows, number_rows, shown
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.types import Ints

#: Blanks are what they are to who reads the numbers: all characters up to the space.
_BLANKS = bytes(byte if byte > 32 or byte in b"\r\n" else 32 for byte in range(256))


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """Vertices and faces; normals, texture coordinates and materials are of no use to a mesher.

    Raises :class:`InputError`, without the file's name, for a malformed line.
    """
    text = path.read_bytes().translate(_BLANKS)
    if b"#" in text:
        text = re.sub(rb"#[^\r\n]*", b"", text)
    text = text.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ") if b"\\" in text else text
    if b"\n" not in text:
        text = text.replace(b"\r", b"\n")
    try:
        points, widths = number_rows(text, np.float64, b"v")
        corners, sizes = number_rows(text, np.int64, b"f", b"/")  # texture coordinates and normals are behind slashes
    except InputError:
        _refuse_line(text)
        raise
    if (widths < 3).any() or (sizes < 1).any() or (corners == 0).any():
        _refuse_line(text)
    if (corners < 0).any():  # these count back from the last vertex so far
        corners = np.where(corners > 0, corners, np.repeat(_before(text), sizes) + corners + 1)
    places = columns_of_rows(points, widths, 0, 3).reshape(-1, 3)  # colours may follow
    blocks, _ = vtk_cells.faces(sizes, corners - 1, {})
    return RawMesh(places, blocks), []


def _before(text: bytes) -> Ints:
    """How many vertices there are before each face."""
    heads = [line.split(None, 1)[:1] for line in text.lower().split(b"\n")]
    vertices = np.cumsum([head == [b"v"] for head in heads])
    return vertices[[head == [b"f"] for head in heads]]


def _refuse_line(text: bytes) -> None:
    """Name the first line that is wrong."""
    for number, line in enumerate(text.split(b"\n"), start=1):
        letter, *words = line.split() or [b""]
        try:
            if letter in (b"v", b"V"):
                good = len([float(word) for word in words]) >= 3
            elif letter in (b"f", b"F"):
                good = bool(words) and 0 not in [int(word.split(b"/")[0]) for word in words]
            else:
                good = True
        except ValueError:
            good = False
        if not good:
            raise InputError(f"line {number} is {shown(line.strip(), 60)}; expected 'v x y z' or 'f a b c'")


def write(path: Path, surface: SurfaceMesh) -> None:
    """Vertices and triangles, every digit kept."""
    with path.open("w") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in surface.points.tolist())
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in (surface.triangles + 1).tolist())
