"""The cells of an XDMF topology as blocks of one kind."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.record_runs import runs

#: By XDMF's number: VTK's type, the number of points, and the names it goes by.
_TYPES = {
    1: (2, 0, "polyvertex"), 2: (4, 0, "polyline"), 3: (7, 0, "polygon"), 4: (5, 3, "triangle"),
    5: (9, 4, "quadrilateral quad"), 6: (10, 4, "tetrahedron tet"), 7: (14, 5, "pyramid"), 8: (13, 6, "wedge"),
    9: (12, 8, "hexahedron hex"), 16: (42, 0, "polyhedron"), 34: (21, 3, "edge_3"),
    35: (28, 9, "quadrilateral_9 quad_9"), 36: (22, 6, "triangle_6 tri_6"), 37: (23, 8, "quadrilateral_8 quad_8"),
    38: (24, 10, "tetrahedron_10 tet_10"), 39: (27, 13, "pyramid_13"), 40: (26, 15, "wedge_15"),
    41: (32, 18, "wedge_18"), 48: (25, 20, "hexahedron_20 hex_20"), 49: (33, 24, "hexahedron_24 hex_24"),
    50: (29, 27, "hexahedron_27 hex_27"),
}  # fmt: skip
_POLYHEDRON = 16
_MIXED = [code for code in _TYPES if code != _POLYHEDRON]
_BY_NAME = {name: code for code, (_, _, names) in _TYPES.items() for name in names.split()}
#: Unlike VTK's, XDMF's wedges are as all others have them; what is done to VTK's is undone beforehand.
_WEDGE, _UNTURNED = 13, np.array([0, 2, 1, 3, 5, 4])

Table = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]


def table(name: str, values: NDArray[Any], per_cell: int) -> Table:
    """VTK's types, starts and points of the cells of a topology of this type."""
    if name.lower() == "mixed":
        return _mixed(values.ravel().astype(np.int64))
    if name.lower() not in _BY_NAME:
        raise InputError(f"has a topology of type {name!r}; allowed are Mixed, {', '.join(_BY_NAME)}")
    code, wanted, _ = _TYPES[_BY_NAME[name.lower()]]
    width = wanted or per_cell or (values.shape[-1] if values.ndim > 1 else 1)
    if width < 1 or values.size % width:
        raise InputError(f"has a topology of {values.size} numbers, which is not a multiple of {width}")
    cells = values.reshape(-1, width).astype(np.int64)
    return _rows(code, cells)


def _mixed(flat: NDArray[np.int64]) -> Table:
    parts = []
    for _, rows in runs(flat, 2, _layout):
        vtk, wanted, _ = _TYPES[int(rows[0, 0])]
        parts.append(_rows(vtk, rows[:, 1 if wanted else 2 :]))
    if not parts:
        return np.empty(0, np.int64), np.zeros(1, np.int64), np.empty(0, np.int64)
    types, starts, points = zip(*parts, strict=True)
    sizes = np.concatenate([np.diff(part) for part in starts])
    return np.concatenate(types), np.concatenate([[0], np.cumsum(sizes)]), np.concatenate(points)


def _layout(rest: NDArray[np.int64]) -> tuple[int, list[int]]:
    """Of the record that begins here, type, number of points where it is open, points: its length and its head."""
    code = int(rest[0])
    if code not in _TYPES or code == _POLYHEDRON:
        raise InputError(f"has mixed cells of XDMF's type {code}; allowed are {', '.join(map(str, _MIXED))}")
    wanted = _TYPES[code][1]
    if wanted:
        return 1 + wanted, [0]
    if rest[1] < 1:
        raise InputError(f"has a mixed cell of {rest[1]} points")
    return 2 + int(rest[1]), [0, 1]


def _rows(code: int, cells: NDArray[np.int64]) -> Table:
    count, width = cells.shape
    if code == _WEDGE:
        cells = cells[:, _UNTURNED]
    return np.full(count, code), np.arange(count + 1) * width, cells.ravel()
