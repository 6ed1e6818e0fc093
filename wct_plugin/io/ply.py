"""PLY surfaces, read and written here: meshio misreads faces that carry more than their vertices.

MeshLab stores its quality per face after the vertex list, where meshio's reader loses its place.
"""

import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import vtk_cells
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import decoded, lists_of_rows, next_rows, shown, whole_number, whole_numbers
from wct_plugin.mesh import SurfaceMesh
from wct_plugin.types import Ints

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8", "int64": "i8", "uint64": "u8",
}  # fmt: skip
_NAMES = {
    "i1": "char",
    "u1": "uchar",
    "i2": "short",
    "u2": "ushort",
    "i4": "int",
    "u4": "uint",
    "f4": "float",
    "f8": "double",
}
_CORNERS = ("vertex_indices", "vertex_index")


@dataclass(frozen=True)
class _Property:
    name: str
    type: str
    count: str = ""  #: type of the length where the property is a list


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: list[_Property]


@dataclass(frozen=True, eq=False)
class _Lists:
    """A list for each row: how many values each has, and all values one after the other."""

    sizes: Ints
    values: NDArray[Any]

    @classmethod
    def of(cls, rows: Sequence[NDArray[Any]], kind: str) -> "_Lists":
        sizes = np.array([len(row) for row in rows], dtype=np.int64)
        return cls(sizes, np.concatenate([*rows, np.empty(0, dtype=kind)]))

    @classmethod
    def of_table(cls, table: NDArray[Any]) -> "_Lists":
        return cls(np.full(len(table), table.shape[1]), np.ascontiguousarray(table).ravel())


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """The surface, and what of the file it cannot hold. Raises :class:`InputError` without the file's name."""
    with path.open("rb") as file:
        layout, elements = _header(file)
        columns = {}
        text, at = file.read() if layout == "" else b"", 0
        for element in elements:  # all that come before the last wanted one must be walked through
            if layout == "":
                columns[element.name], at = _text(text, at, element)
            else:
                columns[element.name] = _binary(file, element, layout)
    for needed in ("vertex", "face"):
        if needed not in columns:
            raise InputError(f"has no element {needed!r}; a surface needs vertices and faces")
    vertex, face = columns["vertex"], columns["face"]
    if not {"x", "y", "z"} <= vertex.keys():
        raise InputError("its vertices lack x, y or z")
    corners = next((face.pop(name) for name in _CORNERS if name in face), None)
    if not isinstance(corners, _Lists):
        raise InputError(f"its faces have no list {_CORNERS[0]!r}")
    lost = [f"face lists {name!r}" for name, values in face.items() if isinstance(values, _Lists)]
    lost += [f"vertex lists {name!r}" for name, values in vertex.items() if isinstance(values, _Lists)]
    lost += [f"elements {element.name!r}" for element in elements if element.name not in ("vertex", "face")]
    points = np.column_stack([vertex.pop(axis) for axis in "xyz"])
    point_data = {name: values for name, values in vertex.items() if not isinstance(values, _Lists)}
    cell_data = {name: values for name, values in face.items() if not isinstance(values, _Lists)}
    blocks, blocks_data = vtk_cells.faces(corners.sizes, corners.values.astype(np.int64), cell_data)
    return RawMesh(points, blocks, point_data, blocks_data), lost


def write(
    path: Path, surface: SurfaceMesh, cell_data: dict[str, NDArray[Any]], point_data: dict[str, NDArray[Any]]
) -> None:
    """Binary, coordinates as doubles; the arrays have one value per face or point and names without blanks."""
    columns = {axis: surface.points[:, k] for k, axis in enumerate("xyz")}
    columns |= {name: _storable(values) for name, values in point_data.items()}
    corners = {f"corner{k}": surface.triangles[:, k].astype("i4") for k in range(3)}
    extra = {name: _storable(values) for name, values in cell_data.items()}
    vertex = _table(columns)
    face = _table({"count": np.full(len(surface.triangles), 3, dtype="u1")} | corners | extra)
    lines = ["ply", f"format binary_{sys.byteorder}_endian 1.0", f"element vertex {len(vertex)}"]
    lines += [f"property {_NAMES[values.dtype.str[1:]]} {name}" for name, values in columns.items()]
    lines += [f"element face {len(face)}", "property list uchar int vertex_indices"]
    lines += [f"property {_NAMES[values.dtype.str[1:]]} {name}" for name, values in extra.items()]
    with path.open("wb") as file:
        file.write(("\n".join(lines) + "\nend_header\n").encode())
        file.write(vertex.tobytes())
        file.write(face.tobytes())


def _header(file: IO[bytes]) -> tuple[str, list[_Element]]:
    """Byte order ('' for text) and the elements in the order of the file."""
    if file.readline().strip() != b"ply":
        raise InputError("does not begin with 'ply'")
    layouts = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
    layout = None
    elements: list[_Element] = []
    while True:
        line = file.readline()
        if not line:
            raise InputError("ends within its header")
        match decoded(line).split():
            case ["end_header"]:
                break
            case ["format", name, "1.0"] if name in layouts:
                layout = layouts[name]
            case ["element", name, count]:
                elements.append(_Element(name, whole_number(count, f"the count of {name!r}"), []))
            case ["property", "list", count, kind, name] if elements and {count, kind} <= _TYPES.keys():
                elements[-1].properties.append(_Property(name, _TYPES[kind], _TYPES[count]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[kind]))
            case ["comment" | "obj_info", *_] | []:
                pass
            case _:
                raise InputError(f"has the header line {shown(line.strip(), 60)}, which means nothing in PLY")
    if layout is None:
        raise InputError("its header names no format; allowed are ascii and binary")
    for element in elements:
        if not element.properties or element.count < 0:
            raise InputError(
                f"element {element.name!r} has {len(element.properties)} properties, count {element.count}"
            )
        names = [prop.name for prop in element.properties]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise InputError(f"element {element.name!r} has the property {twice!r} more than once")
    return layout, elements


def _binary(file: IO[bytes], element: _Element, order: str) -> dict[str, Any]:
    here = file.tell()
    lengths = _first_lengths(file, element, order)
    file.seek(here)
    row = _row_type(element, order, lengths)
    data = _read(file, row.itemsize * element.count)
    table = np.frombuffer(data[: len(data) // row.itemsize * row.itemsize], dtype=row)
    if len(table) == element.count and all((table[f"#{name}"] == size).all() for name, size in lengths.items()):
        return {prop.name: _Lists.of_table(table[prop.name]) if prop.count else table[prop.name]
                for prop in element.properties}  # fmt: skip
    file.seek(here)  # lists of different lengths, or the file is too short: row by row tells which
    return _gather(element, _binary_rows(file, element, order))


def _first_lengths(file: IO[bytes], element: _Element, order: str) -> dict[str, int]:
    if not element.count:
        return {prop.name: 0 for prop in element.properties if prop.count}
    first = next(_binary_rows(file, element, order))
    return {prop.name: len(value) for prop, value in zip(element.properties, first, strict=True) if prop.count}


def _row_type(element: _Element, order: str, lengths: dict[str, int]) -> np.dtype[Any]:
    fields: list[Any] = []
    for prop in element.properties:
        if prop.count:
            fields += [(f"#{prop.name}", order + prop.count), (prop.name, order + prop.type, (lengths[prop.name],))]
        else:
            fields.append((prop.name, order + prop.type))
    return np.dtype(fields)


def _binary_rows(file: IO[bytes], element: _Element, order: str) -> Iterator[list[Any]]:
    for number in range(element.count):
        row = []
        for prop in element.properties:
            size = int(_take(file, order + prop.count, 1, element, number)[0]) if prop.count else 1
            values = _take(file, order + prop.type, size, element, number)
            row.append(values if prop.count else values[0])
        yield row


def _take(file: IO[bytes], kind: str, size: int, element: _Element, number: int) -> NDArray[Any]:
    wanted = np.dtype(kind).itemsize * size
    data = _read(file, wanted)
    if len(data) != wanted:
        raise InputError(f"ends within {element.name} {number} of {element.count}")
    return np.frombuffer(data, dtype=kind)


def _read(file: IO[bytes], size: int) -> bytes:
    """So many bytes, or all that are left; none where a damaged file asks for fewer."""
    left = os.fstat(file.fileno()).st_size - file.tell()
    return file.read(max(min(size, left), 0))


def _text(text: bytes, at: int, element: _Element) -> tuple[dict[str, Any], int]:
    """The columns of an element, a line for each from a place on, and the place behind them."""
    real = any(prop.type[0] == "f" for prop in element.properties)
    values: NDArray[Any]
    kind: Any = np.float64 if real else np.int64
    values, widths, end = next_rows(text, kind, at, element.count)
    if len(widths) < element.count:
        raise InputError(f"ends within {element.name} {len(widths)} of {element.count}")
    starts = np.cumsum(widths) - widths
    place = np.zeros(element.count, dtype=np.int64)  # of the next property, within each row
    columns: dict[str, Any] = {}
    for prop in element.properties:
        _check_rows(element, place + 1, widths)
        found = values[starts + place]
        place += 1
        if not prop.count:
            columns[prop.name] = found.astype(prop.type)
            continue
        sizes = whole_numbers(found)
        _check_rows(element, place + np.minimum(sizes, len(values)), widths, sizes)
        columns[prop.name] = _Lists(sizes, lists_of_rows(values, widths, place, sizes).astype(prop.type))
        place += sizes
    return columns, end


def _check_rows(element: _Element, needed: Ints, widths: Ints, sizes: Ints | None = None) -> None:
    bad = np.flatnonzero((needed > widths) | (False if sizes is None else sizes < 0))
    if len(bad):
        raise InputError(f"ends within {element.name} {bad[0]} of {element.count}")


def _gather(element: _Element, rows: Iterator[list[Any]]) -> dict[str, Any]:
    columns = list(zip(*rows, strict=True)) or [()] * len(element.properties)
    return {
        prop.name: _Lists.of(column, prop.type) if prop.count else np.array(column, dtype=prop.type)
        for prop, column in zip(element.properties, columns, strict=True)
    }


def _storable(values: NDArray[Any]) -> NDArray[Any]:
    """The array in a type PLY has: no 64-bit integers, no truth values."""
    if values.dtype.kind == "b":
        return values.astype("u1")
    if values.dtype.kind in "iu" and values.dtype.itemsize == 8:
        fits = not len(values) or (values.min() >= -(2**31) and values.max() < 2**31)
        return values.astype("i4" if fits else "f8")
    return values


def _table(columns: dict[str, NDArray[Any]]) -> NDArray[Any]:
    count = len(next(iter(columns.values())))
    table = np.empty(count, dtype=[(name, values.dtype) for name, values in columns.items()])
    for name, values in columns.items():
        table[name] = values
    return table
