"""I-DEAS universal files ``.unv`` of Salome, gmsh and others: points, cells, and groups of both."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.id_rows import IdRows
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import Number, columns_of_rows, number_rows, whole_numbers
from wct_plugin.io.unv_cells import Cells, cells_of
from wct_plugin.io.unv_groups import Group, groups_of, put_groups

_NODES, _ONE_LINE_NODES, _CELLS, _OLD_CELLS = ("2411", "781"), "15", "2412", ("780", "71")
_GROUPS = {"2467": 4, "2477": 4, "2452": 4, "2435": 4, "2432": 2, "2430": 2, "2429": 2}  #: numbers per member
#: Datasets that say nothing of a mesh: header, units, systems of coordinates.
_NO_MATTER = ("151", "164", "2400", "2420")


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """What the file holds, and what of it is left out. Raises :class:`InputError` without the file's name."""
    lost: list[str] = []
    labels: list[NDArray[np.int64]] = []
    points: list[NDArray[np.float64]] = []
    cells: list[Cells] = []
    groups: list[Group] = []
    for number, content in _datasets(path.read_bytes()):
        if not content:
            continue
        if number in _NODES or number == _ONE_LINE_NODES:
            some, places = _nodes(content, lines_each=1 if number == _ONE_LINE_NODES else 2)
            labels.append(some)
            points.append(places)
        elif number == _CELLS or number in _OLD_CELLS:
            cells += cells_of(content, lost, old=number != _CELLS)
        elif number in _GROUPS:
            groups += groups_of(content, _GROUPS[number])
        elif number not in _NO_MATTER:
            lost.append(f"dataset {number}")
    if not points or not cells:
        raise InputError("has no points or no cells in the datasets 15, 781, 2411, 780 and 2412")
    numbers = np.concatenate(labels)
    rows = IdRows(numbers, "point")
    raw = RawMesh(np.concatenate(points), [block.raw(rows) for block in cells])
    put_groups(raw, cells, groups, numbers, lost)
    return raw, list(dict.fromkeys(lost))


def _datasets(data: bytes) -> list[tuple[str, list[bytes]]]:
    """Number and lines of each part between two lines of -1."""
    marks = [(found.start(), found.end()) for found in re.finditer(rb"^[ \t]*-1[ \t]*\r?$", data, re.MULTILINE)]
    if not marks or len(marks) % 2:
        raise InputError("ends within a dataset" if marks else "has no datasets between lines of -1")
    parts = []
    for (_, start), (end, _) in zip(marks[::2], marks[1::2], strict=True):
        lines = data[start:end].strip(b"\r\n").splitlines()
        parts.append((lines[0].decode("ascii", "replace").split()[0] if lines and lines[0].split() else "", lines[1:]))
    return parts


def _nodes(lines: list[bytes], *, lines_each: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Labels and coordinates."""
    if lines_each == 1:
        table = _columns(lines, np.float64, 7)
        return whole_numbers(table[:, 0]), table[:, 4:]
    if len(lines) % 2:
        raise InputError("ends within a point")
    return _columns(lines[::2], np.int64, 1)[:, 0], _columns(lines[1::2], np.float64, 3)


def _columns(lines: list[bytes], kind: type[Number], width: int) -> NDArray[Number]:
    """(k, width) the numbers that the lines begin with."""
    values, widths = number_rows(b"\n".join(lines), kind)
    if len(widths) != len(lines) or (widths < width).any():
        raise InputError(f"has a point with fewer than {width} number{'s' * (width > 1)} in a line")
    return columns_of_rows(values, widths, 0, width).reshape(-1, width)
