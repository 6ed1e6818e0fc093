"""Arrays of indices: what hangs together, which rows are equal."""

from collections.abc import Mapping

import numpy as np

from wct_plugin.core import _core
from wct_plugin.types import Bools, Floats, Ints


def components(rows: Ints, columns: Ints, count: int) -> Ints:
    """(count,) a number per node, from 0, equal where links ``rows[k]`` - ``columns[k]`` join two nodes.

    In the order of the components' first nodes.
    """
    return _core.components(np.ascontiguousarray(rows), np.ascontiguousarray(columns), count)


def masks(sets: Mapping[str, Ints], count: int) -> dict[str, Bools]:
    """Named index arrays as masks (count,)."""
    out = {name: np.zeros(count, dtype=bool) for name in sets}
    for name, members in sets.items():
        out[name][members] = True
    return out


def averaged(values: Floats, i: Ints, k: Ints, times: int) -> Floats:
    """Values (n,) averaged, so many ``times``, with those at the other ends of the edges between ``i`` and ``k``."""
    count = len(values)
    many = 1.0 + np.bincount(i, minlength=count) + np.bincount(k, minlength=count)
    for _ in range(times):
        values = (values + (np.bincount(i, values[k], count) + np.bincount(k, values[i], count))) / many
    return values


def find_rows(rows: Ints, wanted: Ints, count: int) -> Ints:
    """For each of the ``wanted`` rows the index of the first equal one of ``rows`` (entries below ``count``), or -1."""
    both = np.concatenate([rows, wanted])
    key = both[:, 0] if both.shape[1] else np.zeros(len(both), dtype=np.int64)
    for column in both.T[1:]:
        key = np.unique(key, return_inverse=True)[1] * count + column
    table, needles = key[: len(rows)], key[len(rows) :]
    order = np.argsort(table, kind="stable")
    at = np.minimum(np.searchsorted(table, needles, sorter=order), max(len(rows) - 1, 0))
    if not len(rows):
        return np.full(len(wanted), -1, dtype=np.int64)
    return np.where(table[order[at]] == needles, order[at], -1)


def among(cells: Ints, others: Ints, count: int) -> Bools:
    """(k,) which ``cells`` (k, d) are in ``others`` (j, d), in any order of their vertices, below ``count``."""
    found: Bools = find_rows(np.sort(others, axis=1), np.sort(cells, axis=1), count) >= 0
    return found


def distinct_rows(rows: Ints) -> Ints:
    """(k,) a number per row, equal where rows are equal."""
    return np.unique(rows, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)
