"""Numbers of mixed types one after the other, from text or from bytes: the same calls read either form of a format."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.record_runs import alike
from wct_plugin.io.text_lines import numbers, whole_numbers


class NumberStream(ABC):
    """What is left to read."""

    @abstractmethod
    def records(self, count: int, *columns: tuple[str, int]) -> list[NDArray[Any]]:
        """``count`` records of columns, each of a type and a width: an array (count, width) for each column.

        Raises :class:`InputError` where so many are not left.
        """

    @abstractmethod
    def check_end(self) -> None:
        """Raise :class:`InputError` where a text has numbers left; what is behind those in bytes has a name."""

    def take(self, kind: str, count: int) -> NDArray[Any]:
        """(count,) numbers of a type."""
        (found,) = self.records(count, (kind, 1))
        return found[:, 0]

    def whole(self, kind: str, count: int) -> list[int]:
        """Whole numbers, as Python's."""
        found: list[int] = self.take(kind, count).astype(np.int64).tolist()
        return found


class TextNumbers(NumberStream):
    """Numbers that stand in a text, parsed at once; ``real``: not all are whole."""

    def __init__(self, text: bytes, *, real: bool) -> None:
        self._values: NDArray[Any] = numbers(text, np.float64) if real else numbers(text, np.int64)
        self._at = 0

    def records(self, count: int, *columns: tuple[str, int]) -> list[NDArray[Any]]:  # noqa: D102
        width = sum(size for _, size in columns)
        left = len(self._values) - self._at
        if count < 0 or width < 1 or count * width > left:
            raise InputError(f"announces {count} rows of {width} numbers, {count * width}; {left} are left")
        table = self._values[self._at : self._at + count * width].reshape(count, width)
        self._at += count * width
        ends = np.cumsum([size for _, size in columns])
        parts = np.split(table, ends[:-1], axis=1)
        return [
            whole_numbers(part) if kind[0] in "iu" else part for part, (kind, _) in zip(parts, columns, strict=True)
        ]

    def check_end(self) -> None:  # noqa: D102
        if len(left := self.rest):
            raise InputError(f"has {len(left)} numbers more than it announces")

    @property
    def rest(self) -> NDArray[Any]:
        """All numbers that are left; afterwards none is."""
        found = self._values[self._at :]
        self._at = len(self._values)
        return found


class BinaryNumbers(NumberStream):
    """Numbers in bytes from a place on; ``order`` is ``<`` or ``>``."""

    def __init__(self, data: bytes, at: int, order: str) -> None:
        self.data, self.at, self._order = data, at, order

    def records(self, count: int, *columns: tuple[str, int]) -> list[NDArray[Any]]:  # noqa: D102
        row = np.dtype([(str(k), self._order + kind, (size,)) for k, (kind, size) in enumerate(columns)])
        left = (len(self.data) - self.at) // row.itemsize
        if count < 0 or count > left:
            raise InputError(f"announces {count} rows of {row.itemsize} bytes; {left} are left in the file")
        table = np.frombuffer(self.data, row, count, self.at)
        self.at += row.itemsize * count
        return [
            table[str(k)].astype(np.int64 if kind[0] in "iu" else np.float64) for k, (kind, _) in enumerate(columns)
        ]

    def alike(self, kind: str, head: int, size: int, most: int) -> NDArray[Any]:
        """(n, size) the records from here on, at most so many, whose first ``head`` numbers are those of the first.

        Raises :class:`InputError` where not one is left.
        """
        number = np.dtype(self._order + kind)
        fit = min((len(self.data) - self.at) // (size * number.itemsize), most)
        flat = np.frombuffer(self.data, number, fit * size, self.at)
        count = alike(flat, list(range(head)), size) if fit else 1
        (found,) = self.records(count, (kind, size))
        return found

    def check_end(self) -> None:  # noqa: D102
        pass
