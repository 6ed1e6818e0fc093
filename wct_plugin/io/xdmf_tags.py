"""Grids on the same points become one mesh: cells, and tags of cells, facets and edges that have grids of their own.

So dolfinx writes a mesh with its ``MeshTags``, dolfin its ``MeshFunction`` and ``MeshValueCollection``: every grid of
tags lists the cells or facets it speaks of, in an order of its own, with one attribute.
"""

from dataclasses import dataclass, field
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io import read_limit
from wct_plugin.io.raw_mesh import RawBlock, RawMesh

#: The name that tags get, of cells and facets alike.
TAGS = "cell_tags"


def one_mesh(grids: list[tuple[str, RawMesh]]) -> RawMesh:
    """The mesh that the grids, all on the same points, are together.

    A grid with cells that others before it have gives these its data; its other cells are added. The one whole-number
    array of a grid that has no other is its tags; of several grids of tags of one kind of cell the first has them, the
    others' stay data under their own names.
    """
    kinds: dict[tuple[str, int], _Kind] = {}
    point_data: dict[str, NDArray[Any]] = {}
    tagged: set[str] = set()
    for _, grid in grids:
        point_data |= grid.point_data
        for k, block in enumerate(grid.cells):
            data = {name: values for name, columns in grid.cell_data.items() if (values := columns[k]) is not None}
            if len(grids) > 1 and len(data) == 1 and _is_tags(*data.values()) and block.type not in tagged:
                tagged.add(block.type)
                data = {TAGS: next(iter(data.values()))}
            kinds.setdefault((block.type, block.data.shape[1]), _Kind(block.data[:0])).put(block.data, data)
    names = dict.fromkeys(name for kind in kinds.values() for name in kind.data)
    return RawMesh(
        grids[0][1].points,
        [RawBlock(name, kind.cells) for (name, _), kind in kinds.items()],
        point_data,
        {name: [kind.data.get(name) for kind in kinds.values()] for name in names},
    )


def _is_tags(values: NDArray[Any]) -> bool:
    return values.ndim == 1 and values.dtype.kind in "iu"


@dataclass
class _Kind:
    """The cells of one kind so far, and their data."""

    cells: NDArray[np.int64]
    data: dict[str, NDArray[Any]] = field(default_factory=dict)

    def put(self, cells: NDArray[np.int64], data: dict[str, NDArray[Any]]) -> None:
        """Give the cells that are there already their data, and add the others, if any, with theirs."""
        place = _places(self.cells, cells)
        new = place < 0
        place[new] = len(self.cells) + np.arange(new.sum())
        before = len(self.cells)
        self.cells = np.concatenate([self.cells, cells[new]])
        for name in {**self.data, **data}:
            old, values = self.data.get(name), data.get(name)
            given = [array for array in (old, values) if array is not None]
            dtype = np.result_type(*given)
            fill: Any = np.nan if dtype.kind == "f" else 0
            shape = (len(self.cells), *given[0].shape[1:])
            read_limit.claim_more(prod(shape) * dtype.itemsize, sum(one.nbytes for one in given), f"array {name!r}")
            column = np.full(shape, fill, dtype=dtype)
            if old is not None:
                column[:before] = old
            if values is not None:
                column[place] = values
            self.data[name] = column


def _places(cells: NDArray[np.int64], wanted: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where among the cells each of the wanted is, whatever the order of its points; -1 where it is not."""
    if not len(cells):
        return np.full(len(wanted), -1)
    if np.array_equal(cells, wanted):
        return np.arange(len(cells))
    both = np.sort(np.concatenate([cells, wanted]), axis=1)
    _, number = np.unique(both, axis=0, return_inverse=True)
    place = np.full(number.max(initial=-1) + 1, -1)
    place[number[: len(cells)][::-1]] = np.arange(len(cells))[::-1]  # the first, where cells are repeated
    return place[number[len(cells) :]]
