"""VTU files of polyhedra, which ParaView and VTK read; one piece, arrays as base64 of little-endian numbers."""

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from wct_plugin.duals.dual_mesh import DualMesh
from wct_plugin.io.meshio_writers import attribute
from wct_plugin.types import Ints

_POLYHEDRON = 42  #: VTK's number of the kind of cell
_TYPES = {"i1": "Int8", "u1": "UInt8", "i2": "Int16", "u2": "UInt16", "i4": "Int32", "u4": "UInt32", "i8": "Int64",
          "u8": "UInt64", "f4": "Float32", "f8": "Float64"}  # fmt: skip


def write(path: Path, dual: DualMesh, cell_data: Mapping[str, NDArray[Any]]) -> None:
    """Write the cells with an array per name; the arrays are numbers, of one or two dimensions."""
    count = len(dual.vertex)
    faces, ends = _face_stream(dual)
    points, point_ends = _points_of_cells(dual)
    with path.open("w", encoding="ascii") as file:
        file.write('<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" ')
        file.write(f'header_type="UInt64">\n<UnstructuredGrid>\n<Piece NumberOfPoints="{len(dual.points)}" ')
        file.write(f'NumberOfCells="{count}">\n<Points>\n')
        _put(file, "Points", dual.points)
        file.write("</Points>\n<Cells>\n")
        _put(file, "connectivity", points)
        _put(file, "offsets", point_ends)
        _put(file, "types", np.full(count, _POLYHEDRON, dtype=np.uint8))
        _put(file, "faces", faces)
        _put(file, "faceoffsets", ends)
        file.write("</Cells>\n<CellData>\n")
        for name, values in cell_data.items():
            _put(file, name, values)
        file.write("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


def storable(values: NDArray[Any]) -> bool:
    """Whether an array can be written."""
    kind = values.dtype.newbyteorder("<").str[1:]
    return (kind in _TYPES or values.dtype.kind == "b") and values.ndim in (1, 2) and values.size > 0


def _sides(dual: DualMesh) -> tuple[Ints, Ints]:
    """Cell and face of each side of a face, cell by cell."""
    cells = np.concatenate([dual.owner, dual.neighbour])
    faces = np.concatenate([np.arange(len(dual.owner)), np.arange(len(dual.neighbour))])
    order = np.argsort(cells, kind="stable")
    return cells[order], faces[order]


def _face_stream(dual: DualMesh) -> tuple[Ints, Ints]:
    """VTK's: per cell the number of its faces, and of each the number of its points and these; and where cells end.

    The points run counter-clockwise seen from outside the cell.
    """
    cells, faces = _sides(dual)
    sizes = np.diff(dual.starts)[faces]
    lengths = np.bincount(cells, sizes + 1).astype(np.int64) + 1
    ends = np.cumsum(lengths)
    stream = np.empty(int(ends[-1]), dtype=np.int64)
    stream[ends - lengths] = np.bincount(cells)
    begin = np.cumsum(sizes + 1) - (sizes + 1) + cells + 1
    stream[begin] = sizes
    inside = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    backward = np.repeat(dual.owner[faces] != cells, sizes)  # the faces run so seen from their owner
    ahead = np.where(backward, np.repeat(sizes, sizes) - 1 - inside, inside)
    stream[np.repeat(begin + 1, sizes) + inside] = dual.corners[np.repeat(dual.starts[faces], sizes) + ahead]
    return stream, ends


def _points_of_cells(dual: DualMesh) -> tuple[Ints, Ints]:
    """The points of each cell, each once, and where those of a cell end."""
    cells, faces = _sides(dual)
    sizes = np.diff(dual.starts)[faces]
    inside = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    corners = dual.corners[np.repeat(dual.starts[faces], sizes) + inside]
    pairs = np.unique(np.repeat(cells, sizes) * len(dual.points) + corners)
    owner, points = np.divmod(pairs, len(dual.points))
    return points, np.cumsum(np.bincount(owner, minlength=len(dual.vertex)))


def _put(file: TextIO, name: str, values: NDArray[Any]) -> None:
    table = values.astype(np.uint8) if values.dtype.kind == "b" else values
    table = np.ascontiguousarray(table, dtype=table.dtype.newbyteorder("<"))
    columns = f' NumberOfComponents="{table.shape[1]}"' if table.ndim == 2 else ""
    data = table.tobytes()
    text = base64.b64encode(np.uint64(len(data)).astype("<u8").tobytes() + data).decode("ascii")
    kind = _TYPES[table.dtype.str[1:]]
    file.write(f'<DataArray type="{kind}" Name="{attribute(name)}"{columns} format="binary">\n{text}\n</DataArray>\n')
