"""Writing Medit's files: as text of version 2, or in binary of the first version whose numbers suffice."""

from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from wct_plugin.io.gmsh_sections import put
from wct_plugin.io.medit_sections import CELLS, DIMENSION, END, SETS, VERTICES
from wct_plugin.types import Floats, Ints

#: Name, number in binary files, and the columns of a section.
_Section = tuple[str, int, list[NDArray[np.int64] | NDArray[np.float64]]]


def write(
    path: Path,
    points: Floats,
    references: Ints,
    cells: list[tuple[str, Ints]],
    tags: list[Ints],
    sets: Mapping[str, list[Ints]],
) -> None:
    """Write points and cells with their references, and those sets that are sections; binary where the suffix says so.

    ``tags``: an array for each kind of ``cells``; ``sets``: rows by name, an array for each kind.
    """
    sections: list[_Section] = [("Vertices", VERTICES, [points, references])]
    for (kind, rows), column in zip(cells, tags, strict=True):
        for section in CELLS:
            if section.kind == kind:
                sections.append((section.name, section.code, [rows + 1, column]))
    for one in SETS:
        for (kind, rows), members in zip(cells, sets.get(one.name, [None] * len(cells)), strict=True):
            if kind == one.kind and members is not None and len(members):
                numbers = rows[members, 0] + 1 if kind == "vertex" else members + 1
                sections.append((one.name, one.code, [numbers]))
    with path.open("wb") as file:
        if path.suffix.lower() == ".meshb":
            _write_binary(file, sections)
        else:
            _write_text(file, sections)


def _write_text(file: BinaryIO, sections: list[_Section]) -> None:
    file.write(b"MeshVersionFormatted 2\nDimension 3\n")
    for name, _, columns in sections:
        file.write(f"\n{name}\n{len(columns[0])}\n".encode())
        put(file, False, *columns)
    file.write(b"\nEnd\n")


def _write_binary(file: BinaryIO, sections: list[_Section]) -> None:
    highest = max(int(np.abs(column).max(initial=0)) for _, _, columns in sections for column in columns)
    size = sum(8 * column.size for _, _, columns in sections for column in columns)
    version = 4 if highest >= 2**31 else 3 if size >= 2**30 else 2
    whole, place = ("<i8" if version == 4 else "<i4"), ("<i8" if version > 2 else "<i4")

    def head(code: int, length: int, first: int) -> None:
        """The number of a section, where the next one begins, and its first number."""
        following = file.tell() + 4 + np.dtype(place).itemsize + length
        file.write(np.array([code], dtype="<i4").tobytes() + np.array([following], dtype=place).tobytes())
        file.write(np.array([first], dtype="<i4" if code == DIMENSION else whole).tobytes())

    file.write(np.array([1, version], dtype="<i4").tobytes())
    head(DIMENSION, 4, 3)
    for _, code, columns in sections:
        kinds = ["<f8" if column.dtype.kind == "f" else whole for column in columns]
        row = sum(np.dtype(kind).itemsize * column[:1].size for kind, column in zip(kinds, columns, strict=True))
        head(code, np.dtype(whole).itemsize + row * len(columns[0]), len(columns[0]))
        put(file, True, *(column.astype(kind) for kind, column in zip(kinds, columns, strict=True)))
    file.write(np.array([END], dtype="<i4").tobytes() + np.array([0], dtype=place).tobytes())
