"""VTK's XML files of unstructured grids and polygons: ``.vtu`` and ``.vtp``."""

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import vtk_cells
from wct_plugin.io.assembly import NAME
from wct_plugin.io.pieces import joined
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import whole_number
from wct_plugin.io.vtk_arrays import VtkXml, parse, values
from wct_plugin.types import Ints

#: The groups of cells of a ``.vtp`` file, in the order of its cell data, which VTK writes as it has it in memory.
_GROUPS = {"Verts": 2, "Lines": 4, "Polys": 7, "Strips": 6}
#: Arrays of a grid's cells beyond types and points: the faces of polyhedra.
_Table = tuple[NDArray[Any], Ints, NDArray[Any]]


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what of it is left out. Raises :class:`InputError` without the file's name."""
    lost: list[str] = []
    return joined(read_pieces(path, lost), lost), lost


def read_pieces(path: Path, lost: list[str]) -> list[RawMesh]:
    """The pieces of a ``.vtu`` file, or of a ``.vtp`` file by its suffix."""
    kind, table = ("PolyData", _polygons) if path.suffix.lower() == ".vtp" else ("UnstructuredGrid", _grid)
    file = parse(path.read_bytes(), kind)
    grid = file.root.find(kind)
    if grid is None or grid.find("Piece") is None:
        raise InputError("has no piece")
    names = {}
    for name, array in _arrays(file, grid.find("FieldData"), "field data", lost).items():
        if name.startswith(NAME):
            names[name] = array
        else:
            lost.append(f"field data {name!r}")
    pieces = [_piece(file, piece, table, lost) for piece in grid.iter("Piece")]
    pieces[0].field_data = names
    return pieces


def _piece(file: VtkXml, piece: ET.Element, table: Callable[[VtkXml, ET.Element], _Table], lost: list[str]) -> RawMesh:
    count = whole_number(piece.get("NumberOfPoints", "0"), "NumberOfPoints")
    element = piece.find("Points/DataArray")
    points = np.empty((0, 3)) if element is None or not count else values(file, element)
    if points.shape != (count, 3):
        raise InputError(f"has points of shape {points.shape} but announces {count} of 3 coordinates")
    types, starts, connectivity = table(file, piece)
    announced = (
        sum(whole_number(number, key) for key, number in piece.attrib.items() if key.startswith("NumberOf")) - count
    )
    if len(types) != announced:
        raise InputError(f"has {len(types)} cells but announces {announced}")
    cell_data = _arrays(file, piece.find("CellData"), "cell data", lost)
    point_data = _arrays(file, piece.find("PointData"), "point data", lost)
    for name, array in point_data.items():
        if len(array) != count:
            raise InputError(f"point data {name!r} has {len(array)} values for {count} points")
    cells, data = vtk_cells.blocks(types, starts, connectivity, cell_data)
    return RawMesh(points, cells, point_data, data)


def _grid(file: VtkXml, piece: ET.Element) -> _Table:
    arrays = _named(file, piece, "Cells", ("types", "offsets", "connectivity"))
    return arrays["types"], np.concatenate([[0], arrays["offsets"]]).astype(np.int64), arrays["connectivity"]


def _polygons(file: VtkXml, piece: ET.Element) -> _Table:
    types: list[NDArray[Any]] = []
    sizes: list[NDArray[Any]] = []
    corners: list[NDArray[Any]] = []
    for group, code in _GROUPS.items():
        if whole_number(piece.get(f"NumberOf{group}", "0"), f"NumberOf{group}"):
            arrays = _named(file, piece, group, ("offsets", "connectivity"))
            sizes.append(np.diff(arrays["offsets"].astype(np.int64), prepend=0))
            types.append(np.full(len(sizes[-1]), code))
            corners.append(arrays["connectivity"])
    if not types:
        return np.empty(0, np.int64), np.zeros(1, np.int64), np.empty(0, np.int64)
    return np.concatenate(types), np.cumsum(np.concatenate([[0], *sizes])), np.concatenate(corners)


def _named(file: VtkXml, piece: ET.Element, group: str, wanted: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    """The arrays of a group that say what its cells are: whole numbers, one for each cell or point of a cell."""
    found = {array.get("Name", ""): array for array in piece.iterfind(f"{group}/DataArray")}
    made = {}
    for name in wanted:
        if name not in found:
            raise InputError(f"has no array {name!r} in {group}")
        made[name] = values(file, found[name])
        if made[name].ndim != 1 or made[name].dtype.kind not in "iu":
            raise InputError(f"has an array {name!r} in {group} that is no list of whole numbers")
    return made


def _arrays(file: VtkXml, group: ET.Element | None, what: str, lost: list[str]) -> dict[str, NDArray[Any]]:
    """The arrays by name; those of text are named in ``lost``."""
    made = {}
    for element in group if group is not None else ():
        name = element.get("Name", "")
        if element.get("type") == "String":
            lost.append(f"{what} {name!r}, which is text")
        elif element.tag == "DataArray":
            made[name] = values(file, element)
    lost[:] = dict.fromkeys(lost)
    return made
