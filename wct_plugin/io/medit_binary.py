"""Medit's binary files: sections with a number for their name, the place of the next one, and a count."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.medit_sections import CELLS, DIMENSION, END, OTHERS, SETS, VERTICES

if TYPE_CHECKING:
    from wct_plugin.io.medit import Read

_SECTIONS: dict[int, Any] = {one.code: one for one in (*CELLS, *SETS)}
#: By version: types of numbers, of coordinates and of places in the file.
_TYPES = {1: ("i4", "f4", "i4"), 2: ("i4", "f8", "i4"), 3: ("i4", "f8", "i8"), 4: ("i8", "f8", "i8")}


def is_binary(data: bytes) -> bool:
    """Whether a file begins as binary ones do, with a 1 of four bytes."""
    return data[:4] in (b"\1\0\0\0", b"\0\0\0\1")


def sections(data: bytes, found: "Read") -> "Read":
    """Put the sections of a file into ``found``."""
    at = _Place(data, "<" if data[0] else ">")
    version = int(at.take("i4", 1)[0])
    if version not in _TYPES:
        raise InputError(f"is of version {version}; allowed are 1, 2, 3 and 4")
    whole, real, place = _TYPES[version]
    dimension = 0
    while not at.ended:
        code = int(at.take("i4", 1)[0])
        if code == END:
            break
        following = int(at.take(place, 1)[0])
        if code == DIMENSION:
            dimension = int(at.take("i4", 1)[0])
            if dimension not in (2, 3):
                raise InputError(f"has dimension {dimension}; allowed are 2 and 3")
        elif code == VERTICES:
            if not dimension:
                raise InputError("has no dimension before its vertices")
            row = [("place", real, (dimension,)), ("reference", whole)]
            table = at.rows("Vertices", row, int(at.take(whole, 1)[0]))
            found.put_vertices(table["place"].astype(np.float64), table["reference"].astype(np.int64))
        elif code in _SECTIONS:
            section = _SECTIONS[code]
            width = getattr(section, "corners", 0) + 1
            table = at.rows(section.name, [("row", whole, (width,))], int(at.take(whole, 1)[0]))["row"]
            rows = table.astype(np.int64).reshape(-1, width)
            found.put(section, rows if hasattr(section, "corners") else rows[:, 0])
        else:
            found.lose(OTHERS.get(code, f"keyword {code}"), int(at.take(whole, 1)[0]))
            at.go_to(following)
    return found


class _Place:
    """A place in the file."""

    def __init__(self, data: bytes, order: str) -> None:
        self._data, self._order, self._at = data, order, 4

    @property
    def ended(self) -> bool:
        return self._at >= len(self._data)

    def take(self, kind: Any, count: int) -> NDArray[Any]:
        row = np.dtype(kind).newbyteorder(self._order)
        if count < 0 or self._at + count * row.itemsize > len(self._data):
            raise InputError(f"ends at byte {len(self._data)}, within a section")
        taken = np.frombuffer(self._data, row, count, self._at)
        self._at += count * row.itemsize
        return taken

    def rows(self, name: str, kind: list[Any], count: int) -> NDArray[Any]:
        row = np.dtype(kind)
        there = (len(self._data) - self._at) // row.itemsize
        if count < 0 or count > there:
            raise InputError(f"section {name!r} announces {count} entries; there is room for {there} in the file")
        return self.take(kind, count)

    def go_to(self, following: int) -> None:
        """Go on at the next section; a 0 says that there is none."""
        if following and not self._at <= following <= len(self._data):
            raise InputError(f"says that its next section begins at byte {following} of {len(self._data)}")
        self._at = following or len(self._data)
