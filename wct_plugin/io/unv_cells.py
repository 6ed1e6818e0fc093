"""The cells of a universal file, by kind."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wct_plugin.errors import InputError
from wct_plugin.io.id_rows import IdRows
from wct_plugin.io.raw_mesh import RawBlock
from wct_plugin.io.record_runs import runs
from wct_plugin.io.text_lines import numbers

#: By dimension and number of points: meshio's name, and its order of the points where it differs. Cells of second order
#: list corners and mid nodes in turn here.
_KINDS: dict[tuple[int, int], tuple[str, tuple[int, ...]]] = {
    (0, 1): ("vertex", ()),
    (1, 2): ("line", ()),
    (1, 3): ("line3", (0, 2, 1)),
    (2, 3): ("triangle", ()),
    (2, 4): ("quad", ()),
    (2, 6): ("triangle6", (0, 2, 4, 1, 3, 5)),
    (2, 8): ("quad8", (0, 2, 4, 6, 1, 3, 5, 7)),
    (3, 4): ("tetra", ()),
    (3, 5): ("pyramid", ()),
    (3, 6): ("wedge", ()),
    (3, 8): ("hexahedron", ()),
    (3, 10): ("tetra10", (0, 2, 4, 9, 1, 3, 5, 6, 7, 8)),
    (3, 13): ("pyramid13", (0, 2, 4, 6, 12, 1, 3, 5, 7, 8, 9, 10, 11)),
    (3, 15): ("wedge15", (0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8)),
    (3, 20): ("hexahedron20", (0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11)),
}
#: Descriptors of beams and rods, which have a line more, by which their ends are turned.
_BEAMS = (11, 21, 22, 23, 24)


@dataclass(frozen=True)
class Cells:
    """Cells of one kind: their labels, points by label, and numbers of property and material."""

    kind: str
    dimension: int
    labels: NDArray[np.int64]
    corners: NDArray[np.int64]
    numbers: NDArray[np.int64]  #: (k, 2)

    def raw(self, rows: IdRows) -> RawBlock:
        """The block, its points as rows."""
        return RawBlock(self.kind, rows.of(self.corners, "a cell"))


def cells_of(lines: list[bytes], lost: list[str], *, old: bool) -> list[Cells]:
    """The cells of a dataset, of which the older form has two numbers more in the head of each.

    ``lost`` grows by what is no cell of a mesh: springs, rigid links and the like.
    """
    flat = numbers(b" ".join(lines), np.int64)
    head, kept = (8, (3, 5)) if old else (6, (2, 3))

    def layout(rest: NDArray[np.int64]) -> tuple[int, list[int]]:
        if rest[head - 1] < 1:
            raise InputError(f"has cell {rest[0]} without points")
        return head + 3 * (rest[1] in _BEAMS) + int(rest[head - 1]), [1, head - 1]

    parts: dict[tuple[int, int], list[NDArray[np.int64]]] = {}
    for _, rows in runs(flat, head, layout):
        descriptor, count = int(rows[0, 1]), int(rows[0, head - 1])
        key = _dimension(descriptor), count
        if key not in _KINDS:
            lost.append(f"{len(rows)} cells of descriptor {descriptor} with {count} points")
            continue
        parts.setdefault(key, []).append(rows[:, [0, *kept, *range(rows.shape[1] - count, rows.shape[1])]])
    made = []
    for key, tables in parts.items():
        rows = np.concatenate(tables)
        kind, order = _KINDS[key]
        corners = rows[:, 3:][:, order] if order else rows[:, 3:]
        made.append(Cells(kind, key[0], rows[:, 0], corners, rows[:, 1:3]))
    return made


def _dimension(descriptor: int) -> int:
    """Of masses, rods and beams, plates and shells, solids; -1 of all others."""
    if descriptor in _BEAMS:
        return 1
    if 41 <= descriptor < 100:
        return 2
    return {161: 0, 31: 1}.get(descriptor, 3 if 101 <= descriptor < 119 else -1)
