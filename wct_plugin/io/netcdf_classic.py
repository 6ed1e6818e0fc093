"""netCDF's classic files, and those of 64-bit offsets: a header of variables, and where in the file their numbers are.

Read here: SciPy's reader takes all variables into memory, though the same bytes may be those of any number of them.
"""

from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io import read_limit

_TYPES = {1: ">i1", 2: "S1", 3: ">i2", 4: ">i4", 5: ">f4", 6: ">f8"}
_DIMENSIONS, _VARIABLES, _ATTRIBUTES = 10, 11, 12
_STREAMING = 0xFFFFFFFF  #: records of a file that was never closed


@dataclass(frozen=True)
class Variable:
    """What the header says of a variable."""

    shape: tuple[int, ...]  #: without that of the records
    recorded: bool  #: whether it has values in each record
    attributes: dict[str, bytes]
    dtype: np.dtype[Any]
    begin: int

    @property
    def size(self) -> int:
        """Bytes of all values, or of those of a record."""
        return prod(self.shape) * self.dtype.itemsize


class ClassicFile:
    """The header of a file. Raises :class:`InputError` without the file's name where it is none."""

    def __init__(self, data: bytes) -> None:
        self._data, self._at = data, 4
        self._wide = data[3] == 2  #: whether places have 8 bytes
        records = self._number()
        dimensions = [(self._name(), self._number()) for _ in range(self._count(_DIMENSIONS))]
        self._attributes()
        self.variables: dict[str, Variable] = {}
        for _ in range(self._count(_VARIABLES)):
            name = self._name()
            self.variables[name] = self._variable([size for _, size in dimensions])
        recorded = [one for one in self.variables.values() if one.recorded]
        self._stride = recorded[0].size if len(recorded) == 1 else sum(_padded(one.size) for one in recorded)
        if records == _STREAMING:
            first = min((one.begin for one in recorded), default=len(data))
            records = (len(data) - first) // self._stride if self._stride else 0
        self._records = records

    def values(self, name: str) -> NDArray[Any]:
        """The values of a variable, in this machine's byte order."""
        one = self.variables[name]
        records = self._records if one.recorded else 1
        size = one.size * records
        if size and one.begin + (records - 1) * self._stride + one.size > len(self._data):
            raise InputError(f"ends within the variable {name!r}")
        read_limit.claim(size, f"variable {name!r}")
        shape = (records, *one.shape) if one.recorded else one.shape
        if not size:
            return np.empty(shape, one.dtype.newbyteorder("="))
        strides = [prod(one.shape[k + 1 :]) * one.dtype.itemsize for k in range(len(one.shape))]
        strides = [self._stride, *strides] if one.recorded else strides
        return np.ndarray(shape, one.dtype, self._data, one.begin, strides).astype(one.dtype.newbyteorder("="))

    def _take(self, size: int) -> bytes:
        taken = self._data[self._at : self._at + size]
        if size < 0 or len(taken) < size:
            raise InputError("ends within its header")
        self._at += _padded(size)
        return taken

    def _number(self) -> int:
        return int.from_bytes(self._take(4), "big")

    def _name(self) -> str:
        return self._take(self._number()).decode("utf-8", "replace")

    def _count(self, wanted: int) -> int:
        """The length of a list of dimensions, variables or attributes, which may be absent."""
        kind, count = self._number(), self._number()
        if kind not in (0, wanted) or (kind == 0 and count):
            raise InputError(f"has a list of kind {kind} in its header; expected {wanted}")
        return count

    def _attributes(self) -> dict[str, bytes]:
        found = {}
        for _ in range(self._count(_ATTRIBUTES)):
            name = self._name()
            dtype = self._type()
            found[name] = self._take(self._number() * dtype.itemsize)
        return found

    def _type(self) -> np.dtype[Any]:
        code = self._number()
        if code not in _TYPES:
            raise InputError(f"has numbers of type {code}; allowed are 1 to {len(_TYPES)}")
        return np.dtype(_TYPES[code])

    def _variable(self, sizes: list[int]) -> Variable:
        places = [self._number() for _ in range(self._number())]
        if any(place >= len(sizes) for place in places):
            raise InputError(f"has a variable of dimension {max(places)}; there are {len(sizes)}")
        shape = [sizes[place] for place in places]
        attributes, dtype = self._attributes(), self._type()
        self._take(4)  # the size, which follows from the shape
        begin = int.from_bytes(self._take(8 if self._wide else 4), "big")
        recorded = shape[:1] == [0]
        return Variable(tuple(shape[recorded:]), recorded, attributes, dtype, begin)


def _padded(size: int) -> int:
    return -(-size // 4) * 4
