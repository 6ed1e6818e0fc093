"""The file ``.face`` beside TetGen's ``.node`` and ``.ele``: tagged facets, which meshio leaves out.

Marker 0 is TetGen's for what lies in no facet of its input, and with ``-f`` there is such a row for every triangle of
the mesh, so rows of marker 0 are none of the user's: they are neither read nor written. The file ``.edge`` is left
out, too: TetGen marks every segment of its input, whether the user did or not.
"""

import io
import re
from pathlib import Path

import numpy as np

from wct_plugin.errors import InputError
from wct_plugin.io.raw_mesh import RawBlock, RawMesh
from wct_plugin.types import Ints

_TAGS = "tetgen:ref"


def add_facets(raw: RawMesh, file: Path) -> None:
    """Put the marked facets that lie beside ``file``, if any, into what was read."""
    facets, markers = _marked(file.with_suffix(".face"))
    if not len(facets):
        return
    first = int(_lines(file.with_suffix(".node"))[1].split()[0])
    raw.cell_data.setdefault(_TAGS, [np.zeros(len(raw.cells[0]), dtype=np.int64)])
    raw.cells.append(RawBlock("triangle", facets - first))
    for name, columns in raw.cell_data.items():
        columns.append(markers if name == _TAGS else None)


def _lines(path: Path) -> list[str]:
    """The lines that say anything: comments and blank lines may be anywhere."""
    with path.open() as lines:
        return [line for line in (line.partition("#")[0].strip() for line in lines) if line]


def _marked(path: Path) -> tuple[Ints, Ints]:
    """The vertices (k, 3), as numbered in the file, and the markers (k,) of the rows whose marker is not 0."""
    none = np.empty((0, 3), dtype=np.int64), np.empty(0, dtype=np.int64)
    if not path.exists():
        return none
    head, *rows = _lines(path) or [""]
    if not re.fullmatch(r"\d+\s+[01]", head):
        raise InputError(f"{path.name} begins with {head[:40]!r}; expected the number of rows, and 0 or 1 for markers")
    count, markers = map(int, head.split())
    if len(rows) != count:
        raise InputError(f"{path.name} has {len(rows)} rows but announces {count}")
    if not count or not markers:
        return none
    table = np.loadtxt(io.StringIO("\n".join(rows)), dtype=np.int64, usecols=(1, 2, 3, 4), ndmin=2)
    table = table[table[:, 3] != 0]
    return table[:, :3], table[:, 3]


def write_facets(path: Path, facets: Ints, tags: Ints) -> list[str]:
    """Write the ``.face`` of ``path``, an empty one too, since an older one may lie there; returns what is left out."""
    rows = np.column_stack([facets, tags])[tags != 0].tolist()
    with path.with_suffix(".face").open("w") as file:
        file.write(f"{len(rows)} 1\n")
        file.writelines(f"{k} {' '.join(map(str, row))}\n" for k, row in enumerate(rows))
    unmarked = len(tags) - len(rows)
    return [f"{unmarked} tagged facets of tag 0"] if unmarked else []
