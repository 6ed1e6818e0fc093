"""VTK's cells, a type, a start and points for each, as blocks of one kind."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit
from wct_plugin.io.raw_mesh import RawBlock
from wct_plugin.mesh import cell_kinds
from wct_plugin.types import Ints

#: Types of a fixed number of points: meshio's name, the number, and meshio's order of them where it differs.
_FIXED: dict[int, tuple[str, int, tuple[int, ...]]] = {
    1: ("vertex", 1, ()),
    3: ("line", 2, ()),
    5: ("triangle", 3, ()),
    8: ("quad", 4, (0, 1, 3, 2)),  # pixel
    9: ("quad", 4, ()),
    10: ("tetra", 4, ()),
    11: ("hexahedron", 8, (0, 1, 3, 2, 4, 5, 7, 6)),  # voxel
    12: ("hexahedron", 8, ()),
    13: ("wedge", 6, (0, 2, 1, 3, 5, 4)),
    14: ("pyramid", 5, ()),
    15: ("penta_prism", 10, ()),
    16: ("hexa_prism", 12, ()),
    21: ("line3", 3, ()),
    22: ("triangle6", 6, ()),
    23: ("quad8", 8, ()),
    24: ("tetra10", 10, ()),
    25: ("hexahedron20", 20, ()),
    26: ("wedge15", 15, ()),
    27: ("pyramid13", 13, ()),
    28: ("quad9", 9, ()),
    29: ("hexahedron27", 27, ()),
    30: ("quad6", 6, ()),
    31: ("wedge12", 12, ()),
    32: ("wedge18", 18, ()),
    33: ("hexahedron24", 24, ()),
    34: ("triangle7", 7, ()),
    35: ("line4", 4, ()),
}
#: Types of any number of points.
_POLYVERTEX, _POLYLINE, _STRIP, _POLYGON, _POLYHEDRON = 2, 4, 6, 7, 42
_OTHER = {_POLYHEDRON: "polyhedron"} | {
    first + k: f"VTK_{family}_{shape}"
    for first, family in ((68, "LAGRANGE"), (75, "BEZIER"))
    for k, shape in enumerate(("CURVE", "TRIANGLE", "QUADRILATERAL", "TETRAHEDRON", "HEXAHEDRON", "WEDGE", "PYRAMID"))
}


def blocks(
    types: NDArray[Any], starts: Ints, connectivity: NDArray[Any], cell_data: Mapping[str, NDArray[Any]]
) -> tuple[list[RawBlock], dict[str, list[NDArray[Any] | None]]]:
    """Cells as blocks, with their data. ``starts`` has one entry more than there are cells.

    Polylines, polyvertices and strips come as lines, vertices and triangles, each with the data of its cell.
    """
    _check(types, starts, connectivity, cell_data)
    made: list[RawBlock] = []
    data: dict[str, list[NDArray[Any] | None]] = {name: [] for name in cell_data}
    for kind, cells, owner in _pieces(types, starts, connectivity):
        made.append(RawBlock(kind, cells.astype(np.int64)))
        more = int((owner[1:] == owner[:-1]).sum())  # those of one cell follow each other
        for name, values in cell_data.items():
            read_limit.claim(more * (values.nbytes // max(len(values), 1)), f"cell data {name!r} of parts of cells")
            data[name].append(values[owner])
    return made, data


def faces(
    sizes: Ints, corners: NDArray[Any], cell_data: Mapping[str, NDArray[Any]]
) -> tuple[list[RawBlock], dict[str, list[NDArray[Any] | None]]]:
    """Faces of any numbers of corners, one after the other, as blocks of triangles, quads and polygons."""
    small = np.flatnonzero(np.asarray(sizes) < 3)
    if len(small):
        raise InputError(f"face {small[0]} has {sizes[small[0]]} corners; allowed are 3 and more")
    starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    return blocks(np.full(len(sizes), _POLYGON), starts, corners, cell_data)


def _check(
    types: NDArray[Any], starts: Ints, connectivity: NDArray[Any], cell_data: Mapping[str, NDArray[Any]]
) -> None:
    if len(starts) != len(types) + 1:
        raise InputError(f"has {len(types)} types of cells but {len(starts) - 1} cells")
    if starts[0] != 0 or starts[-1] != len(connectivity) or (np.diff(starts) < 0).any():
        raise InputError(f"its cells end at {starts[-1]} of {len(connectivity)} points of cells, or overlap")
    for name, values in cell_data.items():
        if len(values) != len(types):
            raise InputError(f"cell data {name!r} has {len(values)} values for {len(types)} cells")


def _pieces(
    types: NDArray[Any], starts: Ints, connectivity: NDArray[Any]
) -> Iterator[tuple[str, NDArray[Any], NDArray[np.int64]]]:
    """By type and number of points: the kind, the cells and which cell of the file each is of."""
    sizes = np.diff(starts)
    for code in dict.fromkeys(types.tolist()):
        of_type = np.flatnonzero(types == code)
        for size in np.unique(sizes[of_type]).tolist():
            rows = of_type[sizes[of_type] == size]
            if len(rows) == len(types):  # all cells are of one kind
                cells = connectivity.reshape(-1, size)
            else:
                cells = connectivity[starts[:-1][rows][:, None] + np.arange(size)]
            yield from _as_kind(int(code), size, cells, rows)


def _as_kind(
    code: int, size: int, cells: NDArray[Any], rows: NDArray[np.int64]
) -> Iterator[tuple[str, NDArray[Any], NDArray[np.int64]]]:
    if code in _FIXED:
        kind, wanted, order = _FIXED[code]
        if size != wanted:
            raise InputError(f"cell {rows[0]} is a {kind} of {size} points; allowed are {wanted}")
        yield kind, cells[:, order] if order else cells, rows
    elif code == _POLYVERTEX:
        yield "vertex", cells.reshape(-1, 1), np.repeat(rows, size)
    elif code == _POLYLINE and size >= 2:
        yield "line", np.stack([cells[:, :-1], cells[:, 1:]], axis=2).reshape(-1, 2), np.repeat(rows, size - 1)
    elif code == _STRIP and size >= 3:
        corners = np.arange(size - 2)[:, None] + np.array([[0, 1, 2], [1, 0, 2]])[np.arange(size - 2) % 2]
        yield "triangle", cells[:, corners].reshape(-1, 3), np.repeat(rows, size - 2)
    elif code == _POLYGON and size >= 3:
        yield {3: "triangle", 4: "quad"}.get(size, "polygon"), cells, rows
    elif code in _OTHER and size >= _least(_OTHER[code]):
        yield _OTHER[code], cells, rows
    elif code != 0:  # VTK's empty cell is none
        raise InputError(
            f"cell {rows[0]} is of VTK's type {code} and has {size} points; allowed are known types with enough points"
        )


def _least(kind: str) -> int:
    """How many points a cell of any number of points has at least."""
    return cell_kinds.corners(kind) if cell_kinds.dimension(kind) >= 0 else 1
