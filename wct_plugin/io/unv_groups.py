"""The groups of a universal file become tags with names, and sets."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.assembly import NAME
from wct_plugin.io.raw_mesh import RawMesh
from wct_plugin.io.text_lines import decoded, numbers
from wct_plugin.io.unv_cells import Cells

_TAGS = "cell_tags"
#: Kinds of members.
_POINT, _CELL = 7, 8


@dataclass(frozen=True)
class Group:
    """A group: its number and name, and the labels of its points and cells."""

    number: int
    name: str
    points: NDArray[np.int64]
    cells: NDArray[np.int64]


def groups_of(lines: list[bytes], width: int) -> list[Group]:
    """The groups of a dataset: a line of numbers of which the last counts the members, the name, the members."""
    made = []
    at = 0
    while at < len(lines):
        head = numbers(lines[at], np.int64)
        if len(head) < 2 or at + 1 >= len(lines):
            raise InputError("ends within a group")
        count = int(head[-1])
        name = decoded(lines[at + 1].strip()) or f"group {head[0]}"
        end = at + 2 - (-count * width // 8)
        flat = numbers(b" ".join(lines[at + 2 : end]), np.int64)
        if len(flat) != count * width:
            raise InputError(f"group {name!r} has {len(flat) // width} members but announces {count}")
        members = flat.reshape(-1, width)
        points, cells = (members[members[:, 0] == kind, 1] for kind in (_POINT, _CELL))
        made.append(Group(int(head[0]), name, points, cells))
        at = end
    return made


def put_groups(
    raw: RawMesh, cells: list[Cells], groups: list[Group], points: NDArray[np.int64], lost: list[str]
) -> None:
    """Give the mesh sets of points and cells, and as tags the number of the first group that a cell is in.

    Without groups of cells the tags are the numbers of the materials, or of the properties, where there are several.
    """
    tags = [np.zeros(len(block.labels), dtype=np.int64) for block in cells]
    grouped = False
    for group in groups:
        if len(group.points):
            raw.point_sets[group.name] = np.flatnonzero(np.isin(points, group.points))
        inside = [np.flatnonzero(np.isin(block.labels, group.cells)) for block in cells]
        if sum(map(len, inside)) != len(np.unique(group.cells)):
            lost.append(f"members of the group {group.name!r} that are no cells of the file")
        dimensions = {block.dimension for block, rows in zip(cells, inside, strict=True) if len(rows)}
        grouped |= bool(dimensions)
        free = all((column[rows] == 0).all() for column, rows in zip(tags, inside, strict=True))
        for column, rows in zip(tags, inside, strict=True):
            column[rows[column[rows] == 0]] = group.number
        if len(dimensions) == 1 and free:
            raw.field_data[NAME + group.name] = np.array([group.number, dimensions.pop()])
        elif dimensions:
            raw.cell_sets[group.name] = list(inside)
    if not grouped:
        tags = _numbers(cells)
    if any(column.any() for column in tags):
        raw.cell_data[_TAGS] = list(tags)


def _numbers(cells: list[Cells]) -> list[NDArray[np.int64]]:
    """Of material or property the first that differs among cells of one kind; else zeros."""
    for column in (1, 0):
        if any((block.numbers[:, column] != block.numbers[0, column]).any() for block in cells):
            return [block.numbers[:, column] for block in cells]
    return [np.zeros(len(block.labels), dtype=np.int64) for block in cells]
