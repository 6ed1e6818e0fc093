"""gmsh's files of version 4.1, for cells that are in several physical groups.

Version 2.2 has one group per cell, and would repeat the cell for each further one. In version 4.1 a cell belongs to an
entity, and an entity to any number of groups: an entity is made for each combination there is. meshio's own writer
makes files that neither gmsh nor meshio reads.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io.gmsh_sections import KINDS, OWN, end, put, put_data, put_format, put_names
from wct_plugin.io.periodic_sides import PeriodicSides, put_periodic
from wct_plugin.types import Ints


@dataclass
class _Entity:
    dimension: int
    type: int  #: gmsh's number of the kind of cell
    number: int
    groups: list[int]
    members: Ints  #: which of the cells of this kind
    cells: Ints


def write(
    path: Path,
    points: NDArray[np.float64],
    cells: list[tuple[str, Ints]],
    groups: Mapping[str, Mapping[int, Ints]],
    names: Mapping[str, Any],
    point_data: Mapping[str, NDArray[Any]],
    cell_data: Mapping[str, list[NDArray[Any]]],
    periodic: list[PeriodicSides],
    *,
    binary: bool,
) -> None:
    """Write the file; cells come sorted by entity, and their data with them.

    ``cells``: each kind once, with its cells (k, d); ``groups``: by kind, the cells of each further group by its tag;
    ``cell_data``: an array per kind, with ``gmsh:physical``, the first group of each cell, and ``gmsh:geometrical``.
    """
    tags = zip(cells, *(cell_data[name] for name in OWN), strict=True)
    entities = [_entities(kind, rows, first, ids, groups.get(kind, {})) for (kind, rows), first, ids in tags]
    every = [one for parts in entities for one in parts]
    with path.open("wb") as file:
        put_format(file, binary, "4.1")
        put_names(file, names)
        _write_entities(file, binary, points, every)
        _write_nodes(file, binary, points, max(every, key=lambda one: one.dimension))
        _write_elements(file, binary, every)
        facets = [one for one in every if one.dimension == 2]
        put_periodic(
            file, binary, "4.1", periodic, lambda row: next(one.number for one in facets if row in one.members)
        )
        for name, values in point_data.items():
            put_data(file, binary, "NodeData", name, values)
        for name, columns in cell_data.items():
            if name not in OWN:
                rows = [column[one.members] for column, parts in zip(columns, entities, strict=True) for one in parts]
                put_data(file, binary, "ElementData", name, np.concatenate(rows))


def _entities(kind: str, cells: Ints, first: Ints, ids: Ints, groups: Mapping[int, Ints]) -> list[_Entity]:
    """One entity for each combination of entity and groups; their numbers stay where they suffice."""
    further = np.zeros((len(cells), len(groups)), dtype=np.int64)
    for column, (tag, members) in enumerate(groups.items()):
        further[members, column] = tag
    rows, place = np.unique(np.column_stack([ids, first, further]), axis=0, return_inverse=True)
    enough = len(np.unique(rows[:, 0])) == len(rows)
    found = []
    for k, row in enumerate(rows.tolist()):
        members = np.flatnonzero(place.ravel() == k)
        belongs = list(dict.fromkeys(tag for tag in row[1:] if tag))
        found.append(_Entity(*KINDS[kind], row[0] if enough else k + 1, belongs, members, cells[members]))
    return found


def _write_entities(file: BinaryIO, binary: bool, points: NDArray[np.float64], entities: list[_Entity]) -> None:
    file.write(b"$Entities\n")
    put(file, binary, _row([sum(one.dimension == dimension for one in entities) for dimension in range(4)], np.uint64))
    for one in sorted(entities, key=lambda one: one.dimension):
        corners = points[one.cells].reshape(-1, 3)
        box = np.array([corners.min(axis=0), corners.max(axis=0)]) if one.dimension else corners[:1]
        count, groups = _row([len(one.groups)], np.uint64), _row(one.groups, np.int32)
        # Last comes how many entities it is bounded by: none are known.
        bounds = [_row([0], np.uint64)] if one.dimension else []
        put(file, binary, _row([one.number], np.int32), box.reshape(1, -1), count, groups, *bounds)
    end(file, binary, "Entities")


def _write_nodes(file: BinaryIO, binary: bool, points: NDArray[np.float64], entity: _Entity) -> None:
    count = len(points)
    file.write(b"$Nodes\n")
    put(file, binary, _row([1, count, 1, count], np.uint64))
    put(file, binary, _row([entity.dimension, entity.number, 0], np.int32), _row([count], np.uint64))
    put(file, binary, np.arange(1, count + 1, dtype=np.uint64))
    put(file, binary, points)
    end(file, binary, "Nodes")


def _write_elements(file: BinaryIO, binary: bool, entities: list[_Entity]) -> None:
    count = sum(len(one.cells) for one in entities)
    file.write(b"$Elements\n")
    put(file, binary, _row([len(entities), count, 1, count], np.uint64))
    number = 1
    for one in entities:
        ids = np.arange(number, number + len(one.cells))
        put(file, binary, _row([one.dimension, one.number, one.type], np.int32), _row([len(ids)], np.uint64))
        put(file, binary, np.column_stack([ids, one.cells + 1]).astype(np.uint64))
        number += len(ids)
    end(file, binary, "Elements")


def _row(values: list[int], kind: type[np.int32] | type[np.uint64]) -> NDArray[Any]:
    return np.array([values], dtype=kind)
