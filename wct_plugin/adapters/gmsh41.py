"""gmsh's files of version 4.1, binary, for cells that are in several physical groups.

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

Ints = NDArray[np.int64]

#: Dimension and gmsh's number of each kind of cell.
_KINDS = {"vertex": (0, 15), "line": (1, 1), "triangle": (2, 2), "tetra": (3, 4)}


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
) -> None:
    """Write the file; cells come sorted by entity, and their data with them.

    ``cells``: each kind once, with its cells (k, d); ``groups``: by kind, the cells of each further group by its tag;
    ``cell_data``: an array per kind, with ``gmsh:physical``, the first group of each cell, and ``gmsh:geometrical``.
    """
    from meshio.gmsh import common

    tags = zip(cells, cell_data["gmsh:physical"], cell_data["gmsh:geometrical"], strict=True)
    entities = [_entities(kind, rows, first, ids, groups.get(kind, {})) for (kind, rows), first, ids in tags]
    every = [one for parts in entities for one in parts]
    with path.open("wb") as file:
        file.write(b"$MeshFormat\n4.1 1 8\n" + np.int32(1).tobytes() + b"\n$EndMeshFormat\n")
        common._write_physical_names(file, names)
        _write_entities(file, points, every)
        _write_nodes(file, points, max(every, key=lambda one: one.dimension))
        _write_elements(file, every)
        for name, values in point_data.items():
            common._write_data(file, "NodeData", name, values, True)
        for name, columns in cell_data.items():
            if name not in ("gmsh:physical", "gmsh:geometrical"):
                rows = [column[one.members] for column, parts in zip(columns, entities, strict=True) for one in parts]
                common._write_data(file, "ElementData", name, np.concatenate(rows), True)


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
        found.append(_Entity(*_KINDS[kind], row[0] if enough else k + 1, belongs, members, cells[members]))
    return found


def _write_entities(file: BinaryIO, points: NDArray[np.float64], entities: list[_Entity]) -> None:
    file.write(b"$Entities\n")
    counts = [sum(one.dimension == dimension for one in entities) for dimension in range(4)]
    file.write(np.array(counts, dtype=np.uint64).tobytes())
    for one in sorted(entities, key=lambda one: one.dimension):
        corners = points[one.cells].reshape(-1, 3)
        box = np.array([corners.min(axis=0), corners.max(axis=0)]) if one.dimension else corners[:1]
        file.write(np.int32(one.number).tobytes() + box.tobytes())
        file.write(np.uint64(len(one.groups)).tobytes() + np.array(one.groups, dtype=np.int32).tobytes())
        if one.dimension:
            file.write(np.uint64(0).tobytes())  # the entities it is bounded by: none are known
    file.write(b"\n$EndEntities\n")


def _write_nodes(file: BinaryIO, points: NDArray[np.float64], entity: _Entity) -> None:
    count = len(points)
    file.write(b"$Nodes\n" + np.array([1, count, 1, count], dtype=np.uint64).tobytes())
    file.write(np.array([entity.dimension, entity.number, 0], dtype=np.int32).tobytes())
    file.write(np.uint64(count).tobytes() + np.arange(1, count + 1, dtype=np.uint64).tobytes())
    file.write(points.tobytes() + b"\n$EndNodes\n")


def _write_elements(file: BinaryIO, entities: list[_Entity]) -> None:
    count = sum(len(one.cells) for one in entities)
    file.write(b"$Elements\n" + np.array([len(entities), count, 1, count], dtype=np.uint64).tobytes())
    number = 1
    for one in entities:
        numbers = np.arange(number, number + len(one.cells))
        file.write(np.array([one.dimension, one.number, one.type], dtype=np.int32).tobytes())
        file.write(np.uint64(len(numbers)).tobytes())
        file.write(np.column_stack([numbers, one.cells + 1]).astype(np.uint64).tobytes())
        number += len(numbers)
    file.write(b"\n$EndElements\n")
