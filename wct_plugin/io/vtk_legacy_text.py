"""The lines and numbers of VTK's older files, one after the other."""

import re
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.text_lines import decoded, numbers_of_type

#: Types by their names; binary files keep an id in 4 bytes, whatever VTK has in memory.
_TYPES = {
    "unsigned_char": "u1", "char": "i1", "signed_char": "i1", "unsigned_short": "u2", "short": "i2",
    "unsigned_int": "u4", "int": "i4", "unsigned_long": "u8", "long": "i8", "float": "f4", "double": "f8",
    "vtkidtype": "i4", "vtktypeint8": "i1", "vtktypeuint8": "u1", "vtktypeint16": "i2", "vtktypeuint16": "u2",
    "vtktypeint32": "i4", "vtktypeuint32": "u4", "vtktypeint64": "i8", "vtktypeuint64": "u8",
}  # fmt: skip


class Source:
    """The bytes of a file and where one is in them. Raises :class:`InputError` without the file's name."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0
        found = re.match(r"# vtk DataFile Version (\d+)", self._raw_line())
        self._raw_line()  # the title
        how = self._raw_line().strip().upper()
        if not found or how not in ("ASCII", "BINARY"):
            raise InputError("does not begin with '# vtk DataFile Version', a title, and ASCII or BINARY")
        self.version, self.text = int(found[1]), how == "ASCII"

    def _raw_line(self) -> str:
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        line = self.data[self.at : end]
        self.at = end + 1
        if len(line) > 10000:
            raise InputError("has bytes where a line of text is expected")
        return decoded(line)

    def line(self) -> list[str]:
        """The words of the next line that has any; none at the end."""
        while self.at < len(self.data):
            if words := self._raw_line().split():
                return words
        return []

    def expect(self, name: str) -> list[str]:
        """The words of the next line, which has two and begins with this one."""
        words = self.line()
        if len(words) != 2 or words[0].upper() != name:
            raise InputError(f"has the line {' '.join(words)[:60]!r} where {name} is expected")
        return words

    def skip_metadata(self) -> None:
        """Go on after the next empty line."""
        while self.at < len(self.data) and self._raw_line().strip():
            pass

    @cached_property
    def _words(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Where the words of a text file begin and end."""
        solid = np.frombuffer(self.data, np.uint8) > 32
        edges = np.flatnonzero(np.diff(solid, prepend=False, append=False))
        return edges[::2], edges[1::2]

    def numbers(self, count: int, kind: str) -> NDArray[Any]:
        """The next numbers, in this machine's byte order."""
        if count < 0 or (kind.lower() not in _TYPES and kind.lower() != "bit"):
            raise InputError(f"announces {count} numbers of the type {kind!r}; allowed are {', '.join(_TYPES)}")
        if kind.lower() == "bit":
            if self.text:
                return self.numbers(count, "unsigned_char")
            packed = self.numbers(-(-count // 8), "unsigned_char")
            return np.unpackbits(packed)[:count]
        dtype = np.dtype(_TYPES[kind.lower()])
        if self.text:
            return self._from_text(count, dtype)
        end = self.at + count * dtype.itemsize
        if end > len(self.data):
            raise InputError("ends within its numbers")
        array = np.frombuffer(self.data[self.at : end], dtype.newbyteorder(">")).astype(dtype)
        self.at = end
        return array

    def _from_text(self, count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
        starts, ends = self._words
        first = int(np.searchsorted(starts, self.at))
        if first + count > len(starts):
            raise InputError("ends within its numbers")
        if not count:
            return np.empty(0, dtype)
        text = self.data[starts[first] : ends[first + count - 1]]
        self.at = int(ends[first + count - 1])
        return numbers_of_type(text, dtype)

    def skip_text(self, count: int, kind: str) -> None:
        """Go on after an array of words: a line each, or the length before each."""
        for _ in range(count):
            if self.text or kind.lower() != "string":
                self._raw_line()
                continue
            if self.at >= len(self.data):
                raise InputError("ends within its texts")
            size = {3: 1, 2: 2, 1: 4, 0: 8}[self.data[self.at] >> 6]  # the first two bits tell the bytes of the length
            length = int.from_bytes(self.data[self.at : self.at + size], "big") & (1 << (8 * size - 2)) - 1
            self.at += size + length
