"""VTK's older files ``.vtk``, text or binary, of unstructured grids and polygons."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import vtk_cells
from wct_plugin.io.pieces import without_ghosts
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.record_runs import runs
from wct_plugin.io.text_lines import whole_number
from wct_plugin.io.vtk_legacy_text import Source

#: The groups of cells of polygonal data, in the order of its cell data, with VTK's type.
_GROUPS = {"VERTICES": 2, "LINES": 4, "POLYGONS": 7, "TRIANGLE_STRIPS": 6}
#: Attributes of one array, and how many columns each has.
_COLUMNS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1}
_Cells = tuple[NDArray[np.int64], NDArray[Any]]


class _Reader:
    """A file on the way: what was found so far."""

    def __init__(self, data: bytes) -> None:
        self.source = Source(data)
        self.points: NDArray[Any] | None = None
        self.cells: dict[str, _Cells] = {}
        self.types: NDArray[Any] | None = None
        self.point_data: dict[str, NDArray[Any]] = {}
        self.cell_data: dict[str, NDArray[Any]] = {}
        self.lost: list[str] = []
        self.what, self.count = "field data", 0

    def section(self, words: list[str]) -> None:
        match [words[0].upper(), *words[1:]]:
            case ["DATASET", kind]:
                if kind.upper() not in ("UNSTRUCTURED_GRID", "POLYDATA"):
                    raise InputError(f"holds {kind}; allowed are UNSTRUCTURED_GRID and POLYDATA")
            case ["POINTS", count, kind]:
                self.points = self.source.numbers(3 * _count(count), kind).reshape(-1, 3)
            case ["CELLS" | "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" as group, count, size]:
                self.cells[group] = self._cells(_count(count), _count(size))
            case ["CELL_TYPES", count]:
                self.types = self.source.numbers(_count(count), "int")
            case ["POINT_DATA" | "CELL_DATA" as what, count]:
                self.what, self.count = what.lower().replace("_", " "), _count(count)
            case ["METADATA"]:
                self.source.skip_metadata()
            case ["FIELD", _, count]:
                for _ in range(_count(count)):
                    self._field()
            case _:
                self._attribute(words)

    def _cells(self, count: int, size: int) -> _Cells:
        """Starts and points: as two arrays from version 5 on, before as one with the number of points before each."""
        if self.source.version >= 5:
            starts, points = (
                self.source.numbers(length, self.source.expect(name)[1])
                for name, length in (("OFFSETS", count), ("CONNECTIVITY", size))
            )
            return starts.astype(np.int64), points
        flat = self.source.numbers(size, "int")
        tables = [table for _, table in runs(flat, 1, lambda rest: (int(rest[0]) + 1, [0]))]
        sizes = np.concatenate(
            [np.empty(0, np.int64), *(np.repeat(table.shape[1] - 1, len(table)) for table in tables)]
        )
        if len(sizes) != count:
            raise InputError(f"has {len(sizes)} cells but announces {count}")
        points = np.concatenate([flat[:0], *(table[:, 1:].ravel() for table in tables)])
        return np.concatenate([[0], np.cumsum(sizes)]), points

    def _field(self) -> None:
        words = self.source.line()
        while words[:1] == ["METADATA"]:
            self.source.skip_metadata()
            words = self.source.line()
        if len(words) != 4:
            raise InputError(f"has the line {' '.join(words)[:60]!r} where an array of a field is expected")
        name, width, length, kind = words
        if kind.lower() in ("string", "variant"):
            self.source.skip_text(_count(width) * _count(length), kind)
            self.lost.append(f"{self.what} {name!r}, which is text")
        else:
            self._keep(name, kind, _count(width), _count(length))

    def _attribute(self, words: list[str]) -> None:
        colours = "float" if self.source.text else "unsigned_char"
        match [words[0].upper(), *words[1:]]:
            case ["SCALARS", name, kind, *width]:
                self.source.expect("LOOKUP_TABLE")
                self._keep(name, kind, _count(width[0]) if width else 1, self.count)
            case ["TEXTURE_COORDINATES", name, width, kind]:
                self._keep(name, kind, _count(width), self.count)
            case ["COLOR_SCALARS", name, width]:
                self._keep(name, colours, _count(width), self.count)
            case ["LOOKUP_TABLE", _, size]:  # colours, of no meaning to a mesh
                self.source.numbers(4 * _count(size), colours)
            case [kind, name, of] if kind in _COLUMNS:
                self._keep(name, of, _COLUMNS[kind], self.count)
            case _:
                raise InputError(f"has the line {' '.join(words)[:60]!r}, which means nothing in a VTK file")

    def _keep(self, name: str, kind: str, width: int, rows: int) -> None:
        """Read an array, and keep it where it is of points or cells."""
        values = self.source.numbers(width * rows, kind)
        if self.what == "field data":
            self.lost.append(f"field data {name!r}")
            return
        data = self.point_data if self.what == "point data" else self.cell_data
        data[name] = values.reshape(rows, width) if width != 1 else values


def _count(word: str) -> int:
    count = whole_number(word, "the count")
    if count < 0:
        raise InputError(f"has the count {count}; allowed are 0 and more")
    return count


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what of it is left out. Raises :class:`InputError` without the file's name."""
    reader = _Reader(path.read_bytes())
    while words := reader.source.line():
        reader.section(words)
    if reader.points is None:
        raise InputError("has no points")
    for name, values in reader.point_data.items():
        if len(values) != len(reader.points):
            raise InputError(f"point data {name!r} has {len(values)} values for {len(reader.points)} points")
    types, starts, corners = _table(reader)
    blocks, cell_data = vtk_cells.blocks(types, starts, corners, reader.cell_data)
    raw = RawMesh(reader.points, blocks, reader.point_data, cell_data)
    return without_ghosts(raw), list(dict.fromkeys(reader.lost))


def _table(reader: _Reader) -> tuple[NDArray[Any], NDArray[np.int64], NDArray[Any]]:
    if "CELLS" in reader.cells:
        if reader.types is None:
            raise InputError("has no CELL_TYPES")
        return reader.types, *reader.cells["CELLS"]
    groups = [(code, *reader.cells[name]) for name, code in _GROUPS.items() if name in reader.cells]
    if not groups:
        raise InputError("has no cells")
    types = np.concatenate([np.full(len(starts) - 1, code) for code, starts, _ in groups])
    sizes = np.concatenate([np.diff(starts) for _, starts, _ in groups])
    return types, np.concatenate([[0], np.cumsum(sizes)]), np.concatenate([points for _, _, points in groups])
