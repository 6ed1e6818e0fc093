"""TetGen's files ``.node``, ``.ele`` and ``.face``, each a count and rows of numbers, read here.

Marker 0 in ``.face`` is TetGen's for what lies in no facet of its input, and with ``-f`` there is such a row for every
triangle of the mesh, so rows of marker 0 are none of the user's: they are neither read nor written. The file ``.edge``
is left out, too: TetGen marks every segment of its input, whether the user did or not.
"""

import re
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.companions import checked
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.io.text_lines import columns_of_rows, next_rows, whole_numbers
from wct_plugin.types import Floats, Ints

TAGS = "tetgen:ref"
_ATTRIBUTE = "tetgen:attr"
#: More attributes or markers are none.
_MOST = 1000


def read(path: Path) -> tuple[RawMesh, list[str]]:
    """Points and tets with their attributes and markers, and the marked facets beside them; and what is left out.

    Raises :class:`InputError`, without the file's name, for what is no good file.
    """
    lost: list[str] = []
    nodes, tets = (_Rows(path, suffix) for suffix in (".node", ".ele"))
    count, dimension, attributes, markers = nodes.head(4)
    if dimension != 3:
        raise InputError(f"{nodes.name} has points of dimension {dimension}; allowed is 3")
    table = nodes.table(4 + attributes + markers, lost)
    first = int(whole_numbers(table[:1, 0]).sum())
    if not np.array_equal(table[:, 0], np.arange(first, first + count)):
        raise InputError(f"{nodes.name} has points that are not numbered one after the other")
    names = [f"{_ATTRIBUTE}{k + 1}" for k in range(attributes)] + _markers(markers)
    raw = RawMesh(table[:, 1:4], [], {name: table[:, 4 + k] for k, name in enumerate(names)})
    _, corners, attributes = tets.head(3)
    if corners != 4:
        raise InputError(f"{tets.name} has tets of {corners} points; allowed is 4")
    table = tets.table(5 + attributes, lost)
    raw.cells.append(RawBlock("tetra", whole_numbers(table[:, 1:5]) - first))
    for k, name in enumerate(_markers(attributes)):  # a fraction is an attribute, no number of a region
        values = table[:, 5 + k]
        raw.cell_data[name if (values == np.rint(values)).all() else f"{_ATTRIBUTE}{k + 1}"] = [values]
    if path.with_suffix(".face").exists():
        _put_facets(raw, _Rows(path, ".face"), first, lost)
    return raw, lost


def _markers(count: int) -> list[str]:
    return [TAGS + (str(k + 1) if k else "") for k in range(count)]


def _put_facets(raw: RawMesh, file: "_Rows", first: int, lost: list[str]) -> None:
    _, markers = file.head(2)
    if markers not in (0, 1):
        raise InputError(f"{file.name} has {markers} markers for each facet; allowed are 0 and 1")
    table = whole_numbers(file.table(4 + markers, lost))
    table = table[table[:, 4] != 0] if markers else table[:0]
    if not len(table):
        return
    raw.cell_data.setdefault(TAGS, [np.zeros(len(raw.cells[0]))])
    raw.cells.append(RawBlock("triangle", table[:, 1:4] - first))
    for name, columns in raw.cell_data.items():
        columns.append(table[:, 4] if name == TAGS else None)


class _Rows:
    """One of the files: a row with its counts, and so many rows; comments and blank lines may be anywhere."""

    def __init__(self, named: Path, suffix: str) -> None:
        path = named.with_suffix(suffix)
        self.name = path.name
        if not path.exists():
            raise InputError(f"needs {self.name} beside it, which is not there")
        checked(named, path, f"needs {self.name} beside it")
        text = re.sub(rb"#[^\r\n]*", b"", path.read_bytes())
        self._text = text if b"\n" in text else text.replace(b"\r", b"\n")
        self._at = self._count = 0

    def head(self, size: int) -> list[int]:
        """The first row: how many rows follow, and numbers of columns, of which the last may be left out."""
        try:
            found, _, self._at = next_rows(self._text, np.int64, 0, 1)
        except InputError as error:
            raise InputError(f"{self.name} {error}") from None
        if not len(found):
            raise InputError(f"{self.name} has no content")
        if not 2 <= len(found) <= size or (found < 0).any() or (found[1:] > _MOST).any():
            numbers = " ".join(map(str, found.tolist()))
            raise InputError(
                f"{self.name} begins with {numbers}; expected {size} numbers, of which the first counts rows"
            )
        self._count, *columns = found.tolist()
        return [self._count, *columns, 0, 0][:size]

    def table(self, width: int, lost: list[str]) -> Floats:
        """(k, width) the rows; what stands behind in a row is left out, and ``lost`` grows by further rows."""
        try:
            values, widths, at = next_rows(self._text, np.float64, self._at, self._count)
        except InputError as error:
            raise InputError(f"{self.name} {error}") from None
        short = np.flatnonzero(widths < width)
        if len(short):
            raise InputError(f"{self.name} has {widths[short[0]]} numbers in row {short[0]}; expected {width}")
        if len(widths) < self._count:
            raise InputError(f"{self.name} has {len(widths)} rows but announces {self._count}")
        beyond = sum(1 for line in self._text[at:].splitlines() if line.strip())
        if beyond:
            lost.append(f"{beyond} line{'s' * (beyond != 1)} of {self.name} beyond its count")
        return columns_of_rows(values, widths, 0, width).reshape(-1, width)


def write_facets(path: Path, facets: Ints, tags: Ints) -> list[str]:
    """Write the ``.face`` of ``path``, an empty one too, since an older one may lie there; returns what is left out."""
    rows = np.column_stack([facets, tags])[tags != 0].tolist()
    with path.with_suffix(".face").open("w") as file:
        file.write(f"{len(rows)} 1\n")
        file.writelines(f"{k} {' '.join(map(str, row))}\n" for k, row in enumerate(rows))
    unmarked = len(tags) - len(rows)
    return [f"{unmarked} tagged facets of tag 0"] if unmarked else []
