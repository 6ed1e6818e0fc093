"""Records of different lengths in one array, found in bulk: as runs of records that are laid out alike."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError


def runs(
    flat: NDArray[Any], head: int, layout: Callable[[NDArray[Any]], tuple[int, list[int]]]
) -> Iterator[tuple[int, NDArray[Any]]]:
    """Tables of records one after the other, and where in ``flat`` each begins.

    ``layout`` tells of the record that an array begins with its length, and in which columns all records of this
    length and layout have the same values; it needs ``head`` numbers for that. Raises :class:`InputError` where the
    last one is not whole.
    """
    start = 0
    while start < len(flat):
        size, heads = layout(flat[start:]) if len(flat) - start >= head else (0, [])
        if not 0 < size <= len(flat) - start:
            raise InputError("ends within a cell")
        count = alike(flat[start:], heads, size)
        yield start, flat[start : start + count * size].reshape(count, size)
        start += count * size


def alike(flat: NDArray[Any], heads: list[int], size: int) -> int:
    """How many records from the beginning on are like the first: looked for in steps that grow."""
    count, step, total = 0, 64, len(flat) // size
    while count < total:
        rows = flat[count * size : min(count + step, total) * size].reshape(-1, size)
        other = np.flatnonzero((rows[:, heads] != flat[heads]).any(axis=1))
        if len(other):
            return count + int(other[0])
        count, step = count + len(rows), 2 * step
    return count
