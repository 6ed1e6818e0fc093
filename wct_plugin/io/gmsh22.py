"""gmsh's files of version 2.2, which most programs read: each cell has one physical group and one entity."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io.gmsh_sections import KINDS, OWN, end, put, put_data, put_format, put_names
from wct_plugin.io.periodic_sides import PeriodicSides, put_periodic
from wct_plugin.types import Ints


def write(
    path: Path,
    points: NDArray[np.float64],
    cells: list[tuple[str, Ints]],
    names: Mapping[str, Any],
    point_data: Mapping[str, NDArray[Any]],
    cell_data: Mapping[str, list[NDArray[Any]]],
    periodic: list[PeriodicSides],
    *,
    binary: bool,
) -> None:
    """Write the file; points and cells are numbered from 1 in the order they come.

    ``cells``: each kind with its cells (k, d); ``cell_data``: an array per kind, with ``gmsh:physical`` and
    ``gmsh:geometrical``.
    """
    with path.open("wb") as file:
        put_format(file, binary, "2.2")
        put_names(file, names)
        file.write(f"$Nodes\n{len(points)}\n".encode())
        put(file, binary, np.arange(1, len(points) + 1, dtype=np.int32), points)
        end(file, binary, "Nodes")
        file.write(f"$Elements\n{sum(len(rows) for _, rows in cells)}\n".encode())
        first = 1
        for (kind, rows), groups, entities in zip(cells, *(cell_data[name] for name in OWN), strict=True):
            _, number = KINDS[kind]
            tags = np.column_stack([groups, entities])
            each = np.full((len(rows), 1), 1)
            ids = np.arange(first, first + len(rows))[:, None]
            if binary:  # a head for all rows, then the rows without what it says
                put(file, binary, np.array([[number, len(rows), 2]], dtype=np.int32))
                table = np.hstack([ids, tags, rows + 1])
            else:
                table = np.hstack([ids, number * each, 2 * each, tags, rows + 1])
            put(file, binary, table.astype(np.int32))
            first += len(rows)
        end(file, binary, "Elements")
        entity = dict(zip((kind for kind, _ in cells), cell_data[OWN[1]], strict=True))
        facets = "triangle" if "triangle" in entity else "triangle6"
        put_periodic(file, binary, "2.2", periodic, lambda row: int(entity[facets][row]))
        for name, values in point_data.items():
            put_data(file, binary, "NodeData", name, values)
        for name, columns in cell_data.items():
            if name not in OWN:
                put_data(file, binary, "ElementData", name, np.concatenate(columns))
