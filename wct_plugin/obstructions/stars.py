"""The tets and facets round single vertices."""

from functools import cached_property

import numpy as np

from wct_plugin.types import Ints


class Stars:
    """Looks up what is at a vertex of ``cells`` (m, p) on ``count`` points."""

    def __init__(self, cells: Ints, count: int) -> None:
        self._cells = cells
        self._count = count

    @cached_property
    def _order(self) -> tuple[Ints, Ints]:
        flat = self._cells.ravel()
        order = np.argsort(flat, kind="stable")
        return order // self._cells.shape[1], np.searchsorted(flat[order], np.arange(self._count + 1))

    def at(self, vertex: int) -> Ints:
        """Rows of the cells at a vertex, ascending."""
        rows, starts = self._order
        found: Ints = rows[starts[vertex] : starts[vertex + 1]]
        return found

    def links(self, vertex: int) -> Ints:
        """(k, p - 1) the other vertices of each of its cells, of which there may be none."""
        cells = self._cells[self.at(vertex)]
        others: Ints = cells[cells != vertex].reshape(len(cells), self._cells.shape[1] - 1)
        return others
